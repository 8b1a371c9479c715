#include "geometry/motion.h"

namespace photon_splat {
namespace {

constexpr size_t kQuantiles = 1024;
constexpr float kNearlyTheSame = 0.9995f;  // cosine of half a turn that is interpolated linearly

float dot(const Quaternion& a, const Quaternion& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
Quaternion operator*(const Quaternion& q, float s) { return {q.w * s, q.x * s, q.y * s, q.z * s}; }
Quaternion operator+(const Quaternion& a, const Quaternion& b) {
  return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}
Quaternion unit(const Quaternion& q) { return q * (1 / std::sqrt(dot(q, q))); }

// Interpolates between two rotations on the great circle, the shortest way if their dot product is
// not negative.
Quaternion between(const Quaternion& a, const Quaternion& b, float t) {
  const float cosine = dot(a, b);
  if (cosine > kNearlyTheSame) return unit(a * (1 - t) + b * t);
  const Quaternion across = unit(b + a * -cosine);
  const float angle = std::acos(std::clamp(cosine, -1.0f, 1.0f)) * t;
  return a * std::cos(angle) + across * std::sin(angle);
}

// The rotation whose columns are these, orthonormal and right-handed.
Quaternion rotation_of(const Vec3& x, const Vec3& y, const Vec3& z) {
  const float trace = x.x + y.y + z.z;
  Quaternion q;
  if (trace > 0) {
    q = {1 + trace, y.z - z.y, z.x - x.z, x.y - y.x};
  } else if (x.x > y.y && x.x > z.z) {
    q = {y.z - z.y, 1 + x.x - y.y - z.z, y.x + x.y, z.x + x.z};
  } else if (y.y > z.z) {
    q = {z.x - x.z, y.x + x.y, 1 - x.x + y.y - z.z, z.y + y.z};
  } else {
    q = {x.y - y.x, z.x + x.z, z.y + y.z, 1 - x.x - y.y + z.z};
  }
  return unit(q);
}

// Columns of the rotation.
std::array<Vec3, 3> axes_of(const Quaternion& q) {
  const float xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const float xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const float wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {Vec3{1 - 2 * (yy + zz), 2 * (xy + wz), 2 * (xz - wy)},
          Vec3{2 * (xy - wz), 1 - 2 * (xx + zz), 2 * (yz + wx)},
          Vec3{2 * (xz + wy), 2 * (yz - wx), 1 - 2 * (xx + yy)}};
}

// The stretch that is left of the columns once they are turned back.
void set_stretch(Decomposed& d, const std::array<Vec3, 3>& q, const Affine& a) {
  const Vec3 x = a.column(0), y = a.column(1), z = a.column(2);
  d.xx = dot(q[0], x);
  d.xy = dot(q[0], y);
  d.xz = dot(q[0], z);
  d.yy = dot(q[1], y);
  d.yz = dot(q[1], z);
  d.zz = dot(q[2], z);
}

bool is_flat(const Affine& a) { return !(std::abs(determinant(a)) > 0); }

}  // namespace

Decomposed decompose(const Affine& a) {
  const Vec3 x = a.column(0), y = a.column(1), z = a.column(2);
  Decomposed d;
  d.translation = {a.m[3], a.m[7], a.m[11]};
  std::array<Vec3, 3> q;
  const float x_length = length(x);
  q[0] = x_length > 0 ? x / x_length : Vec3{1, 0, 0};
  const Vec3 side = y - q[0] * dot(q[0], y);
  const float side_length = length(side);
  q[1] = side_length > 1e-6f * length(y) ? side / side_length : Basis(q[0]).tangent;
  q[2] = cross(q[0], q[1]);
  if (dot(q[2], z) < 0) {  // mirrored: a turn of all axes' opposites
    q[0] = -q[0];
    q[1] = -q[1];
  }
  d.rotation = rotation_of(q[0], q[1], q[2]);
  set_stretch(d, q, a);
  return d;
}

Affine compose(const Decomposed& d) {
  const auto [x, y, z] = axes_of(d.rotation);
  const Vec3 columns[3] = {x * d.xx, x * d.xy + y * d.yy, x * d.xz + y * d.yz + z * d.zz};
  Affine a;
  for (int i = 0; i < 3; ++i)
    a.m[i] = columns[i].x, a.m[4 + i] = columns[i].y, a.m[8 + i] = columns[i].z;
  a.m[3] = d.translation.x, a.m[7] = d.translation.y, a.m[11] = d.translation.z;
  return a;
}

TransformMotion::TransformMotion(std::span<const Affine> steps) {
  for (const Affine& a : steps) steps_.push_back(decompose(a));
  // What is flat has no turn of its own: that of the step before it, or else after it.
  const auto take_turn = [&](size_t i, size_t from) {
    steps_[i].rotation = steps_[from].rotation;
    set_stretch(steps_[i], axes_of(steps_[i].rotation), steps[i]);
  };
  for (size_t i = 1; i < steps_.size(); ++i)
    if (is_flat(steps[i])) take_turn(i, i - 1);
  for (size_t i = steps_.size() - 1; i-- > 0;)
    if (is_flat(steps[i])) take_turn(i, i + 1);
  for (size_t i = 1; i < steps_.size(); ++i)
    if (dot(steps_[i - 1].rotation, steps_[i].rotation) < 0)
      steps_[i].rotation = steps_[i].rotation * -1.0f;
}

Affine TransformMotion::at(float time) const {
  const auto [first, t] = motion_step(steps_.size(), time);
  const Decomposed &a = steps_[first], &b = steps_[first + 1];
  const auto mixed = [t](float from, float to) { return from * (1 - t) + to * t; };
  return compose({a.translation * (1 - t) + b.translation * t, between(a.rotation, b.rotation, t),
                  mixed(a.xx, b.xx), mixed(a.xy, b.xy), mixed(a.xz, b.xz), mixed(a.yy, b.yy),
                  mixed(a.yz, b.yz), mixed(a.zz, b.zz)});
}

void Shutter::set(std::span<const float> curve, float rolling) {
  rolling_ = rolling;
  const size_t spans = curve.size() > 1 ? curve.size() - 1 : 1;
  std::vector<double> exposed{0};  // up to the end of each span
  for (size_t i = 0; i < spans; ++i)
    exposed.push_back(
        exposed.back() +
        (curve.size() > 1 ? 0.5 * (std::max(curve[i], 0.0f) + std::max(curve[i + 1], 0.0f)) : 1.0));
  if (!(exposed.back() > 0)) return set({}, rolling);
  quantiles_.clear();
  for (size_t i = 0, span = 0; i <= kQuantiles; ++i) {
    const double target = exposed.back() * static_cast<double>(i) / kQuantiles;
    while (span + 1 < spans && exposed[span + 1] <= target) ++span;
    const double area = exposed[span + 1] - exposed[span],
                 share = area > 0 ? std::clamp((target - exposed[span]) / area, 0.0, 1.0) : 0.0;
    double inside = share;  // as if it were open as far all the time
    if (curve.size() > 1) {
      // How far open it is changes by `slope`: share = (a t + slope t^2 / 2) / area.
      const double a = std::max(curve[span], 0.0f),
                   slope = static_cast<double>(std::max(curve[span + 1], 0.0f)) - a;
      const double root = std::sqrt(std::max(0.0, a * a + 2 * slope * share * area));
      inside = a + root > 0 ? 2 * share * area / (a + root) : 0.0;
    }
    quantiles_.push_back(static_cast<float>((static_cast<double>(span) + std::min(inside, 1.0)) /
                                            static_cast<double>(spans)));
  }
}

float Shutter::time(float u, float down) const {
  const float at = u * kQuantiles;
  const size_t i = std::min(static_cast<size_t>(at), kQuantiles - 1);
  const float exposed =
      quantiles_[i] + (quantiles_[i + 1] - quantiles_[i]) * (at - static_cast<float>(i));
  if (rolling_ < 0) return exposed;
  return std::clamp((exposed - 0.5f) * rolling_ + (down - 0.5f) * (1 - rolling_) + 0.5f, 0.0f,
                    1.0f);
}

}  // namespace photon_splat
