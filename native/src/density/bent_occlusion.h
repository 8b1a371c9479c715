// What stands inside a kernel disc on a bent patch.
#pragma once

#include "density/occlusion.h"

namespace photon_splat {

// Whether something else stands on a bent patch, or the patch runs into it, within a disc of radius
// h about x: what rays along the surface meet, level or a little downwards as it may bend away, if
// the patch goes on behind it.
bool stands_in_bent_disc(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                         const Vec3& x, const Vec3& normal, float h);

// Sets the shares of the kernels about x that lie inside of other closed things: of balls that run
// into each other the parts that no photon reaches. A place of the patch is inside of what the way
// there, close over the surface, enters and does not leave.
void hide_in_bent_disc(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                       const Vec3& x, const Vec3& normal, float h, uint32_t seed,
                       DiscOcclusion& out);

}  // namespace photon_splat
