// A triangle as a point sees it: uniform sampling of its solid angle.
#pragma once

#include "math/sampling.h"

namespace photon_splat {

// Corners as directions from the point. Arvo, "Stratified sampling of spherical triangles" (1995).
class SphericalTriangle {
 public:
  SphericalTriangle() = default;
  // Corners relative to the point, in metres; none may be the point itself.
  SphericalTriangle(const Vec3& p0, const Vec3& p1, const Vec3& p2) { see(p0, p1, p2); }
  void see(const Vec3& p0, const Vec3& p1, const Vec3& p2);  // the same, in place

  float solid_angle() const { return solid_angle_; }  // sr; 0 for what is seen edge-on
  const Vec3& corner(int k) const { return k == 0 ? a_ : k == 1 ? b_ : c_; }  // unit
  // A direction of the density 1 / solid_angle().
  Vec3 sample(const Vec2& u) const;

 private:
  Vec3 a_, b_, c_;  // unit
  float solid_angle_ = 0;
};

}  // namespace photon_splat
