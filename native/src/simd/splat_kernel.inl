// The splatting loop, written once over vectors of kLanes floats (GCC and Clang vector extensions).
// Included with PHOTON_SPLAT_LANES and PHOTON_SPLAT_KERNEL defined, in files compiled for one
// instruction set each.
#include "density/point_block.h"

#include <immintrin.h>

#include <cstddef>

namespace photon_splat {
namespace {

constexpr int kLanes = PHOTON_SPLAT_LANES;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef int32_t Ints __attribute__((vector_size(kLanes * sizeof(int32_t))));

__attribute__((always_inline)) inline Floats select(Ints mask, Floats value) {
  return reinterpret_cast<Floats>(mask & reinterpret_cast<Ints>(value));
}

// So many photons found are added, with what comes of one more group
constexpr uint32_t kFound = 256;

#if PHOTON_SPLAT_LANES < 16
// For each mask of lanes which they are, one byte each, the first in the lowest.
struct LanesOfMask {
  uint64_t lanes[1 << kLanes] = {};
  constexpr LanesOfMask() {
    for (uint32_t mask = 0; mask < 1u << kLanes; ++mask)
      for (uint32_t lane = 0, n = 0; lane < kLanes; ++lane)
        if (mask >> lane & 1) lanes[mask] |= uint64_t{lane} << 8 * n++;
  }
};
constexpr LanesOfMask kLanesOfMask;
#endif

// Truths: what comparing vectors gives, to be joined by &; mask_of: bit k tells whether that of
// lane k is one. write_numbers: first + k for each bit k of a mask, one after another, and more
// that is to be written over.
#if PHOTON_SPLAT_LANES == 16
typedef __mmask16 Truths;
__attribute__((always_inline)) inline Truths at_least(Floats a, Floats b) {
  return _mm512_cmp_ps_mask(a, b, _CMP_GE_OQ);
}
__attribute__((always_inline)) inline Truths equal(Ints a, Ints b) {
  return _mm512_cmpeq_epi32_mask(reinterpret_cast<__m512i>(a), reinterpret_cast<__m512i>(b));
}
__attribute__((always_inline)) inline Floats choose(Truths truths, Floats a, Floats b) {
  return _mm512_mask_blend_ps(truths, b, a);
}
__attribute__((always_inline)) inline uint32_t mask_of(Truths truths) { return truths; }
__attribute__((always_inline)) inline void write_numbers(uint32_t mask, uint32_t first,
                                                         uint32_t* out) {
  const __m512i count_up = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  const __m512i numbers = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(first)), count_up);
  // Compressing straight into memory takes far longer on some machines.
  _mm512_storeu_si512(out, _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), numbers));
}
#else
typedef Ints Truths;
__attribute__((always_inline)) inline Truths at_least(Floats a, Floats b) { return a >= b; }
__attribute__((always_inline)) inline Truths equal(Ints a, Ints b) { return a == b; }
__attribute__((always_inline)) inline Floats choose(Truths truths, Floats a, Floats b) {
  return select(truths, a) + select(~truths, b);
}
#if PHOTON_SPLAT_LANES == 8
__attribute__((always_inline)) inline uint32_t mask_of(Truths truths) {
  return static_cast<uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(truths)));
}
__attribute__((always_inline)) inline Ints spread(uint64_t bytes) {
  return reinterpret_cast<Ints>(
      _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<int64_t>(bytes))));
}
#else
__attribute__((always_inline)) inline uint32_t mask_of(Truths truths) {
  return static_cast<uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(truths)));
}
__attribute__((always_inline)) inline Ints spread(uint64_t bytes) {
  return reinterpret_cast<Ints>(_mm_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<int64_t>(bytes))));
}
#endif
__attribute__((always_inline)) inline void write_numbers(uint32_t mask, uint32_t first,
                                                         uint32_t* out) {
  const Ints numbers = spread(kLanesOfMask.lanes[mask]) + static_cast<int32_t>(first);
  __builtin_memcpy(out, &numbers, sizeof numbers);
}
#endif

// Where the numbers of a photon lie, in floats from its x.
#define PHOTON_SPLAT_PLACE(member) (offsetof(SplatGroup, member) / sizeof(float))
constexpr size_t kY = PHOTON_SPLAT_PLACE(y), kZ = PHOTON_SPLAT_PLACE(z),
                 kNx = PHOTON_SPLAT_PLACE(nx), kNy = PHOTON_SPLAT_PLACE(ny),
                 kNz = PHOTON_SPLAT_PLACE(nz), kR = PHOTON_SPLAT_PLACE(r),
                 kG = PHOTON_SPLAT_PLACE(g), kB = PHOTON_SPLAT_PLACE(b),
                 kLuminance = PHOTON_SPLAT_PLACE(luminance);
