// Light groups: what each of them adds to the picture is kept apart. A photon knows its light's
// group by the number beside it; photons are splatted group by group, so that each is splatted
// once.
#pragma once

#include "density/splatter.h"

namespace photon_splat {

class LightGroupSums {
 public:
  // For points in `blocks`, all sums 0. Without groups nothing is kept.
  void reset(const PointBlocks& blocks, int groups) {
    groups_ = groups;
    sums_.assign(blocks.size() * groups, Sums{});
  }
  // Splats photons whose groups are `groups`: those of none into the blocks, which hold the rest
  // until join().
  void splat(Splatter& splatter, const Photons& photons, const std::vector<int16_t>& groups,
             PointBlocks& blocks, WaySums& ways, ThreadPool& pool, const CancelFlag& cancel);
  // Adds the groups' sums to the rest that is in the blocks.
  void join(PointBlocks& blocks) const;
  // The sum of a light group at a point, of `block_count` blocks of points.
  Rgb at(int group, uint32_t point, size_t block_count) const {
    const Sums& sums = sums_[group * block_count + point / kBlockSize];
    const uint32_t lane = point % kBlockSize;
    return {sums.r[lane], sums.g[lane], sums.b[lane]};
  }

 private:
  // What photons of one light group have added to a block of points.
  struct alignas(64) Sums {
    float r[kBlockSize], g[kBlockSize], b[kBlockSize];
  };
  void swap(PointBlocks& blocks, int group);

  int groups_ = 0;
  std::vector<Sums> sums_;  // of each group, one for each block
  Photons of_group_;        // of one group, while they are splatted
};

}  // namespace photon_splat
