// Directions of diffuse bounces, drawn for several paths at once: written so that the compiler makes vectors of the lanes.
#pragma once

#include "sampling.h"

namespace photon_splat {

// Fills places of an array of directions with cosine-weighted ones: each some time after it was asked for, all by finish().
class DiffuseBounces {
 public:
  explicit DiffuseBounces(std::vector<Vec3>& directions) : directions_(directions) {}

  void add(uint32_t place, const Vec3& normal, const Vec2& u) {
    if (count_ == kLanes) finish();
    x_[count_] = normal.x, y_[count_] = normal.y, z_[count_] = normal.z;
    u_[count_] = u.x, v_[count_] = u.y;
    places_[count_++] = place;
  }

  void finish() {
    for (uint32_t k = 0; k < kLanes; ++k) {
      const Vec3 way = Basis({x_[k], y_[k], z_[k]}).to_world(sample_cosine_hemisphere({u_[k], v_[k]}));
      x_[k] = way.x, y_[k] = way.y, z_[k] = way.z;
    }
    for (uint32_t k = 0; k < count_; ++k) directions_[places_[k]] = {x_[k], y_[k], z_[k]};
    count_ = 0;
  }

 private:
  static constexpr uint32_t kLanes = 8;

  std::vector<Vec3>& directions_;
  uint32_t count_ = 0;
  alignas(64) float x_[kLanes] = {}, y_[kLanes] = {}, z_[kLanes] = {};  // of normals; then directions
  alignas(64) float u_[kLanes] = {}, v_[kLanes] = {};
  uint32_t places_[kLanes] = {};
};

}  // namespace photon_splat
