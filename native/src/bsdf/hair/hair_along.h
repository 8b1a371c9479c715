// How light spreads along a strand about a cone of directions; d'Eon et al. 2011, "An
// Energy-Conserving Hair Reflectance Model".
#pragma once

#include "bsdf/fresnel.h"
#include "math/sampling.h"

namespace photon_splat {

inline float cos_of(float sine) { return std::sqrt(std::max(0.0f, 1 - sqr(sine))); }

// Density in the sine of the angle of wi, of those of wo and wi along the strand.
float density_along(float sin_i, float cos_i, float sin_o, float cos_o, float variance);

// A sine of wi of that density.
inline float sample_along(float sin_o, float cos_o, float variance, const Vec2& u) {
  const float x = std::max(u.x, 1e-5f);
  const float off = 1 + variance * std::log(x + (1 - x) * std::exp(-2 / variance));
  const float sine = -off * sin_o + cos_of(off) * std::cos(2 * kPi * u.y) * cos_o;
  return std::clamp(sine, -1.0f, 1.0f);
}

}  // namespace photon_splat
