// Positions in double precision: halving an edge many times must not move it.
#pragma once

#include <cmath>

#include "math/vec.h"

namespace photon_splat {

struct Place {
  double x = 0, y = 0, z = 0;

  friend Place operator+(const Place& a, const Place& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Place operator-(const Place& a, const Place& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend Place operator*(const Place& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
  Vec3 rounded() const {
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
  }
};

inline double dot(const Place& a, const Place& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double length(const Place& a) { return std::sqrt(dot(a, a)); }
inline Place cross(const Place& a, const Place& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace photon_splat
