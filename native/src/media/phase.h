// Where light goes that a medium scatters: phase functions. Densities are per solid angle, cosines
// those between the way before and the way after.
#pragma once

#include "math/sampling.h"
#include "math/vec.h"

namespace photon_splat {

enum class PhaseKind : uint8_t { kHenyeyGreenstein, kDraine, kRayleigh };

struct Phase {
  PhaseKind kind = PhaseKind::kHenyeyGreenstein;
  float g = 0;      // mean cosine (Henyey-Greenstein), or Draine's g
  float alpha = 0;  // Draine's

  // 1/sr
  float evaluate(float cosine) const;
  // Density of what sample_cosine() draws, over the sphere, 1/sr. Differs from evaluate() by a
  // factor of at most 3.
  float pdf(float cosine) const;
  float sample_cosine(float u) const;
};

// Two phase functions of which the first has the share `first` fit Mie scattering by droplets of
// `diameter` micrometres in water fog (Jendersie and d'Eon, An Approximate Mie Scattering Function
// for Fog and Cloud Rendering, 2023).
struct MieFit {
  Phase first, second;
  float second_share;
};
MieFit fit_mie(float diameter);

}  // namespace photon_splat
