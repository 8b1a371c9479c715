// One of the renders whose sums make a picture together: a part on one of many machines, and in a
// part a generation, which is what follows an interruption.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "math/sampling.h"

namespace photon_splat {

// What is learnt and decided before the passes comes from the seed that all parts have in common;
// passes have random numbers of their own, and a generation goes on in the sequences of those
// before it: low-discrepancy samples that began anew would err as if each generation were a part.
// A disc shrinks with the paths of all parts together: parts that shrank theirs each for itself
// would keep the bias of one part, which is count^(1/3) times as large.
struct RenderPart {
  uint32_t number = 1, count = 1;  // number 1 of 1, generation 0: the whole, as if there were none
  uint32_t generation = 0;
  // Of the generations before: passes, and photon paths of each photon map
  uint32_t passes_before = 0;
  std::vector<uint64_t> paths_before{};

  bool whole() const { return number == 1 && count == 1 && generation == 0; }
  // Of the passes' random numbers, from the common seed of their stream.
  uint32_t own(uint32_t seed) const {
    return number == 1 && count == 1 ? seed : hash_combine(hash_combine(seed, number), 0x9a27u);
  }
  // Photon paths of photon map `map` that are done when this generation has done `done` of them.
  uint64_t paths_done(size_t map, uint64_t done) const {
    return map < paths_before.size() ? paths_before[map] + done : done;
  }
  // In how many paths a pass of `next` of them ends that follows `done` of photon map `map`: parts
  // are taken for equal, and to be `number` passes of the whole one after the other.
  double paths(size_t map, uint64_t done, uint64_t next) const {
    return static_cast<double>(uint64_t{count} * paths_done(map, done) + uint64_t{number} * next);
  }
  // The same of passes.
  double passes(uint64_t done) const {
    return static_cast<double>(uint64_t{count} * (passes_before + done) + number);
  }
};

}  // namespace photon_splat