#undef PHOTON_SPLAT_PLACE
constexpr uint32_t kGroupFloats = sizeof(SplatGroup) / sizeof(float);

// What of a group a part may catch.
struct Found {
  uint32_t count;
  bool full_weight;  // their normals have the full weight at all points of the part
};

// Writes which photons of a group lie within the bounds of a part, and on its surface, in their
// order: places of their x, in floats from that of the first group.
__attribute__((always_inline)) inline Found find_within(const SplatPart& part,
                                                        const SplatGroup* groups, uint32_t number,
                                                        uint32_t* found) {
  const SplatGroup& group = groups[number];
  uint32_t n = 0, partly = 0;
  for (uint32_t i = 0; i < kGroupSize; i += kLanes) {
    const auto at = [i](const float* numbers) __attribute__((always_inline)) {
      return *reinterpret_cast<const Floats*>(numbers + i);
    };
    const auto within = [](Floats p, float lower, float upper) __attribute__((always_inline)) {
      return at_least(p, Floats{} + lower) & at_least(Floats{} + upper, p);
    };
    const Truths same = equal(*reinterpret_cast<const Ints*>(group.key + i),
                              Ints{} + static_cast<int32_t>(part.key));
    const uint32_t mask = mask_of(within(at(group.x), part.lower_x, part.upper_x) &
                                  within(at(group.y), part.lower_y, part.upper_y) &
                                  within(at(group.z), part.lower_z, part.upper_z) & same);
    const Floats cosine =
        at(group.nx) * part.axis_x + at(group.ny) * part.axis_y + at(group.nz) * part.axis_z;
    partly |= mask & ~mask_of(at_least(cosine, Floats{} + part.full_from));
    write_numbers(mask, number * kGroupFloats + i, found + n);
    n += static_cast<uint32_t>(__builtin_popcount(mask));
  }
  return {n, partly == 0};
}

// Adds photons to the points of a part; kFullWeight: whose normals need no look.
template <bool kFullWeight>
__attribute__((always_inline)) inline void add(PointBlock& block, const SplatPart& part,
                                               const SplatGroup* groups, const uint32_t* found,
                                               uint32_t count) {
  const Floats full = Floats{} + 1.0f;
  for (uint32_t lane = part.first; lane < part.first + kPartSize; lane += kLanes) {
    const auto at = [lane](float* p) __attribute__((always_inline)) {
      return reinterpret_cast<Floats*>(p + lane);
    };
    const Truths same = equal(*reinterpret_cast<const Ints*>(block.key + lane),
                              Ints{} + static_cast<int32_t>(part.key));
    if (!mask_of(same)) continue;
    const Floats x = *at(block.x), y = *at(block.y), z = *at(block.z);
    const Floats nx = *at(block.nx), ny = *at(block.ny), nz = *at(block.nz);
    // Others catch nothing
    const Floats inverse_h2 = choose(same, *at(block.inverse_h2), Floats{} + __builtin_inff());
    Floats r = *at(block.r), g = *at(block.g), b = *at(block.b), caught = *at(block.count),
           narrow = *at(block.narrow);
    for (uint32_t i = 0; i < count; ++i) {
      const float* const p = reinterpret_cast<const float*>(groups) + found[i];
      const Floats dx = *p - x, dy = p[kY] - y, dz = p[kZ] - z;
      const Floats relative = (dx * dx + dy * dy + dz * dz) * inverse_h2, kernel = 1.0f - relative,
                   within = kernel - relative;
      Ints inside = kernel > 0.0f;
      Floats weight = select(inside, kernel), narrow_weight = select(within > 0.0f, within);
      if constexpr (!kFullWeight) {
        const Floats facing = kNormalWeightSlope * (nx * p[kNx] + ny * p[kNy] + nz * p[kNz]);
        inside &= facing > 0.0f;
        const Ints partly = facing < full;
        const Floats shared = select(inside, select(partly, facing) + select(~partly, full));
        weight *= shared;
        narrow_weight *= shared;
      }
      narrow += narrow_weight * p[kLuminance];
      r += weight * p[kR];
      g += weight * p[kG];
      b += weight * p[kB];
      caught += select(inside, full);
    }
    *at(block.r) = r;
    *at(block.g) = g;
    *at(block.b) = b;
    *at(block.count) = caught;
    *at(block.narrow) = narrow;
  }
}

