// The splatting loop in plain C++, for compilers and machines without a vector version, and to test those against.
#include "../point_block.h"

namespace photon_splat {

namespace {

void add(PointBlock& block, const SplatPhoton& p) {
  for (uint32_t lane = 0; lane < kBlockSize; ++lane) {
    const float dx = p.x - block.x[lane], dy = p.y - block.y[lane], dz = p.z - block.z[lane];
    const float relative = (dx * dx + dy * dy + dz * dz) * block.inverse_h2[lane], kernel = 1 - relative, within = kernel - relative;
    const float facing = kNormalWeightSlope * (block.nx[lane] * p.nx + block.ny[lane] * p.ny + block.nz[lane] * p.nz);
    if (!(kernel > 0) || !(facing > 0) || p.key != block.key[lane]) continue;
    const float shared = facing < 1 ? facing : 1, weight = kernel * shared;
    block.r[lane] += weight * p.r;
    block.g[lane] += weight * p.g;
    block.b[lane] += weight * p.b;
    block.count[lane] += 1;
    if (within > 0) block.narrow[lane] += within * shared * p.luminance;
  }
}

}  // namespace

void splat_block_generic(PointBlock& block, const PartBounds&, const SplatPhotons& photons, const SplatRun* runs, uint32_t count) {
  for (const SplatRun* run = runs; run != runs + count; ++run)
    for (uint32_t i = run->begin; i < run->end; ++i) add(block, photons.photons[i]);
}

}  // namespace photon_splat
