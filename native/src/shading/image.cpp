// Image, Environment and IES textures.
#include "lights/environment.h"
#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

using Color = std::array<float, 4>;

Color look_up(const Frame& f, uint32_t texture, const Vec2& uv, bool unassociate) {
  if (texture == kNone) return {1, 0, 1, 1};
  return f.scene.textures[texture].lookup_rgba(uv, unassociate);
}

Vec2 on_tube(const Vec3& p) {
  if (p.x == 0 && p.y == 0) return {};
  return {(1 - std::atan2(p.x, p.y) / kPi) * 0.5f, (p.z + 1) * 0.5f};
}

Vec2 equirectangular(const Vec3& d) {
  if (length2(d) == 0) return {};
  return {(std::atan2(d.y, d.x) - kPi) / (-2 * kPi),
          (std::acos(std::clamp(d.z, -1.0f, 1.0f)) - kPi) / -kPi};
}

Vec2 mirror_ball(Vec3 d) {
  d.y -= 1;
  const float scale = 2 * std::sqrt(std::max(-0.5f * d.y, 0.0f));
  if (scale > 0) d = d / scale;
  return {0.5f * (d.x + 1), 0.5f * (d.z + 1)};
}

// Shares of the three faces of a box that a normal looks at: one alone while it outweighs both
// others by `limit`, else a mix of two or three. `n`: absolute components that sum to 1.
Vec3 box_weights(const Vec3& n, float blend) {
  const float limit = 0.5f * (1 + blend);
  const auto alone = [limit](float a, float b, float c) {
    return a > limit * (a + b) && a > limit * (a + c);
  };
  if (alone(n.x, n.y, n.z)) return {1, 0, 0};
  if (alone(n.y, n.x, n.z)) return {0, 1, 0};
  if (alone(n.z, n.x, n.y)) return {0, 0, 1};
  if (!(blend > 0)) return {1, 0, 0};
  const auto share = [blend](float a, float b) {
    return clamp_unit((a / (a + b) - 0.5f * (1 - blend)) / blend);
  };
  if (n.z < (1 - limit) * (n.x + n.y)) return {share(n.x, n.y), 1 - share(n.x, n.y), 0};
  if (n.x < (1 - limit) * (n.y + n.z)) return {0, share(n.y, n.z), 1 - share(n.y, n.z)};
  if (n.y < (1 - limit) * (n.x + n.z)) return {share(n.x, n.z), 0, 1 - share(n.x, n.z)};
  return (n * (2 - limit) + Vec3{1, 1, 1} * (limit - 1)) / (2 * limit - 1);
}

Color box(Frame& f, uint32_t texture, const Vec3& p, float blend, bool unassociate) {
  const Vec3& n = f.object_normal();
  Vec3 a = each(n, [](float c) { return std::abs(c); });
  a = a / (a.x + a.y + a.z);
  const Vec3 weights = box_weights(a, blend);
  // No face shows the image mirrored.
  const Vec2 uv[3] = {{n.x < 0 ? 1 - p.y : p.y, p.z},
                      {n.y > 0 ? 1 - p.x : p.x, p.z},
                      {n.z > 0 ? 1 - p.y : p.y, p.x}};
  Color sum{};
  for (int face = 0; face < 3; ++face) {
    if (!(weights[face] > 0)) continue;
    const Color part = look_up(f, texture, uv[face], unassociate);
    for (size_t c = 0; c < 4; ++c) sum[c] += weights[face] * part[c];
  }
  return sum;
}

void set(Frame& f, const uint32_t* w, const Color& c) {
  f.set(w[0], Vec3{c[0], c[1], c[2]});
  f.set(w[1], c[3]);
}

