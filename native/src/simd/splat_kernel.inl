// The splatting loop, written once over vectors of kLanes floats (GCC and Clang vector extensions). Included with
// PHOTON_SPLAT_LANES and PHOTON_SPLAT_KERNEL defined, in files compiled for one instruction set each.
#include "../point_block.h"

#include <immintrin.h>

namespace photon_splat {
namespace {

constexpr int kLanes = PHOTON_SPLAT_LANES;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef int32_t Ints __attribute__((vector_size(kLanes * sizeof(int32_t))));

__attribute__((always_inline)) inline Floats select(Ints mask, Floats value) {
  return reinterpret_cast<Floats>(mask & reinterpret_cast<Ints>(value));
}

constexpr uint32_t kStretch = 128;  // photons whose places are compared with a part's at a time
constexpr uint32_t kFound = 256;    // so many within its bounds are added, with what comes of one more stretch

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

// Bit k: whether lane k is set; and the lanes that bytes tell.
#if PHOTON_SPLAT_LANES == 8
__attribute__((always_inline)) inline uint32_t mask_of(Ints set) { return static_cast<uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(set))); }
__attribute__((always_inline)) inline Ints spread(uint64_t bytes) {
  return reinterpret_cast<Ints>(_mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<int64_t>(bytes))));
}
#else
__attribute__((always_inline)) inline uint32_t mask_of(Ints set) { return static_cast<uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(set))); }
__attribute__((always_inline)) inline Ints spread(uint64_t bytes) {
  return reinterpret_cast<Ints>(_mm_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<int64_t>(bytes))));
}
#endif
#endif

// Numbers of the photons of [first, end) that lie within the bounds of part `part`, in their order; how many there are.
__attribute__((always_inline)) inline uint32_t find_within(const PartBounds& b, uint32_t part, const SplatPhotons& photons, uint32_t first,
                                                           uint32_t end, uint32_t* found) {
  uint32_t n = 0;
#if PHOTON_SPLAT_LANES == 16
  const __m512i count_up = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  for (uint32_t i = first; i < end; i += 16) {
    __mmask16 inside = end - i >= 16 ? 0xffff : static_cast<__mmask16>((1u << (end - i)) - 1);
    const auto within = [&](const float* place, float lower, float upper) __attribute__((always_inline)) {
      const __m512 p = _mm512_maskz_loadu_ps(inside, place + i);
      inside = _mm512_mask_cmp_ps_mask(inside, p, _mm512_set1_ps(lower), _CMP_GE_OQ);
      inside = _mm512_mask_cmp_ps_mask(inside, p, _mm512_set1_ps(upper), _CMP_LE_OQ);
    };
    within(photons.x, b.lower_x[part], b.upper_x[part]);
    within(photons.y, b.lower_y[part], b.upper_y[part]);
    within(photons.z, b.lower_z[part], b.upper_z[part]);
    // Sixteen are written, and overwritten: compressing into memory takes far longer on some machines.
    const __m512i numbers = _mm512_add_epi32(_mm512_set1_epi32(static_cast<int>(i)), count_up);
    _mm512_storeu_si512(found + n, _mm512_maskz_compress_epi32(inside, numbers));
    n += static_cast<uint32_t>(__builtin_popcount(inside));
  }
#else
  for (uint32_t i = first; i < end; i += kLanes) {
    const auto within = [i](const float* place, float lower, float upper) __attribute__((always_inline)) {
      Floats p;
      __builtin_memcpy(&p, place + i, sizeof p);
      return (p >= lower) & (p <= upper);
    };
    const Ints inside = within(photons.x, b.lower_x[part], b.upper_x[part]) & within(photons.y, b.lower_y[part], b.upper_y[part]) &
                        within(photons.z, b.lower_z[part], b.upper_z[part]);
    const uint32_t valid = end - i >= kLanes ? (1u << kLanes) - 1 : (1u << (end - i)) - 1;
    const uint32_t mask = mask_of(inside) & valid;
    const Ints numbers = spread(kLanesOfMask.lanes[mask]) + static_cast<int32_t>(i);
    __builtin_memcpy(found + n, &numbers, sizeof numbers);
    n += static_cast<uint32_t>(__builtin_popcount(mask));
  }
#endif
  return n;
}

// Adds photons to the points of a part.
__attribute__((always_inline)) inline void add(PointBlock& block, uint32_t part, const SplatPhoton* photons, const uint32_t* found, uint32_t count) {
  for (uint32_t lane = part * kPartSize; lane < (part + 1) * kPartSize; lane += kLanes) {
    const auto at = [lane](float* p) __attribute__((always_inline)) { return reinterpret_cast<Floats*>(p + lane); };
    const Floats x = *at(block.x), y = *at(block.y), z = *at(block.z);
    const Floats nx = *at(block.nx), ny = *at(block.ny), nz = *at(block.nz);
    const Floats inverse_h2 = *at(block.inverse_h2);
    const Ints key = *reinterpret_cast<const Ints*>(block.key + lane);
    Floats r = *at(block.r), g = *at(block.g), b = *at(block.b), caught = *at(block.count), narrow = *at(block.narrow);
    for (uint32_t i = 0; i < count; ++i) {
      const SplatPhoton& p = photons[found[i]];
      const Floats dx = p.x - x, dy = p.y - y, dz = p.z - z;
      const Floats relative = (dx * dx + dy * dy + dz * dz) * inverse_h2, kernel = 1.0f - relative, within = kernel - relative;
      const Floats facing = kNormalWeightSlope * (nx * p.nx + ny * p.ny + nz * p.nz);
      const Ints inside = (kernel > 0.0f) & (facing > 0.0f) & (key == static_cast<int32_t>(p.key));
      const Floats full = Floats{} + 1.0f;
      const Ints partly = facing < full;
      const Floats shared = select(partly, facing) + select(~partly, full);
      const Floats weight = select(inside, kernel) * shared;
      narrow += select(inside & (within > 0.0f), within) * shared * p.luminance;
      r += weight * p.r;
      g += weight * p.g;
      b += weight * p.b;
      caught += select(inside, full);
    }
    *at(block.r) = r;
    *at(block.g) = g;
    *at(block.b) = b;
    *at(block.count) = caught;
    *at(block.narrow) = narrow;
  }
}

}  // namespace

void PHOTON_SPLAT_KERNEL(PointBlock& block, const PartBounds& parts, const SplatPhotons& photons, const SplatRun* runs, uint32_t count) {
  uint32_t found[kFound + kStretch + 16];
  for (uint32_t part = 0; part < kParts; ++part) {
    uint32_t n = 0;
    for (const SplatRun* run = runs; run != runs + count; ++run)
      for (uint32_t first = run->begin; first < run->end; first += kStretch) {
        n += find_within(parts, part, photons, first, run->end - first < kStretch ? run->end : first + kStretch, found + n);
        if (n < kFound) continue;
        add(block, part, photons.photons, found, n);
        n = 0;
      }
    if (n) add(block, part, photons.photons, found, n);
  }
}

}  // namespace photon_splat
