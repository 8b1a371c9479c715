// What can focus light into caustics, as spheres to aim photons at.
#pragma once

#include "lights/emission/emission_targets.h"
#include "scene/scene.h"

namespace photon_splat {

// Spheres around clusters of triangles whose material has sharp lobes, at most 64. Things apart get
// spheres of their own.
std::vector<EmissionTargets::Sphere> caustic_targets(const Scene& scene);

// The same where few photons arrive: clusters that lie in the same room as others are cut too. What
// is seen lies about `center`, within `radius` or so: near it clusters are small, and wanted more
// photons of.
std::vector<EmissionTargets::Sphere> fine_caustic_targets(const Scene& scene, const Vec3& center,
                                                          float radius);

}  // namespace photon_splat
