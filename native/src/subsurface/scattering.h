// What a body of a subsurface closure does to light in it.
#pragma once

#include "bsdf/subsurface.h"

namespace photon_splat {

struct Scattering {
  Rgb extinction;  // 1/m
  Rgb albedo;      // of a single scattering
  float g;         // Henyey-Greenstein's
  Rgb factor;      // of the closure's weight: what the walk does not account for

  Rgb scattering() const { return extinction * albedo; }
  // The isotropic medium that looks alike from far off (similarity theory).
  Scattering reduced() const;
};

// The single scattering albedo by which a flat and deep body reflects the closure's albedo, for a
// random walk.
Scattering scattering_of(const Subsurface& closure);

}  // namespace photon_splat
