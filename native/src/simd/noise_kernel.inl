// Perlin's improved noise (2002) with the gradients of Gustavson's variants for other dimensions and lookup3 as the hash, as in
// Open Shading Language and Cycles. Written once for vectors of kLanes (GCC and Clang vector extensions) or for plain numbers (1).
// A lane is a corner of a point's cell: the lowest dimensions' corners lie in lanes, the others' in more vectors; where corners leave
// lanes free, several points share a vector. Included with PHOTON_SPLAT_LANES and PHOTON_SPLAT_KERNEL defined, in files compiled for
// one instruction set each and without contraction of products and sums, so that all give the same numbers.
#include <cstring>
#include <utility>

#include "../nodes/lookup3.h"
#include "../nodes/noise_kernel.h"

namespace photon_splat::nodes {
namespace {

constexpr int kLanes = PHOTON_SPLAT_LANES;
#if PHOTON_SPLAT_LANES == 1
using Words = uint32_t;
using Signed = int32_t;
using Floats = float;
template <class To, class From>
inline To converted(From x) { return static_cast<To>(x); }
inline float lane(float x, int) { return x; }
#else
typedef uint32_t Words __attribute__((vector_size(4 * kLanes)));
typedef int32_t Signed __attribute__((vector_size(4 * kLanes)));
typedef float Floats __attribute__((vector_size(4 * kLanes)));
template <class To, class From>
inline To converted(const From& x) { return __builtin_convertvector(x, To); }
inline float lane(const Floats& x, int i) { return x[i]; }

template <class Index, int... I>
inline Floats shuffled(const Floats& x, Index index, std::integer_sequence<int, I...>) {
#if defined(__clang__)
  return __builtin_shufflevector(x, x, index(I)...);
#else
  return __builtin_shuffle(x, Signed{index(I)...});
#endif
}
#endif

struct Lanes {
  alignas(4 * kLanes) uint32_t v[kLanes];
};
constexpr Lanes numbers_of_lanes() {
  Lanes lanes{};
  for (uint32_t i = 0; i < kLanes; ++i) lanes.v[i] = i;
  return lanes;
}
// All bits where bit `bit` of the lane's number is set.
constexpr Lanes lanes_with(int bit) {
  Lanes lanes{};
  for (int i = 0; i < kLanes; ++i) lanes.v[i] = i >> bit & 1 ? ~0u : 0u;
  return lanes;
}

template <class To, class From>
inline To bits_of(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}

inline Floats negated(const Floats& x, const Words& bit) {  // -x where bit (0 or 1) is set
  return bits_of<Floats>(bits_of<Words>(x) ^ bit << 31);
}

// Gradients of hashes h times the offsets f, in N dimensions.
template <int N>
inline Floats gradient(Words h, const Floats* f) {
  if constexpr (N == 1) return negated(converted<Floats>((h & 7u) + 1u), h >> 3 & 1u) * f[0];
  if constexpr (N == 2) {
    h = h & 7u;
    const Floats u = h < 4u ? f[0] : f[1], v = h < 4u ? f[1] : f[0];
    return negated(u, h & 1u) + negated(v * 2.0f, h >> 1 & 1u);
  }
  if constexpr (N == 3) {
    h = h & 15u;
    const Floats u = h < 8u ? f[0] : f[1], other = (h & 13u) == 12u ? f[0] : f[2], v = h < 4u ? f[1] : other;
    return negated(u, h & 1u) + negated(v, h >> 1 & 1u);
  }
  if constexpr (N == 4) {
    h = h & 31u;
    const Floats u = h < 24u ? f[0] : f[1], v = h < 16u ? f[1] : f[2], s = h < 8u ? f[2] : f[3];
    return negated(u, h & 1u) + negated(v, h >> 1 & 1u) + negated(s, h >> 2 & 1u);
  }
}

template <int N>
inline Words hash_of(const Words* c) {
  if constexpr (N == 1) return lookup3(c[0]);
  if constexpr (N == 2) return lookup3(c[0], c[1]);
  if constexpr (N == 3) return lookup3(c[0], c[1], c[2]);
  if constexpr (N == 4) return lookup3(c[0], c[1], c[2], c[3]);
}

constexpr float kScale[5] = {0, 0.2500f, 0.6616f, 0.9820f, 0.8344f};  // to [-1, 1] or so
constexpr int kLaneBits = kLanes == 1 ? 0 : kLanes == 4 ? 2 : kLanes == 8 ? 3 : 4;

template <int N>
inline void noise_in(const NoisePoints& points, uint32_t count, float* values) {
  constexpr int kInLanes = N < kLaneBits ? N : kLaneBits;  // dimensions whose corners are lanes
  constexpr int kCorners = 1 << kInLanes, kVectors = 1 << (N - kInLanes), kPoints = kLanes / kCorners;
  static constexpr Lanes kNumbers = numbers_of_lanes(), kBeyond[4] = {lanes_with(0), lanes_with(1), lanes_with(2), lanes_with(3)};
  static_assert(kPoints <= static_cast<int>(NoisePoints::kPadding));
  for (uint32_t first = 0; first < count; first += kPoints) {
    Words cell[N];
    Floats fraction[N], far[N];  // far: weight of the corners beyond
    for (int d = 0; d < N; ++d) {
      Floats x = Floats{} + points.c[d][first];
      for (int k = 1; k < kPoints; ++k)  // one by one: what has just been written one by one is slow to read as a vector
        x = bits_of<Words>(kNumbers) >> kInLanes == static_cast<uint32_t>(k) ? Floats{} + points.c[d][first + static_cast<uint32_t>(k)] : x;
      const Floats near_whole = converted<Floats>(converted<Signed>(x));
      const Floats whole = near_whole > x ? near_whole - 1.0f : near_whole;
      const Floats t = x - whole;
      cell[d] = bits_of<Words>(converted<Signed>(whole));
      fraction[d] = t;
      far[d] = t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
    }
    Floats sum[kVectors];
    for (int k = 0; k < kVectors; ++k) {
      Words corner[N];
      Floats offset[N], weight = Floats{} + kScale[N];
      for (int d = 0; d < N; ++d) {
        if (d < kInLanes) {
          const Words beyond = bits_of<Words>(kBeyond[d]);
          corner[d] = cell[d] - beyond;
          offset[d] = fraction[d] + converted<Floats>(bits_of<Signed>(beyond));
          weight = weight * (beyond != 0u ? far[d] : 1.0f - far[d]);
        } else {
          const bool beyond = k >> (d - kInLanes) & 1;
          corner[d] = cell[d] + (beyond ? 1u : 0u);
          offset[d] = fraction[d] - (beyond ? 1.0f : 0.0f);
          weight = weight * (beyond ? far[d] : 1.0f - far[d]);
        }
      }
      sum[k] = gradient<N>(hash_of<N>(corner), offset) * weight;
    }
    for (int half = kVectors / 2; half > 0; half /= 2)
      for (int k = 0; k < half; ++k) sum[k] = sum[k] + sum[k + half];
    Floats all = sum[0];
#if PHOTON_SPLAT_LANES > 1
    constexpr auto kEvery = std::make_integer_sequence<int, kLanes>();
    if constexpr (kInLanes > 3) all = all + shuffled(all, [](int i) { return i ^ 8; }, kEvery);
    if constexpr (kInLanes > 2) all = all + shuffled(all, [](int i) { return i ^ 4; }, kEvery);
    if constexpr (kInLanes > 1) all = all + shuffled(all, [](int i) { return i ^ 2; }, kEvery);
    if constexpr (kInLanes > 0) all = all + shuffled(all, [](int i) { return i ^ 1; }, kEvery);
#endif
    for (int k = 0; k < kPoints; ++k) values[first + static_cast<uint32_t>(k)] = lane(all, k * kCorners);
  }
}

}  // namespace

void PHOTON_SPLAT_KERNEL(int dimensions, const NoisePoints& points, uint32_t count, float* values) {
  switch (dimensions) {
#if PHOTON_SPLAT_LANES == 1
    case 1: return noise_in<1>(points, count, values);
#else
    case 1: return noise_generic(dimensions, points, count, values);  // two corners a point are not worth a vector
#endif
    case 2: return noise_in<2>(points, count, values);
    case 3: return noise_in<3>(points, count, values);
    default: return noise_in<4>(points, count, values);
  }
}

}  // namespace photon_splat::nodes
