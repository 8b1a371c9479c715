// What splatting kernels see: plain data, included by files that are compiled for several
// instruction sets. Nothing here may define a function: the linker would keep one copy for all
// machines.
#pragma once

#include <cstdint>

namespace photon_splat {

inline constexpr uint32_t kBlockSize = 64;

// Up to 64 spatially compact points, structure of arrays. Unused places have inverse_h2 = infinity
// and catch nothing.
struct alignas(64) PointBlock {
  float x[kBlockSize], y[kBlockSize], z[kBlockSize];
  float nx[kBlockSize], ny[kBlockSize], nz[kBlockSize];
  uint32_t key[kBlockSize];
  float inverse_h2[kBlockSize];                       // 1/h^2
  float r[kBlockSize], g[kBlockSize], b[kBlockSize];  // sum of power * w(n_x . n_y) * (1 - d^2/h^2)
  float count[kBlockSize];                            // photons caught
  // Sum of luminance * w(n_x . n_y) * (1 - 2 d^2/h^2) within the disc of radius h/sqrt(2)
  float narrow[kBlockSize];
  // Kernels read no further.
  float scale[kBlockSize];         // 2/(pi h^2 M): turns the sums into irradiance, W/m^2
  float narrow_scale[kBlockSize];  // 4/(pi h^2 M'): the same for `narrow`, M' of its disc
};

// The weight of a photon whose surface normal differs from the point's: w = clamp(2 n_x.n_y, 0, 1),
// 1 up to 60 degrees. The kernel mass M(x) takes the same weight.
inline constexpr float kNormalWeightSlope = 2;

// The points of one surface among 16 neighbours of a block, from `first` on. Where their discs
// reach, photons of their key are looked for; where the cosine of a photon's normal to `axis` is
// `full_from` or more, it has the full weight at all of them.
inline constexpr uint32_t kPartSize = 16;
struct SplatPart {
  float lower_x, lower_y, lower_z, upper_x, upper_y, upper_z;
  uint32_t key, first;
  float axis_x, axis_y, axis_z, full_from;
};

// 16 photons that follow each other: positions, surface normals, keys, powers and their luminance.
// Places beyond the last photon are not numbers and found nowhere.
inline constexpr uint32_t kGroupSize = 16;
struct alignas(64) SplatGroup {
  float x[kGroupSize], y[kGroupSize], z[kGroupSize], nx[kGroupSize], ny[kGroupSize], nz[kGroupSize];
  uint32_t key[kGroupSize];
  float r[kGroupSize], g[kGroupSize], b[kGroupSize], luminance[kGroupSize];
};

// Of the same photons: the ways they came by over the cosines (math/bumps.h).
struct alignas(64) WayGroup {
  float x[kGroupSize], y[kGroupSize], z[kGroupSize];
};

// Of the points of a block: sums of power * way over cosine * w(n_x . n_y) * (1 - d^2/h^2), x, y
// and z.
struct alignas(64) WayBlock {
  float r[3][kBlockSize], g[3][kBlockSize], b[3][kBlockSize];
};

// Photons, and where the block's points want them, their ways and the sums of these; else nullptr.
struct Splatted {
  const SplatGroup* groups;
  const WayGroup* ways;
  WayBlock* way_sums;
};

// Adds the photons of groups[numbers[0 .. count)], in this order, to the sums of a part of a block.
using SplatKernel = void (*)(PointBlock& block, const SplatPart& part, const Splatted& photons,
                             const uint32_t* numbers, uint32_t count);

void splat_part_generic(PointBlock& block, const SplatPart& part, const Splatted& photons,
                        const uint32_t* numbers, uint32_t count);
void splat_part_sse42(PointBlock& block, const SplatPart& part, const Splatted& photons,
                      const uint32_t* numbers, uint32_t count);
void splat_part_avx2(PointBlock& block, const SplatPart& part, const Splatted& photons,
                     const uint32_t* numbers, uint32_t count);
void splat_part_avx512(PointBlock& block, const SplatPart& part, const Splatted& photons,
                       const uint32_t* numbers, uint32_t count);

}  // namespace photon_splat
