// Places along a Morton curve: what is near in space is mostly near along it.
#pragma once

#include <cstdint>

namespace photon_splat {

// Puts two zeros before each of the lowest 21 bits.
inline uint64_t spread_bits(uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

// Morton code of the cell (x, y, z), of which the lowest 21 bits count.
inline uint64_t morton(uint64_t x, uint64_t y, uint64_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

}  // namespace photon_splat
