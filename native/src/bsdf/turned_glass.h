// Smooth glass whose normal, told by bumps or by interpolation, turns towards who sees it until
// what it mirrors lies above the surface (valid_reflection()): which viewer finds the light that
// comes from one direction.
#pragma once

#include <optional>

#include "bsdf/lobe.h"

namespace photon_splat {

// Where the light goes to, and how much of its flux that is, but for Fresnel.
struct TurnedWay {
  Vec3 to;  // unit
  float spread;
};

// What comes from `light` (unit, towards it, beyond the surface) to a viewer on the side of `view`,
// whose wo is not read. n: the normal before it turns; ior: index there over index on the viewers'
// side. Nothing: no viewer sees it.
std::optional<TurnedWay> way_through(const View& view, const Vec3& n, const Vec3& light, float ior);

}  // namespace photon_splat
