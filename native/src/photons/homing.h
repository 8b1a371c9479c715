// Heavy photons that are far from what is seen: some are sent there on purpose.
#pragma once

#include "bsdf/bsdf.h"

namespace photon_splat {

// Where a view sees little of a scene, photons from far out are few and heavy: one that a surface
// happens to scatter to what is seen stands for very many. A surface that scatters such a photon
// sends another one into the ball around what is seen, with a chance for which it arrives as heavy
// as others are there. Both weigh by the density of their ways together, so that no light is lost
// or added, and none gets heavier.
class Homing {
 public:
  Homing() = default;
  // `usual`: of photons on what is seen, W, as if there were one path.
  Homing(const Vec3& middle, float radius, float usual)
      : middle_(middle), radius_(radius), usual_(usual) {}

  // Whether a photon of that power, as if there were one path, is so much heavier than others.
  bool heavy(float power) const { return power > kHeavy * usual_; }
  // Where a surface sends photons of that power, and with which chance: into the ball as seen from
  // there.
  Towards towards(const Vec3& place, const Vec3& n, float power) const {
    if (!heavy(power)) return {};
    const Vec3 to = middle_ - place;
    const float d2 = length2(to), r2 = radius_ * radius_;
    if (!(d2 > kOutside * r2)) return {};
    const float s2 = r2 / d2, s = std::sqrt(s2);
    const Cone cone{to * (1 / std::sqrt(d2)), s2 / (1 + std::sqrt(1 - s2))};
    // Mean of the cosines that are above the surface
    const float c = dot(n, cone.axis);
    const float mean = c > s ? c : c > -s ? (c + s) * (c + s) / (4 * s) : 0;
    const float arrive = mean * cone.solid_angle() * (1 / kPi);
    return {cone, std::min(1.0f, arrive * power / usual_)};
  }

 private:
  static constexpr float kHeavy = 8;
  static constexpr float kOutside = 1.1f;  // squares of distance over radius

  Vec3 middle_{};
  float radius_ = 0, usual_ = INFINITY;
};

}  // namespace photon_splat
