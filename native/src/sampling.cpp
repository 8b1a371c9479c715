#include "sampling.h"

namespace photon_splat {
namespace {

// The second Sobol' dimension in bit-reversed form: table[byte][value] is the XOR of the direction numbers of that byte's set bits.
struct SecondDimension {
  uint32_t table[4][256];

  constexpr SecondDimension() : table{} {
    uint32_t direction[32] = {};
    direction[0] = 0x80000000u;
    for (int i = 1; i < 32; ++i) direction[i] = direction[i - 1] ^ (direction[i - 1] >> 1);
    for (int byte = 0; byte < 4; ++byte)
      for (int value = 0; value < 256; ++value)
        for (int bit = 0; bit < 8; ++bit)
          if (value >> bit & 1) table[byte][value] ^= direction[byte * 8 + bit];
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
uint32_t owen_scramble(uint32_t x, uint32_t seed) { return reverse_bits(owen_scramble_reversed(reverse_bits(x), seed)); }

}  // namespace

Vec2 sobol_2d(uint32_t index, uint32_t dimension, uint32_t seed) {
  const uint32_t key = hash_combine(seed, dimension);
  const uint32_t i = owen_scramble(index, key);
  const uint32_t first = reverse_bits(i);
  const uint32_t second = kSecond.table[0][i & 255] ^ kSecond.table[1][i >> 8 & 255] ^
                          kSecond.table[2][i >> 16 & 255] ^ kSecond.table[3][i >> 24];
  return {to_unit_float(owen_scramble(first, hash32(key ^ 0x68bc21ebu))),
          to_unit_float(owen_scramble(second, hash32(key ^ 0x02e5be93u)))};
}

}  // namespace photon_splat
