// Where nothing stands in kernel discs: a memory that spares most points the look for it.
#pragma once

#include "math/vec.h"
#include "util/count_table.h"

namespace photon_splat {

// Surfaces are divided into cubes of one to two kernel radii. Where the discs of enough points in
// one of them have all been clear, most later ones are taken to be. Some still are looked at, and
// where one is not clear all are from then on.
class ClearRegions {
 public:
  // The region of a disc of radius h about x on the surface `key`.
  static uint64_t region(uint32_t key, const Vec3& x, float h);

  // Whether to look at a disc there. `chance`: any number, evenly distributed.
  bool to_look_at(uint64_t region, uint32_t chance) const;
  // What a look has found. Not while other threads ask.
  void learn(uint64_t region, bool clear);

 private:
  // Clear discs; one of so many is looked at all the same
  static constexpr uint32_t kEnough = 16, kStill = 16;

  CountTable clear_, obstructed_;
};

}  // namespace photon_splat
