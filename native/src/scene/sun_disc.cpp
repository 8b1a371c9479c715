// The sun of a sky.
#include "math/sampling.h"
#include "scene/material.h"

namespace photon_splat {

// Cycles' sun: 1 - 0.6 (1 - cos of the angle to the sun's own surface)
constexpr float kLimbDarkening = 0.6f;

SunCone::SunCone(const SunDisc& of) : sun(of), towards(normalize(of.direction)) {
  const float half = std::clamp(sun.half_angle, 1e-5f, 0.5f * kPi), sine = std::sin(0.5f * half);
  one_minus_cos = 2 * sine * sine;
  const float elevation = std::asin(std::clamp(towards.z, -1.0f, 1.0f));
  high = elevation + half;
  low = elevation - half;
}

Rgb SunCone::radiance(const Vec3& d) const {
  if (!contains(d)) return {};
  const float off2 = length2(d - towards);  // 2 (1 - cos)
  const float ratio2 = std::min(off2 / (2 * one_minus_cos), 1.0f);
  const float elevation = std::asin(std::clamp(d.z, -1.0f, 1.0f));
  if (elevation < sun.horizon) return {};
  const float height = (elevation - low) / std::max(high - low, 1e-9f);
  const Rgb color = sun.bottom + (sun.top - sun.bottom) * std::clamp(height, 0.0f, 1.0f);
  return max(color, Vec3{}) * (1 - kLimbDarkening * (1 - std::sqrt(1 - ratio2)));
}

}  // namespace photon_splat
