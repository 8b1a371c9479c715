#include "density/clear_regions.h"

#include <cmath>

#include "math/sampling.h"

namespace photon_splat {

uint64_t ClearRegions::region(uint32_t key, const Vec3& x, float h) {
  const int level = std::ilogb(h);
  const float scale = std::ldexp(0.5f, -level);
  const auto index = [scale](float f) {
    return static_cast<uint64_t>(static_cast<int64_t>(std::floor(f * scale))) & 0x1fffff;
  };
  return hash64((uint64_t{key} << 16 ^ static_cast<uint64_t>(static_cast<uint32_t>(level))) *
                    0x9e3779b97f4a7c15ull ^
                hash64(index(x.x) | index(x.y) << 21 | index(x.z) << 42));
}

bool ClearRegions::to_look_at(uint64_t region, uint32_t chance) const {
  return chance % kStill == 0 || clear_.count(region) < kEnough || obstructed_.count(region) > 0;
}

void ClearRegions::learn(uint64_t region, bool clear) {
  if (obstructed_.count(region)) return;
  if (!clear)
    obstructed_.add(region);
  else if (clear_.count(region) < kEnough)
    clear_.add(region);
}

}  // namespace photon_splat
