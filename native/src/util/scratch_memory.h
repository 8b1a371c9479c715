// Memory for arrays that are needed for a while: one piece, which each step uses again, as touching
// new memory takes longer than most of what is done in it.
#pragma once

#include <cassert>
#include <cstddef>
#include <span>
#include <type_traits>

#include "util/large_pages.h"

namespace photon_splat {

class ScratchMemory {
 public:
  // For the arrays of the next step, which take so many bytes in all and come as they are; those of
  // the last one are gone.
  void begin(std::size_t bytes) {
    used_ = 0;
    bytes += kMostArrays * kAlign;
    if (bytes <= memory_.size()) return;
    memory_ = {};  // first
    memory_.resize(bytes);
  }

  template <class T>
  std::span<T> take(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlign);
    T* const first = reinterpret_cast<T*>(memory_.data() + used_);
    used_ += (count * sizeof(T) + kAlign - 1) / kAlign * kAlign;
    assert(used_ <= memory_.size());
    return {first, count};
  }

 private:
  static constexpr std::size_t kAlign = 16, kMostArrays = 8;

  LargeArray<std::byte> memory_;
  std::size_t used_ = 0;
};

}  // namespace photon_splat
