// Bob Jenkins' hash lookup3 (public domain, 2006) of one to four words, which may be vectors of
// words. Everything here is static: it is also compiled for other instruction sets (see
// cmake/SimdKernels.cmake).
#pragma once

#include <cstdint>

namespace photon_splat::nodes {

template <class Word>
static inline Word rotate(const Word& x, int k) {
  return x << k | x >> (32 - k);
}

// lookup3's last mixing of three words, of which the third is the hash. kLow: of which its lowest
// six bits are, for less.
template <bool kLow, class Word>
static inline Word finish_hash(Word a, Word b, Word c) {
  c = (c ^ b) - rotate(b, 14);
  a = (a ^ c) - rotate(c, 11);
  b = (b ^ a) - rotate(a, 25);
  c = (c ^ b) - rotate(b, 16);
  a = (a ^ c) - rotate(c, 4);
  if constexpr (kLow) return b = (b ^ a) - (a >> 18), (c ^ b) - (b >> 8);
  b = (b ^ a) - rotate(a, 14);
  return (c ^ b) - rotate(b, 24);
}
template <class Word>
static inline Word hash_start(uint32_t words) {
  return Word{} + (0xdeadbeefu + (words << 2) + 13);
}

template <bool kLow = false, class Word>
static inline Word lookup3(const Word& x) {
  const Word s = hash_start<Word>(1);
  return finish_hash<kLow>(s + x, s, s);
}
template <bool kLow = false, class Word>
static inline Word lookup3(const Word& x, const Word& y) {
  const Word s = hash_start<Word>(2);
  return finish_hash<kLow>(s + x, s + y, s);
}
template <bool kLow = false, class Word>
static inline Word lookup3(const Word& x, const Word& y, const Word& z) {
  const Word s = hash_start<Word>(3);
  return finish_hash<kLow>(s + x, s + y, s + z);
}
template <bool kLow = false, class Word>
static inline Word lookup3(const Word& x, const Word& y, const Word& z, const Word& w) {
  const Word s = hash_start<Word>(4);
  Word a = s + x, b = s + y, c = s + z;
  a = (a - c) ^ rotate(c, 4);
  c += b;
  b = (b - a) ^ rotate(a, 6);
  a += c;
  c = (c - b) ^ rotate(b, 8);
  b += a;
  a = (a - c) ^ rotate(c, 16);
  c += b;
  b = (b - a) ^ rotate(a, 19);
  a += c;
  c = (c - b) ^ rotate(b, 4);
  b += a;
  return finish_hash<kLow>(a + w, b, c);
}

}  // namespace photon_splat::nodes
