// Volume grids for tests.
#pragma once

#include "textures/volume_grid.h"

namespace photon_splat {

// `value(x, y, z, component)` at the voxels from `lower` to `upper`, without the last; 0 elsewhere.
template <class Function>
VolumeGrid grid_of(const VolumeGrid::Index& lower, const VolumeGrid::Index& upper,
                   const Affine& to_index, uint32_t components, Function&& value) {
  constexpr int kSide = VolumeGrid::kSide;
  VolumeGrid::Index bricks;
  for (size_t a = 0; a < 3; ++a) bricks[a] = (upper[a] - lower[a] + kSide - 1) / kSide;
  std::vector<int32_t> table;
  std::vector<float> values;
  for (int bx = 0; bx < bricks[0]; ++bx)
    for (int by = 0; by < bricks[1]; ++by)
      for (int bz = 0; bz < bricks[2]; ++bz) {
        std::vector<float> own;
        bool any = false;
        for (int k = 0; k < VolumeGrid::kVoxels; ++k) {
          const int x = lower[0] + bx * kSide + k / 64, y = lower[1] + by * kSide + k / 8 % 8,
                    z = lower[2] + bz * kSide + k % 8;
          for (uint32_t c = 0; c < components; ++c) {
            const bool inside = x < upper[0] && y < upper[1] && z < upper[2];
            own.push_back(inside ? static_cast<float>(value(x, y, z, c)) : 0.0f);
            any |= own.back() != 0;
          }
        }
        table.push_back(any ? static_cast<int32_t>(values.size() / own.size()) : -1);
        if (any) values.insert(values.end(), own.begin(), own.end());
      }
  return VolumeGrid(components, to_index, lower, bricks, table, values, {});
}

}  // namespace photon_splat
