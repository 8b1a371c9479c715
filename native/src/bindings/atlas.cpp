#include "bindings/atlas.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace photon_splat {

void Atlas::pack(const PointBlocks& blocks, float* position, uint32_t* plane, ThreadPool& pool,
                 const CancelFlag& cancel) const {
  pool.for_each(count, cancel, [&](size_t i, int) {
    const PointBlock& b = blocks[first + i];
    for (size_t l = 0; l < kBlockSize; ++l) {
      const size_t at = 4 * texel(first + i, l);
      position[at] = b.x[l];
      position[at + 1] = b.y[l];
      position[at + 2] = b.z[l];
      // GLSL 3.30 need not know infinity
      position[at + 3] = std::min(b.inverse_h2[l], std::numeric_limits<float>::max());
      plane[at] = std::bit_cast<uint32_t>(b.nx[l]);
      plane[at + 1] = std::bit_cast<uint32_t>(b.ny[l]);
      plane[at + 2] = std::bit_cast<uint32_t>(b.nz[l]);
      plane[at + 3] = b.key[l];
    }
  });
}

void Atlas::unpack(const float* sums, PointBlocks& blocks, ThreadPool& pool,
                   const CancelFlag& cancel) const {
  pool.for_each(count, cancel, [&](size_t i, int) {
    PointBlock& b = blocks[first + i];
    for (size_t l = 0; l < kBlockSize; ++l) {
      const float* s = sums + kSums * texel(first + i, l);
      b.r[l] = s[0];
      b.g[l] = s[1];
      b.b[l] = s[2];
      b.count[l] = s[3];
      b.narrow[l] = s[4];
    }
  });
}

}  // namespace photon_splat
