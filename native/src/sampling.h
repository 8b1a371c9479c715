// Random numbers and warps. Every number is a function of indices and a seed, never of the thread that asks.
#pragma once

#include "vec.h"

namespace photon_splat {

struct Vec2 {
  float x = 0, y = 0;
};

inline uint32_t hash32(uint32_t x) {  // an integer finalizer with low bias (Wellons, "Prospecting for hash functions")
  x ^= x >> 16; x *= 0x7feb352du;
  x ^= x >> 15; x *= 0x846ca68bu;
  return x ^ (x >> 16);
}
inline uint32_t hash_combine(uint32_t a, uint32_t b) { return hash32(a ^ (b + 0x9e3779b9u + (a << 6) + (a >> 2))); }
inline uint64_t hash64(uint64_t x) {  // SplitMix64 finalizer (Steele et al. 2014)
  x ^= x >> 30; x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27; x *= 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
inline float to_unit_float(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }  // [0, 1)

// Independent uniform numbers, a PCG-XSH-RR stream per path (O'Neill 2014).
class Random {
 public:
  Random(uint64_t index, uint32_t seed) : state_(hash64(index * 0x9e3779b97f4a7c15ull + hash64(seed + 1ull))) {}
  float next() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005ull + 1442695040888963407ull;
    const uint32_t shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
    const uint32_t rotate = static_cast<uint32_t>(old >> 59);
    return to_unit_float((shifted >> rotate) | (shifted << ((32 - rotate) & 31)));
  }
  Vec2 next2() { const float a = next(); return {a, next()}; }

 private:
  uint64_t state_;
};

// Owen-scrambled Sobol' points, padded from 2D pairs (Burley 2020, "Practical hash-based Owen scrambling").
// `index` counts samples of one sequence; `dimension` picks a pair decorrelated from all others.
Vec2 sobol_2d(uint32_t index, uint32_t dimension, uint32_t seed);

inline Vec2 sample_disk(const Vec2& u) {  // concentric map, uniform in area (Shirley & Chiu 1997)
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {0, 0};
  const bool wide = std::abs(a) > std::abs(b);
  const float r = wide ? a : b;
  const float phi = wide ? kPi / 4 * (b / a) : kPi / 2 - kPi / 4 * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}
inline Vec3 sample_cosine_hemisphere(const Vec2& u) {  // pdf cos(theta)/pi
  const Vec2 d = sample_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y))};
}
inline Vec3 sample_sphere(const Vec2& u) {  // pdf 1/(4 pi)
  const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z));
  return {r * std::cos(2 * kPi * u.y), r * std::sin(2 * kPi * u.y), z};
}
// Uniform in the cone around +Z with 1 - cos(half angle) given (exact for tiny cones); pdf 1/(2 pi (1 - cos)).
inline Vec3 sample_cone(const Vec2& u, float one_minus_cos) {
  const Vec2 d = sample_disk(u);
  const float r2 = d.x * d.x + d.y * d.y, z_drop = r2 * one_minus_cos;
  const float scale = std::sqrt(one_minus_cos * (2 - z_drop));
  return {d.x * scale, d.y * scale, 1 - z_drop};
}

}  // namespace photon_splat
