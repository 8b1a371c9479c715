// Closures and directions that the BSDF's tests go through.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bsdf/bsdf.h"

namespace photon_splat {

struct BsdfCase {
  std::string name;
  std::function<void(Bsdf&)> fill;
  bool reciprocal = false;
  // Directional albedo that it must have at every angle; -1: just no more than 1
  double furnace = -1;
};

inline const Vec3 kUp{0, 0, 1};
inline constexpr Rgb kGrey{0.8f, 0.8f, 0.8f};

inline PrincipledInputs principled_inputs(const std::function<void(PrincipledInputs&)>& change) {
  PrincipledInputs in;
  in.normal = in.coat_normal = kUp;
  in.tangent = {1, 0, 0};
  change(in);
  return in;
}

std::vector<BsdfCase> bsdf_cases();

inline Vec3 direction(float cosine, float azimuth) {
  const float s = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  return {s * std::cos(azimuth), s * std::sin(azimuth), cosine};
}

inline Bsdf make_bsdf(const BsdfCase& c, const Vec3& wo,
                      Transport transport = Transport::kRadiance) {
  const bool back = wo.z < 0;
  const Vec3 n = back ? -kUp : kUp;
  Bsdf bsdf(transport, wo, n, n, back);
  c.fill(bsdf);
  bsdf.finish();
  return bsdf;
}

}  // namespace photon_splat
