// Where on its surfaces a view looks: a floor may be seen for a metre of its kilometres.
#pragma once

#include "density/clear_regions.h"
#include "density/surface_filter.h"

namespace photon_splat {

// Cells of surfaces, each a fourth to a half as wide as it is far from the middle of what is seen,
// or as half of that reaches.
class SeenPlaces {
 public:
  SeenPlaces(const Vec3& middle, float reach) : middle_(middle), reach_(reach) {}

  void add(uint32_t key, const Vec3& x) { cells_.add(cell(key, x)); }
  // May say yes for a place that is not seen, hardly ever no for one that is.
  bool contains(uint32_t key, const Vec3& x) const { return cells_.contains(cell(key, x)); }

 private:
  uint32_t cell(uint32_t key, const Vec3& x) const {
    return static_cast<uint32_t>(
        ClearRegions::region(key, x, kWidth * std::max(length(x - middle_), reach_)) >> 32);
  }
  static constexpr float kWidth = 0.25f;

  Vec3 middle_;
  float reach_;
  SurfaceFilter cells_;
};

}  // namespace photon_splat
