#include "atlas.h"

namespace photon_splat {

void Atlas::pack(const std::vector<PointBlock>& blocks, float* position, float* normal, uint32_t* key, ThreadPool& pool,
                 const CancelFlag& cancel) const {
  pool.for_each(count, cancel, [&](size_t i, int) {
    const PointBlock& b = blocks[first + i];
    for (size_t l = 0; l < kBlockSize; ++l) {
      const size_t at = texel(first + i, l);
      const float p[4] = {b.x[l], b.y[l], b.z[l], b.inverse_h2[l]}, n[4] = {b.nx[l], b.ny[l], b.nz[l], 0};
      for (size_t c = 0; c < 4; ++c) {
        position[4 * at + c] = p[c];
        normal[4 * at + c] = n[c];
      }
      key[at] = b.key[l];
    }
  });
}

void Atlas::unpack(const float* sums, std::vector<PointBlock>& blocks, ThreadPool& pool, const CancelFlag& cancel) const {
  pool.for_each(count, cancel, [&](size_t i, int) {
    PointBlock& b = blocks[first + i];
    for (size_t l = 0; l < kBlockSize; ++l) {
      const float* s = sums + 4 * texel(first + i, l);
      b.r[l] = s[0];
      b.g[l] = s[1];
      b.b[l] = s[2];
      b.count[l] = s[3];
    }
  });
}

}  // namespace photon_splat
