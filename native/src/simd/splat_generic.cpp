// The splatting loop in plain C++, for compilers and machines without a vector version, and to test
// those against.
#include "density/point_block.h"

namespace photon_splat {

namespace {

void add(PointBlock& block, const SplatPart& part, const SplatGroup& p, uint32_t k,
         const WayGroup* ways, WayBlock* way_sums) {
  for (uint32_t lane = part.first; lane < part.first + kPartSize; ++lane) {
    const float dx = p.x[k] - block.x[lane], dy = p.y[k] - block.y[lane],
                dz = p.z[k] - block.z[lane];
    const float relative = (dx * dx + dy * dy + dz * dz) * block.inverse_h2[lane],
                kernel = 1 - relative, within = kernel - relative;
    const float facing = kNormalWeightSlope * (block.nx[lane] * p.nx[k] + block.ny[lane] * p.ny[k] +
                                               block.nz[lane] * p.nz[k]);
    if (!(kernel > 0) || !(facing > 0) || block.key[lane] != part.key) continue;
    const float shared = facing < 1 ? facing : 1, weight = kernel * shared;
    block.r[lane] += weight * p.r[k];
    block.g[lane] += weight * p.g[k];
    block.b[lane] += weight * p.b[k];
    block.count[lane] += 1;
    if (within > 0) block.narrow[lane] += within * shared * p.luminance[k];
    if (!way_sums) continue;
    const float way[3] = {weight * ways->x[k], weight * ways->y[k], weight * ways->z[k]};
    for (int axis = 0; axis < 3; ++axis) {
      way_sums->r[axis][lane] += way[axis] * p.r[k];
      way_sums->g[axis][lane] += way[axis] * p.g[k];
      way_sums->b[axis][lane] += way[axis] * p.b[k];
    }
  }
}

}  // namespace

void splat_part_generic(PointBlock& block, const SplatPart& part, const Splatted& photons,
                        const uint32_t* numbers, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i) {
    const SplatGroup& group = photons.groups[numbers[i]];
    const WayGroup* const ways = photons.way_sums ? &photons.ways[numbers[i]] : nullptr;
    for (uint32_t k = 0; k < kGroupSize; ++k)
      if (group.key[k] == part.key) add(block, part, group, k, ways, photons.way_sums);
  }
}

}  // namespace photon_splat
