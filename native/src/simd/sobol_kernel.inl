// Sobol' points, written once for vectors of kLanes (GCC and Clang vector extensions) or for plain
// numbers (1). Included with PHOTON_SPLAT_LANES and PHOTON_SPLAT_KERNEL defined, in files compiled
// for one instruction set each. The steps are those of sampling.h, where their sources are named.
#include <cstring>

#include "math/sobol_lanes.h"

namespace photon_splat {
namespace {

constexpr uint32_t kLanes = PHOTON_SPLAT_LANES;
#if PHOTON_SPLAT_LANES == 1
using Words = uint32_t;
using Signed = int32_t;
using Floats = float;
#else
typedef uint32_t Words __attribute__((vector_size(4 * kLanes)));
typedef int32_t Signed __attribute__((vector_size(4 * kLanes)));
typedef float Floats __attribute__((vector_size(4 * kLanes)));
#endif

inline Words reversed(Words x) {
  x = (x >> 16) | (x << 16);
  x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

inline Words scrambled(Words x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  return x ^ x * 0x53a22864u;
}

inline Words second_dimension(Words i) {
  i ^= i >> 1 & 0x55555555u;
  i ^= i >> 2 & 0x33333333u;
  i ^= i >> 4 & 0x0f0f0f0fu;
  i ^= i >> 8 & 0x00ff00ffu;
  return i ^ i >> 16;
}

inline void keep_unit(Words reversed_bits, float* to) {
  const Words bits = reversed(reversed_bits) >> 8;
#if PHOTON_SPLAT_LANES == 1
  const Floats numbers = static_cast<float>(bits) * 0x1p-24f;
#else
  const Floats numbers = __builtin_convertvector(reinterpret_cast<Signed>(bits), Floats) * 0x1p-24f;
#endif
  std::memcpy(to, &numbers, sizeof numbers);
}

}  // namespace

void PHOTON_SPLAT_KERNEL(const SobolKeys& keys, uint32_t first, uint32_t count, float* x,
                         float* y) {
  uint32_t numbers[kLanes];
  for (uint32_t k = 0; k < kLanes; ++k) numbers[k] = first + k;
  Words index;
  std::memcpy(&index, numbers, sizeof index);
  for (uint32_t k = 0; k < (count + kSobolLanes - 1) / kSobolLanes * kSobolLanes;
       k += kLanes, index += kLanes) {
    const Words i = reversed(scrambled(reversed(index), keys.shuffle));
    keep_unit(scrambled(i, keys.x), x + k);
    keep_unit(scrambled(second_dimension(i), keys.y), y + k);
  }
}

}  // namespace photon_splat
