// Which visible points photons serve badly: there camera paths go on for the indirect light, as if photons brought none.
#pragma once

#include "radius_map.h"

namespace photon_splat {

// Things that are small or bent against the discs that the photons' density asks for: leaves, pebbles, slivers, or surfaces that
// hardly any photon meets. What decides is the pilot and the shape of the surface, never the photons that would be gathered.
// Constant after it is made; any thread may ask.
class Fallback {
 public:
  // `photons`: wanted in a disc from a pass of `paths` paths. `radii` must outlive it.
  Fallback(const Scene& scene, const RadiusMap& radii, double photons, double paths)
      : scene_(scene), radii_(radii), photons_(photons), paths_(paths) {}

  // Whether too few photons of a pass come into the largest disc about x that neither bends nor reaches past its patch.
  // `radius_factor`: on all radii of that pass.
  bool at(uint32_t key, const Vec3& x, uint32_t instance, uint32_t triangle, float radius_factor) const;

 private:
  const Scene& scene_;
  const RadiusMap& radii_;
  double photons_, paths_;
};

}  // namespace photon_splat
