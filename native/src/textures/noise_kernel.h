// Perlin noise at many points at once: what the kernels, one for each instruction set, are given.
// All give the same numbers bit for bit.
#pragma once

#include <cstdint>
#include <string>

namespace photon_splat::nodes {

// Up to three fractals of 16 octaves and a part of one more; whole vectors are read and written.
struct NoisePoints {
  static constexpr uint32_t kMost = 80, kPadding = 16;
  alignas(64) float c[4][kMost];
};

// values[i] = noise in about [-1, 1] at points (c[0][i], c[1][i], ...) of as many dimensions, |c| <
// 2^30, i < count. Reads kPadding - 1 points beyond count - 1 at most, which must be such numbers
// too, and writes as many values.
using NoiseKernel = void (*)(int dimensions, const NoisePoints& points, uint32_t count,
                             float* values);

void noise_generic(int dimensions, const NoisePoints& points, uint32_t count, float* values);
void noise_sse42(int dimensions, const NoisePoints& points, uint32_t count, float* values);
void noise_avx2(int dimensions, const NoisePoints& points, uint32_t count, float* values);
void noise_avx512(int dimensions, const NoisePoints& points, uint32_t count, float* values);

// See choose_variant().
NoiseKernel choose_noise_kernel(const std::string& name = {});

}  // namespace photon_splat::nodes
