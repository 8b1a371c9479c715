// What splatting kernels see: plain data, included by files that are compiled for several instruction sets.
// Nothing here may define a function: the linker would keep one copy for all machines.
#pragma once

#include <cstdint>

namespace photon_splat {

inline constexpr uint32_t kBlockSize = 64;

// Up to 64 spatially compact points, structure of arrays. Unused places have inverse_h2 = infinity and catch nothing.
struct alignas(64) PointBlock {
  float x[kBlockSize], y[kBlockSize], z[kBlockSize];
  float nx[kBlockSize], ny[kBlockSize], nz[kBlockSize];
  uint32_t key[kBlockSize];
  float inverse_h2[kBlockSize];  // 1/h^2
  float r[kBlockSize], g[kBlockSize], b[kBlockSize];  // sum of power * w(n_x . n_y) * (1 - d^2/h^2)
  float count[kBlockSize];       // photons caught
  float narrow[kBlockSize];      // sum of luminance * w(n_x . n_y) * (1 - 2 d^2/h^2) within the disc of radius h/sqrt(2)
  // Kernels read no further.
  float scale[kBlockSize];         // 2/(pi h^2 M): turns the sums into irradiance, W/m^2
  float narrow_scale[kBlockSize];  // 4/(pi h^2 M'): the same for `narrow`, M' of its disc
};

// The weight of a photon whose surface normal differs from the point's: w = clamp(2 n_x.n_y, 0, 1), 1 up to 60 degrees.
// The kernel mass M(x) takes the same weight.
inline constexpr float kNormalWeightSlope = 2;

// A photon as a kernel reads it: position, key, surface normal, power and its luminance.
struct SplatPhoton {
  float x, y, z;
  uint32_t key;
  float nx, ny, nz;
  float r, g, b, luminance;
};

// Where the discs of each 16 points of a block reach, which are neighbours: photons elsewhere need no look at them.
inline constexpr uint32_t kPartSize = 16, kParts = kBlockSize / kPartSize;
struct PartBounds {
  float lower_x[kParts], lower_y[kParts], lower_z[kParts], upper_x[kParts], upper_y[kParts], upper_z[kParts];
};

// Photons one after another, and their places once more, axis by axis, with room for so many more: kernels read whole vectors.
inline constexpr uint32_t kSplatRoom = 8;
struct SplatPhotons {
  const SplatPhoton* photons;
  const float *x, *y, *z;
};
struct SplatRun {
  uint32_t begin, end;  // of photons
};

// Adds the photons of all runs, in their order, to the sums of a block.
using SplatKernel = void (*)(PointBlock& block, const PartBounds& parts, const SplatPhotons& photons, const SplatRun* runs, uint32_t count);

void splat_block_generic(PointBlock& block, const PartBounds& parts, const SplatPhotons& photons, const SplatRun* runs, uint32_t count);
void splat_block_sse42(PointBlock& block, const PartBounds& parts, const SplatPhotons& photons, const SplatRun* runs, uint32_t count);
void splat_block_avx2(PointBlock& block, const PartBounds& parts, const SplatPhotons& photons, const SplatRun* runs, uint32_t count);
void splat_block_avx512(PointBlock& block, const PartBounds& parts, const SplatPhotons& photons, const SplatRun* runs, uint32_t count);

}  // namespace photon_splat
