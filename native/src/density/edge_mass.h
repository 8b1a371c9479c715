// What an edge means for the mass of a kernel in its plane.
#pragma once

#include "math/sampling.h"

namespace photon_splat {

struct EdgeInPlane {
  // From x to the edge's line, positive when x is on the patch's side; in units of h
  double distance;
  double begin, end;  // along the line from x's foot point, counter-clockwise
};

// Masses of the kernels of radius h and kNarrow * h.
struct Masses {
  double wide = 0, narrow = 0;
};

// The edge in units of `scale` of the old unit.
inline EdgeInPlane rescaled(const EdgeInPlane& e, double scale) {
  return {e.distance / scale, e.begin / scale, e.end / scale};
}

// Projects an edge to the tangent plane; `front` is the normal about which the edge runs
// counter-clockwise.
inline bool project(const Vec3& x, const Vec3& front, float h, const Vec3& a, const Vec3& b,
                    EdgeInPlane& out) {
  const Vec3 along = (b - a) - front * dot(b - a, front);
  const double len = length(along);
  if (!(len > 0)) return false;
  const Vec3 t = along / static_cast<float>(len), inward = cross(front, t);
  const Vec3 from = x - a;
  out.distance = double(dot(inward, from)) / h;
  out.begin = -double(dot(t, from)) / h;
  out.end = out.begin + len / h;
  return true;
}

// The angle at x from one point of the edge to another, as a share of a full turn, to within 6e-8.
inline double turn_between(double distance, double from, double to) {
  return turn_of(static_cast<float>((to - from) * std::abs(distance)),
                 static_cast<float>(distance * distance + from * to));
}

// Angle and kernel integral of the triangle (x, begin, end), signed by the side of the edge on
// which x lies.
inline double triangle_mass(const EdgeInPlane& e) {
  const double d = e.distance;
  if (d == 0) return 0;
  const double half = std::sqrt(std::max(0.0, 1 - d * d));  // where the line leaves the unit disc
  const double t0 = std::clamp(e.begin, -half, half), t1 = std::clamp(e.end, -half, half);
  const auto signed_by_side = [d](double mass) { return d > 0 ? mass : -mass; };
  if (t0 == t1) return signed_by_side(turn_between(d, e.begin, e.end));
  double mass = 0;  // first what is seen beyond the disc
  if (e.begin < t0) mass += turn_between(d, e.begin, t0);
  if (t1 < e.end) mass += turn_between(d, t1, e.end);
  // Inside: integral of (1/pi)(1 - s^2/2) |d| dt with s^2 = d^2 + t^2.
  mass += std::abs(d) / M_PI * ((1 - d * d / 2) * (t1 - t0) - (t1 * t1 * t1 - t0 * t0 * t0) / 6);
  return signed_by_side(mass);
}

// Whether any of the edge lies within a disc of that radius about x.
inline bool comes_within(const EdgeInPlane& e, double radius) {
  const double nearest = std::clamp(0.0, e.begin, e.end);
  return e.distance * e.distance + nearest * nearest < radius * radius;
}

// The kernel's mass beyond an edge: what the edge takes from 1.
inline double mass_beyond(const EdgeInPlane& e) {
  const double d = e.distance;
  if (std::abs(d) >= 1) return 0;
  const double half = std::sqrt(1 - d * d);
  const double t0 = std::max(e.begin, -half), t1 = std::min(e.end, half);
  if (t0 >= t1) return 0;
  const double a = std::abs(d);
  // Of (1 - s^2)^2 |d| / s^2, the angle between t0 and t1 apart
  const auto primitive = [=](double t) { return a * t * (d * d - 2 + t * t / 3); };
  const double mass = turn_between(d, t0, t1) + (primitive(t1) - primitive(t0)) / (2 * M_PI);
  return d >= 0 ? mass : -mass;
}

}  // namespace photon_splat
