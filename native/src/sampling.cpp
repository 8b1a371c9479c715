#include "sampling.h"

namespace photon_splat {
namespace {

// The second Sobol' dimension with its bits reversed: table[byte][value] is the XOR of the reversed direction numbers of
// that byte's set bits. Reversed, a point can be scrambled without turning its bits round first.
struct SecondDimension {
  uint32_t table[4][256];

  constexpr SecondDimension() : table{} {
    uint32_t direction = 0x80000000u;
    for (int i = 0; i < 32; ++i, direction ^= direction >> 1) {
      uint32_t reversed = 0;
      for (int bit = 0; bit < 32; ++bit) reversed |= (direction >> bit & 1) << (31 - bit);
      for (int value = 0; value < 256; ++value)
        if (value >> (i % 8) & 1) table[i / 8][value] ^= reversed;
    }
  }
};
constexpr SecondDimension kSecond;

uint32_t reverse_bits(uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

// Nested uniform scrambling of a number whose bits are already reversed (Laine & Karras 2011, constants of Vegdahl 2021).
uint32_t owen_scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

}  // namespace

Vec2 sobol_2d(uint32_t index, uint32_t dimension, uint32_t seed) {
  const uint32_t key = hash_combine(seed, dimension);
  // The shuffled index; its first Sobol' dimension is its bits reversed, so that the index itself is that dimension reversed.
  const uint32_t i = reverse_bits(owen_scramble_reversed(reverse_bits(index), key));
  const uint32_t second_reversed = kSecond.table[0][i & 255] ^ kSecond.table[1][i >> 8 & 255] ^
                                   kSecond.table[2][i >> 16 & 255] ^ kSecond.table[3][i >> 24];
  return {to_unit_float(reverse_bits(owen_scramble_reversed(i, hash32(key ^ 0x68bc21ebu)))),
          to_unit_float(reverse_bits(owen_scramble_reversed(second_reversed, hash32(key ^ 0x02e5be93u))))};
}

}  // namespace photon_splat
