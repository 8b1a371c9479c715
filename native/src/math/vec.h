// Small vectors, frames and transforms. Directions are unit length unless said otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace photon_splat {

inline constexpr float kPi = 3.14159265358979f;

inline float sqr(float x) { return x * x; }
inline float saturate(float x) { return x > 0 ? (x < 1 ? x : 1.0f) : 0.0f; }  // NaN: 0

struct Vec3 {
  float x = 0, y = 0, z = 0;

  float operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  Vec3 operator-() const { return {-x, -y, -z}; }
  Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  Vec3& operator*=(const Vec3& b) {
    x *= b.x;
    y *= b.y;
    z *= b.z;
    return *this;
  }
  Vec3& operator*=(float s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
};
using Rgb = Vec3;

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(const Vec3& a, const Vec3& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3 operator*(const Vec3& a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline Vec3 operator*(float s, const Vec3& a) { return a * s; }
inline Vec3 operator/(const Vec3& a, float s) { return a * (1.0f / s); }
inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length2(const Vec3& a) { return dot(a, a); }
inline float length(const Vec3& a) { return std::sqrt(length2(a)); }
inline Vec3 normalize(const Vec3& a) { return a / length(a); }
inline float max_component(const Vec3& a) { return std::max({a.x, a.y, a.z}); }
// Rec. 709
inline float luminance(const Vec3& rgb) {
  return 0.2126f * rgb.x + 0.7152f * rgb.y + 0.0722f * rgb.z;
}
inline float average(const Vec3& a) { return (a.x + a.y + a.z) * (1.0f / 3.0f); }
inline bool is_zero(const Vec3& a) { return a.x == 0 && a.y == 0 && a.z == 0; }
inline bool is_black(const Vec3& a) { return a.x <= 0 && a.y <= 0 && a.z <= 0; }
// Far below the largest float: whatever is summed of these stays finite. NaN is none.
inline constexpr float kMostLight = 1e28f;
inline bool can_be_added(const Vec3& a) {
  return std::abs(a.x) < kMostLight && std::abs(a.y) < kMostLight && std::abs(a.z) < kMostLight;
}
inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline Vec3 min(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 max(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
inline Vec3 absolute(const Vec3& a) { return {std::abs(a.x), std::abs(a.y), std::abs(a.z)}; }
inline float max_abs(const Vec3& a) { return max_component(absolute(a)); }
// By components; 0 where there is nothing to divide by.
inline Vec3 divided(const Vec3& a, const Vec3& b) {
  return {b.x != 0 ? a.x / b.x : 0, b.y != 0 ? a.y / b.y : 0, b.z != 0 ? a.z / b.z : 0};
}

struct Bounds {
  Vec3 lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};

  void add(const Vec3& p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  void add(const Bounds& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
  bool empty() const { return lower.x > upper.x; }
  Vec3 center() const { return (lower + upper) * 0.5f; }
  float diagonal() const { return empty() ? 0.0f : length(upper - lower); }
};

// Orthonormal frame around a unit normal (Duff et al. 2017, "Building an orthonormal basis,
// revisited").
struct Basis {
  Vec3 tangent, bitangent, normal;

  explicit Basis(const Vec3& n) : normal(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }
  Vec3 to_world(const Vec3& v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
};

// Affine transform, rows of a 3x4 matrix; maps column vectors.
struct Affine {
  std::array<float, 12> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

  Vec3 point(const Vec3& p) const {
    return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
            m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
            m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
  }
  Vec3 vector(const Vec3& v) const {
    return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
            m[8] * v.x + m[9] * v.y + m[10] * v.z};
  }
  // Applies the transpose of the linear part: with the inverse transform this carries normals.
  Vec3 transposed_vector(const Vec3& v) const {
    return {m[0] * v.x + m[4] * v.y + m[8] * v.z, m[1] * v.x + m[5] * v.y + m[9] * v.z,
            m[2] * v.x + m[6] * v.y + m[10] * v.z};
  }
  Vec3 column(int i) const { return {m[i], m[4 + i], m[8 + i]}; }
};

double determinant(const Affine& a);
Affine inverse(const Affine& a);  // throws std::invalid_argument for a singular matrix

// A direction in the square from -1 to 1, on an unfolded octahedron (Cigolle et al. 2014, "A survey
// of efficient representations for independent unit vectors").
inline std::array<float, 2> octahedral(const Vec3& d) {
  const float s = 1.0f / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  const float u = d.x * s, v = d.y * s;
  if (!(d.z < 0)) return {u, v};
  return {(1.0f - std::abs(v)) * std::copysign(1.0f, u),
          (1.0f - std::abs(u)) * std::copysign(1.0f, v)};
}

// Unit vector in 16 bits, to about a degree.
inline uint16_t encode_direction(const Vec3& d) {
  const auto [u, v] = octahedral(d);
  // 127 steps to either side of 0, so that the axes are exact.
  const auto quantize = [](float f) {
    return static_cast<uint16_t>(std::clamp(f, -1.0f, 1.0f) * 127.0f + 127.5f);
  };
  return static_cast<uint16_t>(quantize(u) | quantize(v) << 8);
}

inline Vec3 decode_direction(uint16_t e) {
  float u = static_cast<float>(e & 0xff) / 127.0f - 1.0f;
  float v = static_cast<float>(e >> 8) / 127.0f - 1.0f;
  const float z = 1.0f - std::abs(u) - std::abs(v);
  if (z < 0) {
    const float t = (1.0f - std::abs(v)) * std::copysign(1.0f, u);
    v = (1.0f - std::abs(u)) * std::copysign(1.0f, v);
    u = t;
  }
  return normalize({u, v, z});
}

}  // namespace photon_splat
