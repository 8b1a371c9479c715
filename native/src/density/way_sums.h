// Sums of the ways that photons have come by, for points with bumps around them.
#pragma once

#include <vector>

#include "density/point_block.h"
#include "math/bumps.h"
#include "util/large_pages.h"

namespace photon_splat {

// Of the blocks whose points some gather point asks for light on bumps.
class WaySums {
 public:
  void reset(size_t block_count) {
    first_.assign(block_count, kNone);
    sums_.resize(0);
  }
  // Of block b, once or more; then set_up(), which makes all sums 0.
  void want(size_t b) { first_[b] = 0; }
  void set_up();

  bool empty() const { return sums_.empty(); }
  WayBlock* of(size_t b) { return empty() || first_[b] == kNone ? nullptr : &sums_[first_[b]]; }
  // What an offset of the normal adds to the sums of power at a point, of a block that is wanted.
  Rgb added(size_t b, uint32_t lane, const Vec3& offset) const {
    const WayBlock& at = sums_[first_[b]];
    const auto along = [&](const float (&sums)[3][kBlockSize]) {
      return offset.x * sums[0][lane] + offset.y * sums[1][lane] + offset.z * sums[2][lane];
    };
    return {along(at.r), along(at.g), along(at.b)};
  }

 private:
  static constexpr uint32_t kNone = ~0u;
  std::vector<uint32_t> first_;  // by block: its place in sums_
  LargeArray<WayBlock> sums_;
};

}  // namespace photon_splat
