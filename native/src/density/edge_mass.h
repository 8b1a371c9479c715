// What an edge means for the mass of a kernel in its plane.
#pragma once

#include "math/vec.h"

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

// Angle and kernel integral of the triangle (x, begin, end), signed by the side of the edge on
// which x lies.
inline double triangle_mass(const EdgeInPlane& e) {
  const double d = e.distance;
  if (d == 0) return 0;
  const auto angle = [d](double from, double to) {  // between two points of the edge
    return from == to ? 0.0 : std::atan2((to - from) * std::abs(d), d * d + from * to);
  };
  const double half = std::sqrt(std::max(0.0, 1 - d * d));  // where the line leaves the unit disc
  const double t0 = std::clamp(e.begin, -half, half), t1 = std::clamp(e.end, -half, half);
  // Seen beyond the disc: of a line that misses it all, in two parts, each less than pi.
  double mass = (angle(e.begin, t0) + angle(t1, e.end)) / (2 * M_PI);
  // Inside: integral of (1/pi)(1 - s^2/2) |d| dt with s^2 = d^2 + t^2.
  mass += std::abs(d) / M_PI * ((1 - d * d / 2) * (t1 - t0) - (t1 * t1 * t1 - t0 * t0 * t0) / 6);
  return d > 0 ? mass : -mass;
}

// The kernel's mass beyond an edge: what the edge takes from 1.
inline double mass_beyond(const EdgeInPlane& e) {
  const double d = e.distance;
  if (std::abs(d) >= 1) return 0;
  const double half = std::sqrt(1 - d * d);
  const double t0 = std::max(e.begin, -half), t1 = std::min(e.end, half);
  if (t0 >= t1) return 0;
  const auto primitive = [d](double t) {  // of (1 - s^2)^2 |d| / s^2
    const double a = std::abs(d);
    return std::atan2(t, a) - 2 * a * t + a * (d * d * t + t * t * t / 3);
  };
  const double mass = (primitive(t1) - primitive(t0)) / (2 * M_PI);
  return d >= 0 ? mass : -mass;
}

}  // namespace photon_splat
