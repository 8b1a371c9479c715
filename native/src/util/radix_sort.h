// Sorting by whole numbers, in time that goes with how many there are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "util/parallel.h"

namespace photon_splat {

// Sorts `values` by the bits [from, to) of key(value), an unsigned integer; what has equal ones
// stays in order. `scratch`: as many, which are in order in the end if `values` are not; returns
// those that are. `pool`: threads that share the work, or null.
template <class Value, class Key>
std::span<Value> radix_sort(std::span<Value> values, std::span<Value> scratch, int from, int to,
                            ThreadPool* pool, Key&& key) {
  constexpr int kMostBits = 11;
  constexpr size_t kFew = size_t{1} << 15;  // that are counted, and moved, by one thread
  const int passes = std::max(1, (to - from + kMostBits - 1) / kMostBits),
            bits = (to - from + passes - 1) / passes;
  const size_t parts =
      pool ? std::clamp<size_t>(values.size() / kFew, 1, static_cast<size_t>(pool->size())) : 1;
  const size_t size = (values.size() + parts - 1) / parts;
  const auto for_parts = [&](auto&& work) {
    if (parts == 1) return work(size_t{0}, values.size());
    pool->for_parts(values.size(), size, CancelFlag(), work);
  };
  std::vector<size_t> starts(parts << bits);
  for (int shift = from; shift < to; shift += bits) {
    const uint64_t mask = (uint64_t{1} << std::min(bits, to - shift)) - 1;
    const auto digit = [&](const auto& value) { return key(value) >> shift & mask; };
    std::fill(starts.begin(), starts.end(), 0);
    for_parts([&](size_t begin, size_t end) {
      size_t* const start = &starts[begin / std::max<size_t>(size, 1) << bits];
      for (size_t i = begin; i < end; ++i) ++start[digit(values[i])];
    });
    size_t at = 0;
    for (size_t k = 0; k <= mask; ++k)
      for (size_t part = 0; part < parts; ++part)
        at += std::exchange(starts[(part << bits) + k], at);
    for_parts([&](size_t begin, size_t end) {
      size_t* const start = &starts[begin / std::max<size_t>(size, 1) << bits];
      for (size_t i = begin; i < end; ++i) scratch[start[digit(values[i])]++] = values[i];
    });
    std::swap(values, scratch);
  }
  return values;
}

// The same, where both are vectors, into `values`.
template <class Array, class Key>
void radix_sort(Array& values, Array& scratch, int from, int to, ThreadPool* pool, Key&& key) {
  scratch.resize(values.size());
  const std::span all(values), sorted = radix_sort(all, std::span(scratch), from, to, pool, key);
  if (sorted.data() != all.data()) values.swap(scratch);
}

}  // namespace photon_splat
