// Lamps of a few flat triangles, seen from near: sampled by solid angle, which leaves of direct
// light's noise only shadows and the receiver's cosine; or, where that is known, by solid angle
// times cosine, which leaves the shadows.
#include "lights/close_light.h"

namespace photon_splat {
namespace {

// Times the emitter's radius; from further off all of it looks alike
constexpr float kClose = 16;
constexpr float kLeastSolidAngle = 5e-3f;  // of each triangle, sr: smaller ones lose digits
// Of all, seen from a surface: the nearest places are left to rays as well. In a medium nothing but
// the solid angle bounds a sample where lamps have no multiple importance.
constexpr float kMostSolidAngle = 5;
constexpr float kMostByCosine = 2;    // of all: cosines are taken as linear over a triangle
constexpr float kLeastCosine = 0.1f;  // of the largest

// A number in [0, 1] of a density that is linear from a to b there, not both 0.
float sample_linear(float u, float a, float b) {
  return std::min(u * (a + b) / (a + std::sqrt(a * a + u * (b * b - a * a))), 1.0f);
}

// A number r in [0, 1] of a density that goes as r times what is linear from a to b there, neither
// of which is under a tenth of the other.
float sample_linear_from_corner(float u, float a, float b) {
  const float d = b - a, target = u * (a + 2 * b) / 3;
  float r = std::sqrt(sample_linear(u, a, b));
  for (int i = 0; i < 2; ++i)
    r = std::clamp(
        r - (r * r * (a + d * r * (2.0f / 3)) - target) / std::max(2 * r * (a + d * r), 1e-12f),
        0.0f, 1.0f);
  return r;
}

}  // namespace

bool CloseLight::add(const Vec3& a, const Vec3& b, const Vec3& c) {
  const int i = count++;
  corner[i][0] = a;
  corner[i][1] = b;
  corner[i][2] = c;
  seen[i].see(corner[i][0], corner[i][1], corner[i][2]);
  share[i] = seen[i].solid_angle();
  total += share[i];
  return share[i] > kLeastSolidAngle;
}

namespace {

bool finish(const Receiver& to, CloseLight& out) {
  if (!is_black(to.n) && !(out.total < kMostSolidAngle)) return false;
  if (out.total < kMostByCosine && to.diffuse()) out.weigh_by_cosine(to.ns);
  return true;
}

}  // namespace

bool is_close(const Vec3& center, float radius, const Vec3& x) {
  return length2(center - x) <= kClose * kClose * radius * radius;
}

bool see_close(const Lamp& lamp, const Receiver& to, CloseLight& out) {
  if (lamp.s.kind != LampKind::kArea || lamp.s.ellipse || lamp.normalize_spread != 0) return false;
  const Vec3& x = to.x;
  const Vec3 right = lamp.axis_x * lamp.half_x, up = lamp.axis_y * lamp.half_y;
  const Vec3 low = lamp.center - right - up, high = lamp.center + right + up;
  return out.add(low - x, lamp.center + right - up - x, high - x) &&
         out.add(low - x, high - x, lamp.center - right + up - x) && finish(to, out);
}

bool see_close(const MeshLight& mesh, const Receiver& to, CloseLight& out) {
  if (mesh.triangles.size() > CloseLight::kMost) return false;
  for (const EmissiveTriangle& t : mesh.triangles)
    if (!out.add(t.corner[0] - to.x, t.corner[1] - to.x, t.corner[2] - to.x)) return false;
  return finish(to, out);
}

// Cosines are warped in as linear over the triangle, after a thought of Hart and others (Practical
// product sampling by fitting and composing warps, 2020): in the unit square that
// SphericalTriangle::sample() takes, x cuts the edge from a to c, and y goes from the corner b to
// there, as the square of the distance.
void CloseLight::weigh_by_cosine(const Vec3& ns) {
  float largest = 0;
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) {
      cosine[i][k] = dot(seen[i].corner(k), ns);
      largest = std::max(largest, cosine[i][k]);
    }
  if (!(largest > 1e-4f)) return;
  by_cosine = true;
  total = 0;
  for (int i = 0; i < count; ++i) {
    for (float& c : cosine[i]) c = std::max(c, kLeastCosine * largest);
    share[i] *= (cosine[i][0] + cosine[i][1] + cosine[i][2]) * (1.0f / 3);
    total += share[i];
  }
}

// The first number picks the triangle; what is left of it is used again.
bool CloseLight::sample(Vec2 u, Place& out) const {
  float target = u.x * total;
  int i = 0;
  while (i + 1 < count && target >= share[i]) target -= share[i++];
  if (!(share[i] > 0)) return false;
  u.x = std::clamp(target / share[i], 0.0f, kBelowOne);
  out.triangle = i;
  out.pdf = 1 / total;
  if (by_cosine) {
    const auto [a, b, c] = cosine[i];
    const float r = sample_linear_from_corner(u.y, b, 0.5f * (a + c));
    u.y = r * r;
    const float first = b + (a - b) * r, last = b + (c - b) * r;
    u.x = sample_linear(u.x, first, last);
    out.pdf *= first + (last - first) * u.x;
  }
  out.direction = normalize(seen[i].sample(u));
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
