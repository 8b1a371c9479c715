// Random numbers and warps. Every number is a function of indices and a seed, never of the thread
// that asks.
#pragma once

#include <bit>
#include <string>

#include "math/sobol_lanes.h"
#include "math/vec.h"

namespace photon_splat {

inline constexpr float kGoldenAngle = 2.39996323f;
inline constexpr float kBelowOne = 0x1.fffffep-1f;  // the largest number of [0, 1)

struct Vec2 {
  float x = 0, y = 0;
};

inline uint32_t hash32(
    uint32_t x) {  // an integer finalizer with low bias (Wellons, "Prospecting for hash functions")
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}
inline uint32_t hash_combine(uint32_t a, uint32_t b) {
  return hash32(a ^ (b + 0x9e3779b9u + (a << 6) + (a >> 2)));
}
inline uint32_t hash_of(const Vec3& x) {
  return hash_combine(std::bit_cast<uint32_t>(x.x),
                      hash_combine(std::bit_cast<uint32_t>(x.y), std::bit_cast<uint32_t>(x.z)));
}
inline uint64_t hash64(uint64_t x) {  // SplitMix64 finalizer (Steele et al. 2014)
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}
// [0, 1)
inline float to_unit_float(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

// Independent uniform numbers, a PCG-XSH-RR stream per path (O'Neill 2014).
class Random {
 public:
  Random(uint64_t index, uint32_t seed)
      : state_(hash64(index * 0x9e3779b97f4a7c15ull + hash64(seed + 1ull))) {}
  float next() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005ull + 1442695040888963407ull;
    const uint32_t shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
    const uint32_t rotate = static_cast<uint32_t>(old >> 59);
    return to_unit_float((shifted >> rotate) | (shifted << ((32 - rotate) & 31)));
  }
  Vec2 next2() {
    const float a = next();
    return {a, next()};
  }
  uint64_t state() const { return state_; }
  static Random at(uint64_t state) {
    Random random(0, 0);
    random.state_ = state;
    return random;
  }

 private:
  uint64_t state_;
};

// The second Sobol' dimension with its bits reversed. Its generator matrix is Pascal's triangle
// modulo 2, a Kronecker power of that of two rows, so that five steps do. Reversed, a point can be
// scrambled without turning its bits round first.
inline uint32_t second_dimension_reversed(uint32_t i) {
  i ^= i >> 1 & 0x55555555u;
  i ^= i >> 2 & 0x33333333u;
  i ^= i >> 4 & 0x0f0f0f0fu;
  i ^= i >> 8 & 0x00ff00ffu;
  return i ^ i >> 16;
}

inline uint32_t reverse_bits(uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

// Nested uniform scrambling of a number whose bits are already reversed (Laine & Karras 2011,
// constants of Vegdahl 2021).
inline uint32_t owen_scramble_reversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// See choose_variant().
SobolKernel choose_sobol_kernel(const std::string& name = {});

// Owen-scrambled Sobol' points, padded from 2D pairs (Burley 2020, "Practical hash-based Owen
// scrambling"). `dimension` picks a pair decorrelated from all others.
class SobolPair {
 public:
  SobolPair(uint32_t dimension, uint32_t seed)
      : key_(hash_combine(seed, dimension)),
        x_key_(hash32(key_ ^ 0x68bc21ebu)),
        y_key_(hash32(key_ ^ 0x02e5be93u)) {}

  Vec2 at(uint32_t index) const {
    // The shuffled index; its first Sobol' dimension is its bits reversed, so that the index itself
    // is that dimension reversed.
    const uint32_t i = reverse_bits(owen_scramble_reversed(reverse_bits(index), key_));
    return {
        to_unit_float(reverse_bits(owen_scramble_reversed(i, x_key_))),
        to_unit_float(reverse_bits(owen_scramble_reversed(second_dimension_reversed(i), y_key_)))};
  }
  // Points of `count` <= kMost indices in a row, in whole vectors of lanes: what lies beyond
  // `count` is overwritten.
  static constexpr uint32_t kMost = 64;
  struct alignas(64) Run {
    float x[kMost], y[kMost];
    Vec2 operator[](uint32_t k) const { return {x[k], y[k]}; }
  };
  void fill(uint32_t first, uint32_t count, Run& out) const;

 private:
  uint32_t key_, x_key_, y_key_;
};
// `index` counts samples of one sequence.
inline Vec2 sobol_2d(uint32_t index, uint32_t dimension, uint32_t seed) {
  return SobolPair(dimension, seed).at(index);
}

// Cosine and sine of an angle within [-pi/4, pi/4], exact to the last bit or one beside it: Taylor
// series. The library's functions take many times as long.
inline Vec2 cos_sin_of_octant(float t) {
  const float t2 = t * t;
  return {
      1 + t2 * (-1 / 2.0f + t2 * (1 / 24.0f + t2 * (-1 / 720.0f + t2 * (1 / 40320.0f)))),
      t * (1 + t2 * (-1 / 6.0f + t2 * (1 / 120.0f + t2 * (-1 / 5040.0f + t2 * (1 / 362880.0f)))))};
}
// `yes` ? a : b where that is hard to foresee: no branch.
inline float select(bool yes, float a, float b) {
  const uint32_t mask = 0u - static_cast<uint32_t>(yes);
  return std::bit_cast<float>((std::bit_cast<uint32_t>(a) & mask) |
                              (std::bit_cast<uint32_t>(b) & ~mask));
}
// Cosine and sine of a share in [0, 1] of a full turn.
inline Vec2 cos_sin_of_turn(float turn) {
  const int quarter = static_cast<int>(4 * turn + 0.5f);
  const Vec2 v = cos_sin_of_octant(2 * kPi * (turn - 0.25f * static_cast<float>(quarter)));
  const float sign = static_cast<float>(1 - (quarter & 2));
  return {sign * select(quarter & 1, -v.y, v.x), sign * select(quarter & 1, v.x, v.y)};
}

// The angle of (x, y) as a share of a full turn, in [-0.5, 0.5]: atan2 to within 6e-8 of a turn.
// The library's takes several times as long.
inline float turn_of(float y, float x) {
  // Start and sign of the octants, half of them mirrored
  static constexpr float kFrom[] = {0, 0.25f, 0.5f, 0.25f}, kSign[] = {1, -1, -1, 1};
  const float ax = std::abs(x), ay = std::abs(y);
  const int octant = static_cast<int>(std::bit_cast<uint32_t>(ay) > std::bit_cast<uint32_t>(ax)) +
                     (std::bit_cast<uint32_t>(x) >> 31 << 1);
  const float t = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-37f), z = t * t, z2 = z * z;
  const float low = (0.159154832f - 0.0530461222f * z) + z2 * (0.0317459442f - 0.0221362691f * z);
  const float high =
      (0.0153460279f - 0.00889871456f * z) + z2 * (0.0034795918f - 0.00064530276f * z);
  return std::copysign(kFrom[octant] + kSign[octant] * (t * (low + z2 * z2 * high)), y);
}

inline Vec2 sample_disk(const Vec2& u) {  // concentric map, uniform in area (Shirley & Chiu 1997)
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  const bool wide = std::abs(a) > std::abs(b);
  const float r = select(wide, a, b);
  const Vec2 v = cos_sin_of_octant(kPi / 4 * (select(wide, b, a) / select(r == 0, 1, r)));
  return {r * select(wide, v.x, v.y), r * select(wide, v.y, v.x)};
}
inline Vec3 sample_cosine_hemisphere(const Vec2& u) {  // pdf cos(theta)/pi
  const Vec2 d = sample_disk(u);
  return {d.x, d.y, std::sqrt(std::max(0.0f, 1 - d.x * d.x - d.y * d.y))};
}
inline Vec3 sample_sphere(const Vec2& u) {  // pdf 1/(4 pi)
  const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z));
  const Vec2 around = cos_sin_of_turn(u.y);
  return {r * around.x, r * around.y, z};
}
// Uniform in the cone around +Z with 1 - cos(half angle) given (exact for tiny cones); pdf 1/(2 pi
// (1 - cos)).
inline Vec3 sample_cone(const Vec2& u, float one_minus_cos) {
  const Vec2 d = sample_disk(u);
  const float r2 = d.x * d.x + d.y * d.y, z_drop = r2 * one_minus_cos;
  const float scale = std::sqrt(one_minus_cos * (2 - z_drop));
  return {d.x * scale, d.y * scale, 1 - z_drop};
}

struct Cone {
  Vec3 axis{0, 0, 1};
  float one_minus_cos = 0;  // of its half angle

  float solid_angle() const { return 2 * kPi * one_minus_cos; }
  float pdf(const Vec3& way) const {
    return length2(way - axis) <= 2 * one_minus_cos ? 1 / solid_angle() : 0;
  }
  Vec3 sample(const Vec2& u) const { return Basis(axis).to_world(sample_cone(u, one_minus_cos)); }
};

}  // namespace photon_splat
