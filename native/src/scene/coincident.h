// Surfaces that lie exactly in each other, as doubled faces do.
#pragma once

#include "scene/camera.h"
#include "scene/scene.h"

namespace photon_splat {

struct Coincident {
  uint32_t instance;  // the one that rays meet first
  uint32_t other;     // may be the same
  float share;        // of the picture, and a quarter of what is seen by one diffuse reflection
};

// Pairs of opaque surfaces that lie in each other where the camera sees them or what they light,
// the largest share first: a ray from one meets the other at once, or by chance, which decides
// whether light reaches it in a renderer that leaves out nothing but the triangle that a ray starts
// from.
std::vector<Coincident> coincident_surfaces(const Scene& scene, const Camera& camera);

}  // namespace photon_splat
