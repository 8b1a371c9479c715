// How far off a triangle rays are found to meet it, in single precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace photon_splat {

// Of a triangle with these edges, m. Where a ray meets its plane is computed from differences of
// corners: their rounding counts as far as they lie along the normal. A face that stands askew has
// an error in proportion to its size; one that an axis stands on has none.
inline float rounding_of(const Vec3& ab, const Vec3& ac) {
  // Of 200,000 rays that left triangles 60 and 2000 m wide none met them again with half of it, 59
  // with a quarter.
  constexpr float kRounding = 2.5e-7f;
  const Vec3 normal = cross(ab, ac);
  const float area = length(normal);
  if (!(area > 0)) return 0;
  const auto along = [&](float n, float b, float c) {
    return std::abs(n) * (std::max({b, c, 0.0f}) - std::min({b, c, 0.0f}));
  };
  const float sum =
      along(normal.x, ab.x, ac.x) + along(normal.y, ab.y, ac.y) + along(normal.z, ab.z, ac.z);
  const float found = kRounding * sum / area;
  return std::isfinite(found) ? found : 0;
}

}  // namespace photon_splat
