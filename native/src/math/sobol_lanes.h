// Runs of Owen-scrambled Sobol' points (SobolPair) in vectors: included by files that are compiled
// for several instruction sets. Nothing here may define a function: the linker would keep one copy
// for all machines.
#pragma once

#include <cstdint>

namespace photon_splat {

inline constexpr uint32_t kSobolLanes = 16;

struct SobolKeys {
  uint32_t shuffle, x, y;
};

// Points first, first + 1, ... of a pair of dimensions, as many as fill `count` rounded up to
// kSobolLanes. All give the same numbers.
using SobolKernel = void (*)(const SobolKeys& keys, uint32_t first, uint32_t count, float* x,
                             float* y);

void sobol_generic(const SobolKeys& keys, uint32_t first, uint32_t count, float* x, float* y);
void sobol_sse42(const SobolKeys& keys, uint32_t first, uint32_t count, float* x, float* y);
void sobol_avx2(const SobolKeys& keys, uint32_t first, uint32_t count, float* x, float* y);
void sobol_avx512(const SobolKeys& keys, uint32_t first, uint32_t count, float* x, float* y);

}  // namespace photon_splat
