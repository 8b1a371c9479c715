// Blocks of points as 8x8 tiles of images, as a graphics card wants them, and the way back.
#pragma once

#include <vector>

#include "density/point_blocks.h"
#include "util/parallel.h"

namespace photon_splat {

// Blocks [first, first + count) as tiles, `columns` to a row, rows from the first up. Images are
// columns * 8 texels wide and rows() * 8 high; lane l of a block is texel (l % 8, l / 8) of its
// tile.
struct Atlas {
  static constexpr size_t kTile = 8;

  size_t first, count, columns;

  size_t rows() const { return (count + columns - 1) / columns; }
  size_t texels() const { return rows() * columns * kTile * kTile; }
  size_t texel(size_t block, size_t lane) const {
    const size_t tile = block - first;
    return (tile / columns * kTile + lane / kTile) * columns * kTile + tile % columns * kTile +
           lane % kTile;
  }

  // position: x, y, z, 1/h^2 (the largest float where there is no point); plane: bits of the
  // normal's x, y, z, and the key. Tiles beyond the last block are left as they are.
  void pack(const PointBlocks& blocks, float* position, uint32_t* plane, ThreadPool& pool,
            const CancelFlag& cancel) const;
  // sums: red, green, blue, count, narrow. They replace those of the blocks.
  static constexpr size_t kSums = 5;
  void unpack(const float* sums, PointBlocks& blocks, ThreadPool& pool,
              const CancelFlag& cancel) const;
};

static_assert(Atlas::kTile * Atlas::kTile == kBlockSize);

}  // namespace photon_splat
