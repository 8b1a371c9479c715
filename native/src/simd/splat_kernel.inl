// The splatting loop, written once over vectors of kLanes floats (GCC and Clang vector extensions). Included with
// PHOTON_SPLAT_LANES and PHOTON_SPLAT_KERNEL defined, in files compiled for one instruction set each.
#include "../point_block.h"

namespace photon_splat {
namespace {

constexpr int kLanes = PHOTON_SPLAT_LANES;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef int32_t Ints __attribute__((vector_size(kLanes * sizeof(int32_t))));

__attribute__((always_inline)) inline Floats select(Ints mask, Floats value) {
  return reinterpret_cast<Floats>(mask & reinterpret_cast<Ints>(value));
}

}  // namespace

void PHOTON_SPLAT_KERNEL(PointBlock& block, const SplatPhoton* photons, uint32_t count) {
  for (uint32_t lane = 0; lane < kBlockSize; lane += kLanes) {
    const auto at = [lane](float* p) __attribute__((always_inline)) { return reinterpret_cast<Floats*>(p + lane); };
    const Floats x = *at(block.x), y = *at(block.y), z = *at(block.z);
    const Floats nx = *at(block.nx), ny = *at(block.ny), nz = *at(block.nz);
    const Floats inverse_h2 = *at(block.inverse_h2);
    const Ints key = *reinterpret_cast<const Ints*>(block.key + lane);
    Floats r = *at(block.r), g = *at(block.g), b = *at(block.b), caught = *at(block.count), narrow = *at(block.narrow);
    for (uint32_t i = 0; i < count; ++i) {
      const SplatPhoton& p = photons[i];
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

}  // namespace photon_splat
