// The hash functions behind Blender's procedural textures: Bob Jenkins' lookup3 (public domain, 2006) on the bits of floats or
// integers, and PCG on integers (Jarzynski & Olano 2020, "Hash functions for GPU rendering"). Words may be lanes of words.
#pragma once

#include <bit>
#include <cstdint>

#include "../vec.h"
#include "lanes.h"

namespace photon_splat::nodes {

template <class Word>
inline Word rotate(const Word& x, int k) { return x << k | x >> (32 - k); }

// lookup3's last mixing of three words, of which the third is the hash.
template <class Word>
inline Word finish_hash(Word a, Word b, Word c) {
  c = (c ^ b) - rotate(b, 14);
  a = (a ^ c) - rotate(c, 11);
  b = (b ^ a) - rotate(a, 25);
  c = (c ^ b) - rotate(b, 16);
  a = (a ^ c) - rotate(c, 4);
  b = (b ^ a) - rotate(a, 14);
  return (c ^ b) - rotate(b, 24);
}
constexpr uint32_t hash_start(uint32_t words) { return 0xdeadbeefu + (words << 2) + 13; }

template <class Word>
inline Word lookup3(const Word& x) {
  const Word s = Word{} + hash_start(1);
  return finish_hash<Word>(s + x, s, s);
}
template <class Word>
inline Word lookup3(const Word& x, const Word& y) {
  const Word s = Word{} + hash_start(2);
  return finish_hash<Word>(s + x, s + y, s);
}
template <class Word>
inline Word lookup3(const Word& x, const Word& y, const Word& z) {
  const Word s = Word{} + hash_start(3);
  return finish_hash<Word>(s + x, s + y, s + z);
}
template <class Word>
inline Word lookup3(const Word& x, const Word& y, const Word& z, const Word& w) {
  const Word s = Word{} + hash_start(4);
  Word a = s + x, b = s + y, c = s + z;
  a = (a - c) ^ rotate(c, 4);  c += b;
  b = (b - a) ^ rotate(a, 6);  a += c;
  c = (c - b) ^ rotate(b, 8);  b += a;
  a = (a - c) ^ rotate(c, 16); c += b;
  b = (b - a) ^ rotate(a, 19); a += c;
  c = (c - b) ^ rotate(b, 4);  b += a;
  return finish_hash<Word>(a + w, b, c);
}

// In [0, 1], of the bits of the floats.
template <class... Floats>
float random_of(Floats... k) {
  return static_cast<float>(lookup3(std::bit_cast<uint32_t>(static_cast<float>(k))...)) * (1.0f / 4294967295.0f);
}

inline Vec3 random_color(float x) { return {random_of(x), random_of(x, 1.0f), random_of(x, 2.0f)}; }
inline Vec3 random_color(float x, float y) { return {random_of(x, y), random_of(x, y, 1.0f), random_of(x, y, 2.0f)}; }
inline Vec3 random_color(float x, float y, float z) {
  return {random_of(x, y, z), random_of(x, y, z, 1.0f), random_of(x, y, z, 2.0f)};
}
inline Vec3 random_color(float x, float y, float z, float w) {
  return {random_of(x, y, z, w), random_of(z, x, w, y), random_of(w, z, y, x)};
}

}  // namespace photon_splat::nodes
