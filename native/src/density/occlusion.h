// What stands inside a kernel disc: things on the surface hide part of it from photons, walls cut
// it in two.
#pragma once

#include "scene/scene.h"

namespace photon_splat {

// `hidden` and `narrow_hidden`: the parts of the kernels of radius h and kNarrow * h that lie on
// the patch of x where no photon lands: inside of closed things (enclosure.h), or covered by
// something opaque that lies, or hovers, closer over the surface than a small share of h. The
// kernel mass without them is M minus these. `clear`: how far the disc may reach before it takes in
// surface on the other side of a wall, at most h. A wall that hovers close over the surface is one,
// and in the gap below it no disc is wide. Walls and closed things are found by rays that graze the
// surface from x to the rim of its disc; only where one meets something is the surface beyond
// looked at. Bent patches are taken for unobstructed: see bent_occlusion.h.
struct DiscOcclusion {
  float hidden = 0, narrow_hidden = 0, clear = 0;
  Vec3 wall = {};  // the way from x to the nearest wall, if clear < h
};
DiscOcclusion disc_occlusion(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                             const Vec3& x, const Vec3& normal, float h, uint32_t seed);

// Moves x, which stands `near.clear` from a wall, away from it along its planar patch, until a disc
// of radius r there keeps off all walls; `near` becomes what stands in that disc. False, and
// nothing is changed, where there is no such place within a few radii.
bool step_clear_of_walls(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                         Vec3& x, const Vec3& normal, float r, uint32_t seed, DiscOcclusion& near);

// Whether something that stops photons stands between two places close over a surface of an
// instance, h being the radius of discs there.
bool wall_between(const Scene& scene, uint32_t instance, const Vec3& a, const Vec3& b,
                  const Vec3& normal, float h);

}  // namespace photon_splat