// Likewise the ways of the same photons to the sums of these.
template <bool kFullWeight>
__attribute__((always_inline)) inline void add_ways(PointBlock& block, const SplatPart& part,
                                                    const Splatted& photons, const uint32_t* found,
                                                    uint32_t count) {
  const Floats full = Floats{} + 1.0f;
  for (uint32_t lane = part.first; lane < part.first + kPartSize; lane += kLanes) {
    const auto at = [lane](float* p) __attribute__((always_inline)) {
      return reinterpret_cast<Floats*>(p + lane);
    };
    const Truths same = equal(*reinterpret_cast<const Ints*>(block.key + lane),
                              Ints{} + static_cast<int32_t>(part.key));
    if (!mask_of(same)) continue;
    const Floats x = *at(block.x), y = *at(block.y), z = *at(block.z);
    const Floats inverse_h2 = choose(same, *at(block.inverse_h2), Floats{} + __builtin_inff());
    WayBlock& to = *photons.way_sums;
    Floats rx = *at(to.r[0]), ry = *at(to.r[1]), rz = *at(to.r[2]);
    Floats gx = *at(to.g[0]), gy = *at(to.g[1]), gz = *at(to.g[2]);
    Floats bx = *at(to.b[0]), by = *at(to.b[1]), bz = *at(to.b[2]);
    for (uint32_t i = 0; i < count; ++i) {
      const float* const p = reinterpret_cast<const float*>(photons.groups) + found[i];
      const Floats dx = *p - x, dy = p[kY] - y, dz = p[kZ] - z;
      const Floats kernel = 1.0f - (dx * dx + dy * dy + dz * dz) * inverse_h2;
      Floats weight = select(kernel > 0.0f, kernel);
      if constexpr (!kFullWeight) {
        const Floats facing =
            kNormalWeightSlope *
            (*at(block.nx) * p[kNx] + *at(block.ny) * p[kNy] + *at(block.nz) * p[kNz]);
        const Ints partly = facing < full;
        weight *= select(facing > 0.0f, select(partly, facing) + select(~partly, full));
      }
      const uint32_t number = found[i] / kGroupFloats;
      const float* const way = photons.ways[number].x + found[i] % kGroupFloats;
      const float r = p[kR], g = p[kG], b = p[kB];
      const Floats wx = weight * *way, wy = weight * way[kGroupSize],
                   wz = weight * way[2 * kGroupSize];
      rx += wx * r, ry += wy * r, rz += wz * r;
      gx += wx * g, gy += wy * g, gz += wz * g;
      bx += wx * b, by += wy * b, bz += wz * b;
    }
    *at(to.r[0]) = rx, *at(to.r[1]) = ry, *at(to.r[2]) = rz;
    *at(to.g[0]) = gx, *at(to.g[1]) = gy, *at(to.g[2]) = gz;
    *at(to.b[0]) = bx, *at(to.b[1]) = by, *at(to.b[2]) = bz;
  }
}

template <bool kFullWeight>
__attribute__((always_inline)) inline void add_all(PointBlock& block, const SplatPart& part,
                                                   const Splatted& photons, const uint32_t* found,
                                                   uint32_t count) {
  add<kFullWeight>(block, part, photons.groups, found, count);
  if (photons.way_sums) add_ways<kFullWeight>(block, part, photons, found, count);
}

}  // namespace

void PHOTON_SPLAT_KERNEL(PointBlock& block, const SplatPart& part, const Splatted& photons,
                         const uint32_t* numbers, uint32_t count) {
  uint32_t found[kFound + kGroupSize + kLanes], n = 0;
  bool full_weight = true;
  for (uint32_t k = 0; k < count; ++k) {
    const Found more = find_within(part, photons.groups, numbers[k], found + n);
    n += more.count;
    full_weight &= more.full_weight;
    if (n < kFound && (k + 1 < count || n == 0)) continue;
    if (full_weight)
      add_all<true>(block, part, photons, found, n);
    else
      add_all<false>(block, part, photons, found, n);
    n = 0;
    full_weight = true;
  }
}

}  // namespace photon_splat
