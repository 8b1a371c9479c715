#include "geometry/areas.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>

namespace photon_splat {
namespace {

constexpr size_t kPart = 1 << 16;

}  // namespace

bool all_have_area(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  std::atomic<bool> sound{true}, outside{false};
  const auto look = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Triangle& t = triangles[i];
      if (std::max({t[0], t[1], t[2]}) >= positions.size()) {
        outside = true;
        return;
      }
      const Vec3 a = positions[t[0]], n = cross(positions[t[1]] - a, positions[t[2]] - a);
      if (!(is_finite(n) && (n.x != 0 || n.y != 0 || n.z != 0))) sound = false;
    }
  };
  for_parts_by_all(triangles.size(), kPart, look);
  if (outside) throw std::invalid_argument("a triangle names a vertex that does not exist");
  return sound;
}

}  // namespace photon_splat
