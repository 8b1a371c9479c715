// What rays have met, many side by side: plain data, included by files that are compiled for
// several instruction sets. Nothing here may define a function: the linker would keep one copy for
// all machines.
#pragma once

#include <cstdint>

namespace photon_splat {

struct alignas(64) RayHits {
  static constexpr uint32_t kMost = 16;
  float x[kMost], y[kMost], z[kMost], distance[kMost];  // m
  // Geometric normal: unit, on the side the ray came from
  float nx[kMost], ny[kMost], nz[kMost];
  float u[kMost], v[kMost];  // barycentric
  uint32_t instance[kMost], triangle[kMost];
  uint32_t back[kMost];  // not 0: the ray came from the back
};

// What tracing light needs to know of surfaces whose materials have an albedo and no program.
struct alignas(64) PlainSurfaces {
  // Shading normal of the front, of any length; 0: the geometric one
  float nx[RayHits::kMost], ny[RayHits::kMost], nz[RayHits::kMost];
  float red[RayHits::kMost], green[RayHits::kMost], blue[RayHits::kMost];  // albedo
  uint32_t key[RayHits::kMost];                                            // Surface::key
  float rounding[RayHits::kMost];                                          // Surface::rounding
};

}  // namespace photon_splat
