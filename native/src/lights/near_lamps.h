// Which of a few lamps a ray comes near, all of them looked at side by side: most rays meet none.
#pragma once

#include "math/vec.h"

namespace photon_splat {

class NearLamps {
 public:
  static constexpr size_t kMost = 32;

  // Numbered in this order, kMost at most. Squared radius: infinite where any ray may meet it,
  // below 0 where none does.
  void add(const Vec3& center, float radius2) {
    x_[count_] = center.x, y_[count_] = center.y, z_[count_] = center.z;
    radius2_[count_++] = radius2;
  }

  // Bit i: the line of the ray may meet lamp i.
  uint32_t met_by(const Vec3& origin, const Vec3& direction) const {
    float beyond[kMost];
    for (uint32_t i = 0; i < count_; ++i) {
      const float x = x_[i] - origin.x, y = y_[i] - origin.y, z = z_[i] - origin.z;
      const float along = x * direction.x + y * direction.y + z * direction.z;
      const float off_x = x - direction.x * along, off_y = y - direction.y * along,
                  off_z = z - direction.z * along;
      beyond[i] = (off_x * off_x + off_y * off_y + off_z * off_z) -
                  (radius2_[i] * kWider + kRounding * (x * x + y * y + z * z));
    }
    uint32_t met = 0;
    for (uint32_t i = 0; i < count_; ++i) met |= static_cast<uint32_t>(!(beyond[i] > 0)) << i;
    return met;
  }

 private:
  // Of squares, so that rounding hides no lamp
  static constexpr float kWider = 1.001f, kRounding = 1e-11f;

  alignas(16) float x_[kMost]{}, y_[kMost]{}, z_[kMost]{}, radius2_[kMost]{};
  uint32_t count_ = 0;
};

}  // namespace photon_splat
