// Where light goes that a medium scatters: phase functions. Densities are per solid angle, cosines
// those between the way before and the way after.
#pragma once

#include "math/sampling.h"
#include "math/vec.h"

namespace photon_splat {

enum class PhaseKind : uint8_t { kHenyeyGreenstein, kDraine, kRayleigh, kFournierForand };

struct Phase {
  PhaseKind kind = PhaseKind::kHenyeyGreenstein;
  // Mean cosine (Henyey-Greenstein), Draine's g, or the index of refraction of particles (Fournier
  // and Forand)
  float g = 0;
  float alpha = 0;  // Draine's, or the share that is scattered backwards (Fournier and Forand)

  // 1/sr
  float evaluate(float cosine) const;
  // Density of what sample_cosine() draws, over the sphere, 1/sr. Differs from evaluate() by a
  // factor of at most 3.
  float pdf(float cosine) const;
  float sample_cosine(float u) const;
};

// What is left on a way of length t where extinction is c: e^(-c t), all where there is none.
inline Rgb attenuation(const Rgb& c, float t) {
  const auto one = [t](float x) { return x > 0 ? std::exp(-x * t) : 1.0f; };
  return {one(c.x), one(c.y), one(c.z)};
}
// The way at this cosine to `way`, `turn` of a full turn about it.
inline Vec3 turned(const Vec3& way, float cosine, float turn) {
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const Vec2 around = cos_sin_of_turn(turn);
  return normalize(Basis(way).to_world({sine * around.x, sine * around.y, cosine}));
}

// Two phase functions of which the first has the share `first` fit Mie scattering by droplets of
// `diameter` micrometres in water fog (Jendersie and d'Eon, An Approximate Mie Scattering Function
// for Fog and Cloud Rendering, 2023).
struct MieFit {
  Phase first, second;
  float second_share;
};
MieFit fit_mie(float diameter);

}  // namespace photon_splat
