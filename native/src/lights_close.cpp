// Lamps of a few flat triangles, seen from near: sampled by solid angle, which leaves of direct light's noise only shadows and
// the receiver's cosine.
#include "lights.h"

namespace photon_splat {
namespace {

constexpr float kClose = 4;           // times the emitter's radius; from further off all of it looks much alike
constexpr float kLeastSolidAngle = 5e-3f;  // of each triangle, sr: smaller ones lose digits
constexpr float kMostSolidAngle = 5;       // of all

}  // namespace

bool Lights::see_close(const Emitter& e, const Vec3& x, CloseLamp& out) const {
  if (length2(e.center - x) > kClose * kClose * e.radius * e.radius) return false;
  Vec3 corner[CloseLamp::kMost][3];
  if (e.lamp < 0) {
    if (e.triangles.size() > CloseLamp::kMost) return false;
    out.count = static_cast<int>(e.triangles.size());
    for (int i = 0; i < out.count; ++i) std::copy_n(e.triangles[i].corner, 3, corner[i]);
  } else {
    const Lamp& lamp = lamps_[e.lamp];
    if (lamp.s.kind != LampKind::kArea || lamp.s.ellipse || lamp.normalize_spread != 0) return false;
    const Vec3 right = lamp.axis_x * lamp.half_x, up = lamp.axis_y * lamp.half_y;
    const Vec3 places[4] = {lamp.center - right - up, lamp.center + right - up, lamp.center + right + up, lamp.center - right + up};
    out.count = 2;
    for (int i = 0; i < 2; ++i)
      for (int k = 0; k < 3; ++k) corner[i][k] = places[k == 0 ? 0 : i + k];
  }
  out.total = 0;
  for (int i = 0; i < out.count; ++i) {
    for (int k = 0; k < 3; ++k) out.corner[i][k] = corner[i][k] - x;
    out.seen[i] = SphericalTriangle(out.corner[i][0], out.corner[i][1], out.corner[i][2]);
    if (!(out.seen[i].solid_angle() > kLeastSolidAngle)) return false;
    out.total += out.seen[i].solid_angle();
  }
  return out.total < kMostSolidAngle;
}

// The first number picks the triangle; what is left of it is used again.
bool Lights::CloseLamp::sample(const Vec2& u, Place& out) const {
  float target = u.x * total;
  int i = 0;
  while (i + 1 < count && target >= seen[i].solid_angle()) target -= seen[i++].solid_angle();
  if (!(seen[i].solid_angle() > 0)) return false;
  const float again = std::clamp(target / seen[i].solid_angle(), 0.0f, kBelowOne);
  out.triangle = i;
  out.direction = normalize(seen[i].sample({again, u.y}));
  const Vec3 edge_1 = corner[i][1] - corner[i][0], edge_2 = corner[i][2] - corner[i][0];
  out.normal = cross(edge_1, edge_2);
  const float facing = dot(out.direction, out.normal), size2 = length2(out.normal);
  if (!(size2 > 0) || std::abs(facing) <= 1e-7f * std::sqrt(size2)) return false;
  out.distance = dot(corner[i][0], out.normal) / facing;
  if (!(out.distance > 0)) return false;
  const Vec3 inside = out.direction * out.distance - corner[i][0];
  out.u = std::clamp(dot(cross(inside, edge_2), out.normal) / size2, 0.0f, 1.0f);
  out.v = std::clamp(dot(cross(edge_1, inside), out.normal) / size2, 0.0f, 1.0f - out.u);
  out.normal = out.normal / std::sqrt(size2);
  return true;
}

}  // namespace photon_splat
