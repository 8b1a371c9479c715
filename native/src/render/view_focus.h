// Where a view looks, so that photons start about it.
#pragma once

#include <optional>

#include "integrators/gather_point.h"
#include "lights/lights.h"
#include "photons/seen_places.h"

namespace photon_splat {

// For photons that serve every view: what is modelled in detail is what will be looked at.
void focus_on_geometry(const Scene& scene, Lights& lights);

class ViewFocus {
 public:
  // Once for a view, the first time that there are gather points. Returns where it looks, unless it
  // sees most of the scene.
  std::optional<SeenPlaces> look(const GatherPoints& gather_points, Lights& lights);
  const Vec3& middle() const { return middle_; }
  // Half of what is seen is no further from there, m; infinite before look().
  float reach() const { return reach_; }

 private:
  bool found_ = false;
  Vec3 middle_{};
  float reach_ = INFINITY;
};

}  // namespace photon_splat