// Catmull-Rom spline between b and c.
float spline(float a, float b, float c, float d, float t) {
  return b + 0.5f * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

// Place of x among ascending angles, at most count - 2.
int interval(const float* angles, int count, float x) {
  int i = 0;
  while (i < count - 2 && angles[i + 1] < x) ++i;
  return i;
}

float ies(const float* profile, float horizontal, float vertical) {
  const int h = static_cast<int>(profile[0]), v = static_cast<int>(profile[1]);
  const float* across = profile + 2;
  const float* up = across + h;
  const float* values = up + v;
  if (!(vertical >= up[0] && vertical < up[v - 1] && horizontal >= across[0] &&
        horizontal < across[h - 1]))
    return 0;
  const bool full_turn = across[0] < 1e-7f && across[h - 1] > 2 * kPi - 1e-7f;
  const bool low_pole = up[0]<1e-7f, high_pole = up[v - 1]> kPi - 1e-7f;
  const int i = interval(across, h, horizontal), j = interval(up, v, vertical);
  const auto fraction = [](const float* a, float x) {
    return a[1] > a[0] ? (x - a[0]) / (a[1] - a[0]) : 0;
  };
  const float s = fraction(across + i, horizontal), t = fraction(up + j, vertical);
  const auto column = [&](int k) {
    const float* c = values + static_cast<size_t>(k) * v;
    const float before = j > 0 ? c[j - 1] : low_pole ? c[1] : c[j];
    const float after = j + 2 < v ? c[j + 2] : high_pole ? c[v - 2] : c[j + 1];
    return spline(before, c[j], c[j + 1], after, t);
  };
  const float b = column(i), c = column(i + 1);
  // A full turn has its first angle again at the end.
  const float a = i > 0 ? column(i - 1) : full_turn ? column(h - 2) : b;
  const float d = i + 2 < h ? column(i + 2) : full_turn ? column(1) : b;  // as in Cycles
  return std::max(spline(a, b, c, d, s), 0.0f);
}

}  // namespace

void image_texture(Frame& f, const uint32_t* w) {
  const Vec3 p = f.vector(w[2]);
  const bool unassociate = f.on(w[6]);
  const Vec3 centered = (p - Vec3{0.5f, 0.5f, 0.5f}) * 2;
  switch (f.mode<Projection>(w[4])) {
    case Projection::FLAT: return set(f, w, look_up(f, w[3], {p.x, p.y}, unassociate));
    case Projection::BOX: return set(f, w, box(f, w[3], p, f.number(w[5]), unassociate));
    case Projection::SPHERE: return set(f, w, look_up(f, w[3], sphere_uv(centered), unassociate));
    case Projection::TUBE: return set(f, w, look_up(f, w[3], on_tube(centered), unassociate));
  }
}

void environment_texture(Frame& f, const uint32_t* w) {
  const Vec3 d = safe_normalize(f.vector(w[2]));
  const bool round = f.mode<EnvironmentProjection>(w[4]) == EnvironmentProjection::EQUIRECTANGULAR;
  set(f, w, look_up(f, w[3], round ? equirectangular(d) : mirror_ball(d), f.on(w[5])));
}

void sun_disc(Frame& f, const uint32_t* w) {
  Rgb color = f.vector(w[1]);
  if (f.point.suns) {
    const float elevation = f.number(w[5]);
    const SunDisc sun{{std::cos(elevation), 0, std::sin(elevation)},
                      f.number(w[6]),
                      f.vector(w[3]),
                      f.vector(w[4]),
                      f.number(w[7])};
    color += SunCone(sun).radiance(safe_normalize(f.vector(w[2])));
  }
  f.set(w[0], color);
}

void ies_texture(Frame& f, const uint32_t* w) {
  const Vec3 d = safe_normalize(f.vector(w[1]));
  const float vertical = std::acos(std::clamp(-d.z, -1.0f, 1.0f)),
              horizontal = std::atan2(d.x, d.y) + kPi;
  f.set(w[0], f.number(w[2]) * ies(f.constants + w[3], horizontal, vertical));
}

}  // namespace photon_splat::nodes
