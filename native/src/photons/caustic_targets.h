// What can focus light into caustics, as spheres to aim photons at.
#pragma once

#include "lights/emission/emission_targets.h"
#include "scene/scene.h"

namespace photon_splat {

// Spheres around clusters of triangles whose material has sharp lobes, at most 64. Things apart get
// spheres of their own.
std::vector<EmissionTargets::Sphere> caustic_targets(const Scene& scene);

}  // namespace photon_splat
