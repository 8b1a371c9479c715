// A set of surfaces by their keys, for questions that are asked once a photon.
#pragma once

#include <algorithm>
#include <vector>

#include "math/sampling.h"

namespace photon_splat {

// Which surface keys are visible; may say yes for one that is not, never no for one that is.
class SurfaceFilter {
 public:
  SurfaceFilter() : bits_(kBits / 64) {}
  void clear() { std::fill(bits_.begin(), bits_.end(), 0); }
  void add_all() { std::fill(bits_.begin(), bits_.end(), ~uint64_t{0}); }
  void add(const SurfaceFilter& other) {
    for (size_t i = 0; i < bits_.size(); ++i) bits_[i] |= other.bits_[i];
  }
  void add(uint32_t key) { bits_[slot(key) / 64] |= uint64_t{1} << (slot(key) % 64); }
  bool contains(uint32_t key) const { return bits_[slot(key) / 64] >> (slot(key) % 64) & 1; }

 private:
  static constexpr uint32_t kBits = 1 << 18;
  static uint32_t slot(uint32_t key) { return hash32(key) & (kBits - 1); }
  std::vector<uint64_t> bits_;
};

}  // namespace photon_splat
