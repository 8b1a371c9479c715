#include "math/spherical_triangle.h"

#include <algorithm>

namespace photon_splat {
namespace {

// The part of `v` across the unit vector `axis`, of length 1; any such vector where there is none.
Vec3 across(const Vec3& v, const Vec3& axis) {
  const Vec3 rest = v - axis * dot(v, axis);
  const float size = length(rest);
  return size > 1e-12f ? rest / size : Basis(axis).to_world({1, 0, 0});
}

// Sine and cosine of x >= 0; by the series where that ends soon.
void sine_cosine(float x, float& sine, float& cosine) {
  if (x > 1.6f) {
    sine = std::sin(x);
    cosine = std::cos(x);
    return;
  }
  const float x2 = x * x;
  sine = x *
         (1 + x2 * (-1.0f / 6 + x2 * (1.0f / 120 +
                                      x2 * (-1.0f / 5040 + x2 * (1.0f / 362880 - x2 / 39916800)))));
  cosine =
      1 + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320 - x2 / 3628800))));
}

}  // namespace

// Solid angle by Van Oosterom & Strackee (1983); the triple product is taken of edges, so that
// small triangles keep their digits.
void SphericalTriangle::see(const Vec3& p0, const Vec3& p1, const Vec3& p2) {
  solid_angle_ = 0;
  const float l0 = length(p0), l1 = length(p1), l2 = length(p2);
  if (!(l0 > 0 && l1 > 0 && l2 > 0)) return;
  a_ = p0 / l0;
  b_ = p1 / l1;
  c_ = p2 / l2;
  const float triple = std::abs(dot(p0, cross(p1 - p0, p2 - p0))) / (l0 * l1 * l2);
  if (!(triple > 0)) return;
  solid_angle_ = 4 * kPi * turn_of(triple, 1 + dot(a_, b_) + dot(b_, c_) + dot(c_, a_));
  if (!std::isfinite(solid_angle_)) solid_angle_ = 0;
}

// The first number cuts the triangle by an arc from b to a point between a and c that leaves that
// share of the area, the second one picks a place on the arc.
Vec3 SphericalTriangle::sample(const Vec2& u) const {
  const Vec3 to_b = across(b_, a_), to_c = across(c_, a_);
  const float cos_alpha = std::clamp(dot(to_b, to_c), -1.0f, 1.0f),
              sin_alpha = length(cross(to_b, to_c));
  float sine, cosine;
  sine_cosine(u.x * solid_angle_, sine, cosine);
  // Sine and cosine of that angle less alpha
  const float s = sine * cos_alpha - cosine * sin_alpha, t = cosine * cos_alpha + sine * sin_alpha;
  const float along = t - cos_alpha, up = s + sin_alpha * dot(a_, b_);
  const float below = (up * s + along * t) * sin_alpha;
  const float q = std::abs(below) > 1e-12f
                      ? std::clamp(((up * t - along * s) * cos_alpha - up) / below, -1.0f, 1.0f)
                      : 1;
  const Vec3 cut = a_ * q + to_c * std::sqrt(std::max(0.0f, 1 - q * q));
  const float z = 1 - u.y * (1 - dot(cut, b_));
  return b_ * z + across(cut, b_) * std::sqrt(std::max(0.0f, 1 - z * z));
}

}  // namespace photon_splat
