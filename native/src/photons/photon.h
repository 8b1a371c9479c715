// Light that arrived on a diffuse surface after at least one bounce.
#pragma once

#include "math/vec.h"
#include "util/large_pages.h"

namespace photon_splat {

struct Photon {
  Vec3 position;    // m, relative to the scene's origin
  uint32_t key;     // surface patch and side
  uint16_t normal;  // geometric normal on the side it hit, encoded
  uint16_t from;    // way_for_smooth() of the direction towards where it came from, encoded
  Rgb power;        // W; the shading normal's factor |w.ns|/|w.ng| is in it
};
static_assert(sizeof(Photon) == 32);
using Photons = LargeArray<Photon>;

}  // namespace photon_splat
