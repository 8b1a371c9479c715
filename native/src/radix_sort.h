// Sorting by whole numbers, in time that goes with how many there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace photon_splat {

// Sorts `values` (a vector) by the bits [from, to) of key(value), an unsigned integer; what has equal ones stays in order.
// `scratch`: of the same type, for its memory.
template <class Array, class Key>
void radix_sort(Array& values, Array& scratch, int from, int to, Key&& key) {
  constexpr int kMostBits = 11;
  const int passes = std::max(1, (to - from + kMostBits - 1) / kMostBits), bits = (to - from + passes - 1) / passes;
  scratch.resize(values.size());
  for (int shift = from; shift < to; shift += bits) {
    const uint64_t mask = (uint64_t{1} << std::min(bits, to - shift)) - 1;
    size_t start[(1 << kMostBits) + 1] = {};
    for (const auto& value : values) ++start[(key(value) >> shift & mask) + 1];
    for (size_t k = 0; k < mask; ++k) start[k + 1] += start[k];
    for (const auto& value : values) scratch[start[key(value) >> shift & mask]++] = value;
    values.swap(scratch);
  }
}

}  // namespace photon_splat
