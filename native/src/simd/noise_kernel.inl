// Perlin's improved noise (2002) with the gradients of Gustavson's variants for other dimensions
// and lookup3 as the hash, as in Open Shading Language and Cycles. Written once for vectors of
// kLanes (GCC and Clang vector extensions) or for plain numbers (1). A lane is a point or, where
// there are fewer points than lanes, a corner of a point's cell: the lowest dimensions' corners lie
// in lanes, the others' in more vectors. Included with PHOTON_SPLAT_LANES and PHOTON_SPLAT_KERNEL
// defined, in files compiled for one instruction set each and without contraction of products and
// sums, so that all give the same numbers.
#include <cstring>
#include <utility>

#include "textures/lookup3.h"
#include "textures/noise_kernel.h"

namespace photon_splat::nodes {
namespace {

constexpr int kLanes = PHOTON_SPLAT_LANES;
#if PHOTON_SPLAT_LANES == 1
using Words = uint32_t;
using Signed = int32_t;
using Floats = float;
template <class To, class From>
inline To converted(From x) {
  return static_cast<To>(x);
}
inline float lane(float x, int) { return x; }
#else
typedef uint32_t Words __attribute__((vector_size(4 * kLanes)));
typedef int32_t Signed __attribute__((vector_size(4 * kLanes)));
typedef float Floats __attribute__((vector_size(4 * kLanes)));
template <class To, class From>
inline To converted(const From& x) {
  return __builtin_convertvector(x, To);
}
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

inline Floats negated(const Floats& x, const Words& h, int bit) {  // -x where this bit of h is set
  return bits_of<Floats>(bits_of<Words>(x) ^ (h << (31 - bit) & 0x80000000u));
}
// By this bit of h
inline Floats chosen(const Words& h, int bit, const Floats& set, const Floats& other) {
  return bits_of<Signed>(h << (31 - bit)) < 0 ? set : other;
}

// Gradients of hashes h, of which the lowest bits count, times the offsets f, in N dimensions.
template <int N>
inline Floats gradient(const Words& h, const Floats* f) {
  if constexpr (N == 1)
    return negated(converted<Floats>(bits_of<Signed>((h & 7u) + 1u)), h, 3) * f[0];
  if constexpr (N == 2)
    return negated(chosen(h, 2, f[1], f[0]), h, 0) + negated(chosen(h, 2, f[0], f[1]) * 2.0f, h, 1);
  if constexpr (N == 3) {
    const Floats other = (h & 13u) == 12u ? f[0] : f[2];
    return negated(chosen(h, 3, f[1], f[0]), h, 0) + negated((h & 12u) == 0u ? f[1] : other, h, 1);
  }
  if constexpr (N == 4) {
    const Floats u = (h & 24u) == 24u ? f[1] : f[0], v = chosen(h, 4, f[2], f[1]),
                 s = (h & 24u) == 0u ? f[2] : f[3];
    return negated(u, h, 0) + negated(v, h, 1) + negated(s, h, 2);
  }
}

template <int N>
inline Words hash_of(const Words* c) {
  if constexpr (N == 1) return lookup3<true>(c[0]);
  if constexpr (N == 2) return lookup3<true>(c[0], c[1]);
  if constexpr (N == 3) return lookup3<true>(c[0], c[1], c[2]);
  if constexpr (N == 4) return lookup3<true>(c[0], c[1], c[2], c[3]);
}

constexpr float kScale[5] = {0, 0.2500f, 0.6616f, 0.9820f, 0.8344f};  // to [-1, 1] or so
constexpr int kLaneBits = kLanes == 1 ? 0 : kLanes == 4 ? 2 : kLanes == 8 ? 3 : 4;

// Coordinates of kPoints points, each in as many lanes in a row as there are.
template <int kPoints>
inline Floats spread(const float* c) {
  Floats x;
  if constexpr (kPoints == kLanes) {
    std::memcpy(&x, c, sizeof x);
  } else {
    static constexpr Lanes kNumbers = numbers_of_lanes();
    x = Floats{} + c[0];
    // One by one: what has just been written one by one is slow to read as a vector
    for (uint32_t k = 1; k < kPoints; ++k)
      x = bits_of<Words>(kNumbers) / (kLanes / kPoints) == k ? Floats{} + c[k] : x;
  }
  return x;
}

// A cell's two sides along one dimension: coordinate, offset of the point and weight of the corners
// there.
struct Sides {
  Words cell[2];
  Floats offset[2], weight[2];
};

// Sum over the corners' sides from dimension D on, of those of the corners in `cell` and `offset`
// before it.
template <int N, int D>
#if PHOTON_SPLAT_LANES > 1
__attribute__((always_inline))
#endif
inline Floats sum_corners(const Sides (&sides)[N], Words (&cell)[N], Floats (&offset)[N],
                          const Floats& weight) {
  if constexpr (D == N) {
    return gradient<N>(hash_of<N>(cell), offset) * weight;
  } else {
    Floats sum[2];
    for (int side = 0; side < 2; ++side) {
      cell[D] = sides[D].cell[side];
      offset[D] = sides[D].offset[side];
      sum[side] = sum_corners<N, D + 1>(sides, cell, offset, weight * sides[D].weight[side]);
    }
    return sum[0] + sum[1];
  }
}

// Noise at kPoints points, whose corners' sides are lanes along as many dimensions as fit. The sum
// is over the highest dimension first whatever lies in lanes.
template <int N, int kPoints>
inline void noise_at(const NoisePoints& points, uint32_t first, float* values) {
  constexpr int kCorners = kLanes / kPoints, kInLanes = kCorners == 1   ? 0
                                                        : kCorners == 2 ? 1
                                                        : kCorners == 4 ? 2
                                                        : kCorners == 8 ? 3
                                                                        : 4;
  static constexpr Lanes kBeyond[4] = {lanes_with(0), lanes_with(1), lanes_with(2), lanes_with(3)};
  static_assert(kInLanes <= N && kPoints <= static_cast<int>(NoisePoints::kPadding));
  Words cell[N];
  Floats offset[N], weight = Floats{} + kScale[N];
  Sides sides[N];
  for (int d = 0; d < N; ++d) {
    const Floats x = spread<kPoints>(&points.c[d][first]);
    const Floats near_whole = converted<Floats>(converted<Signed>(x));
    const Floats whole = near_whole > x ? near_whole - 1.0f : near_whole;
    const Floats t = x - whole, far = t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
    cell[d] = bits_of<Words>(converted<Signed>(whole));
    if (d < kInLanes) {
      const Words beyond = bits_of<Words>(kBeyond[d]);
      cell[d] = cell[d] - beyond;
      offset[d] = t + converted<Floats>(bits_of<Signed>(beyond));
      weight = weight * (beyond != 0u ? far : 1.0f - far);
    } else {
      sides[d] = {{cell[d], cell[d] + 1u}, {t, t - 1.0f}, {1.0f - far, far}};
    }
  }
  Floats all = sum_corners<N, kInLanes>(sides, cell, offset, weight);
#if PHOTON_SPLAT_LANES > 1
  constexpr auto kEvery = std::make_integer_sequence<int, kLanes>();
  if constexpr (kInLanes > 3) all = all + shuffled(all, [](int i) { return i ^ 8; }, kEvery);
  if constexpr (kInLanes > 2) all = all + shuffled(all, [](int i) { return i ^ 4; }, kEvery);
  if constexpr (kInLanes > 1) all = all + shuffled(all, [](int i) { return i ^ 2; }, kEvery);
  if constexpr (kInLanes > 0) all = all + shuffled(all, [](int i) { return i ^ 1; }, kEvery);
#endif
  if constexpr (kPoints == kLanes)
    std::memcpy(values + first, &all, sizeof all);
  else
    for (int k = 0; k < kPoints; ++k)
      values[first + static_cast<uint32_t>(k)] = lane(all, k * kCorners);
}

// Of `left` points from `first` on as many as lanes allow, and no more lanes than it takes; the
// fewer points, the more corners are lanes.
template <int N, int kPoints = kLanes>
inline uint32_t noise_of_some(const NoisePoints& points, uint32_t first, uint32_t left,
                              float* values) {
  constexpr int kFewest = kLanes >> (N < kLaneBits ? N : kLaneBits);
  if constexpr (kPoints > kFewest)
    if (left <= kPoints / 2) return noise_of_some<N, kPoints / 2>(points, first, left, values);
  noise_at<N, kPoints>(points, first, values);
  return kPoints;
}

template <int N>
inline void noise_in(const NoisePoints& points, uint32_t count, float* values) {
  for (uint32_t i = 0; i < count;) i += noise_of_some<N>(points, i, count - i, values);
}

}  // namespace

void PHOTON_SPLAT_KERNEL(int dimensions, const NoisePoints& points, uint32_t count, float* values) {
  switch (dimensions) {
    case 1: return noise_in<1>(points, count, values);
    case 2: return noise_in<2>(points, count, values);
    case 3: return noise_in<3>(points, count, values);
    default: return noise_in<4>(points, count, values);
  }
}

}  // namespace photon_splat::nodes
