// Surfaces that lie exactly in each other, as doubled faces do.
#pragma once

#include "scene/camera.h"
#include "scene/scene.h"

namespace photon_splat {

struct Coincident {
  uint32_t instance;  // the one that rays meet first, or that lets them pass
  uint32_t other;     // may be the same
  float share;        // of the picture, and a quarter of what is seen by one diffuse reflection
  bool passed;        // light passes the one, and meets the other
};

// Pairs of surfaces that lie in each other where the camera sees them or what they light, the
// largest share first. In a renderer that leaves out nothing but the triangle that a ray starts
// from, a ray from one of two opaque ones meets the other at once, or by chance, which decides
// whether light reaches it. Of an opaque one and a pane, a decal or the end of a fog, a ray that
// passes the latter misses the former.
std::vector<Coincident> coincident_surfaces(const Scene& scene, const Camera& camera);

}  // namespace photon_splat
