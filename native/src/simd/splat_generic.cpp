// The splatting loop in plain C++, for compilers and machines without a vector version, and to test
// those against.
#include "density/point_block.h"

namespace photon_splat {

namespace {

void add(PointBlock& block, const SplatPart& part, const SplatGroup& p, uint32_t k) {
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
  }
}

}  // namespace

void splat_part_generic(PointBlock& block, const SplatPart& part, const SplatGroup* groups,
                        const uint32_t* numbers, uint32_t count) {
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t k = 0; k < kGroupSize; ++k)
      if (groups[numbers[i]].key[k] == part.key) add(block, part, groups[numbers[i]], k);
}

}  // namespace photon_splat
