// What stands inside a kernel disc on a bent patch.
#pragma once

#include "scene/scene.h"

namespace photon_splat {

// Whether something else stands on a bent patch, or the patch runs into it, within a disc of radius
// h about x: what rays along the surface meet, level or a little downwards as it may bend away, if
// the patch goes on behind it.
bool stands_in_bent_disc(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                         const Vec3& x, const Vec3& normal, float h);

// One over the shares of the kernels of radius h and kNarrow * h about x that photons reach: of
// balls that run into each other not what lies inside of the other, of a table not what a sheet of
// paper covers, unless it covers x. A place of the patch is inside of what the way there, close
// over the surface, enters and does not leave. Both are estimates, right in the mean.
struct OverOpen {
  float whole = 1, narrow = 1;
};
OverOpen over_open_share(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                         const Vec3& x, const Vec3& normal, float h, uint32_t seed);

}  // namespace photon_splat
