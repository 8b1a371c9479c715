// Lamps with node trees: a program that runs wherever the lamp is looked at. What it is told of the
// lamp (coordinates, normals) was measured on Cycles, lamp by lamp.
#include "lights/lights.h"

namespace photon_splat {
namespace {

constexpr uint32_t kProbes = 512;
// Of the brightest probe: where the program shines on a few directions alone, they are still found
constexpr float kLeastShare = 0.01f;

}  // namespace

// The lamp's own coordinates: over an area lamp; of the sphere around a point lamp; over a spot's
// cone at a distance of 1; over a sun's disc, by half the sine of half the angle to its middle.
Vec2 Lights::lamp_uv(const Lamp& lamp, const Vec3& position, const Vec3& normal,
                     const Vec3& wo) const {
  const Affine& to_local = lamp.place.to_local;
  switch (lamp.s.kind) {
    case LampKind::kArea: {
      const Vec3 p = to_local.point(position);
      return {p.x / lamp.s.size_x + 0.5f, p.y / lamp.s.size_y + 0.5f};
    }
    case LampKind::kPoint: return sphere_uv(to_local.vector(normal));
    case LampKind::kSpot: {
      const Vec3 d = to_local.vector(wo);
      const float cotangent =
          lamp.cos_half / std::sqrt(std::max(1 - lamp.cos_half * lamp.cos_half, 1e-12f));
      if (d.z == 0) return {0.5f, 0.5f};
      return {0.5f - 0.5f * cotangent * d.x / d.z, 0.5f - 0.5f * cotangent * d.y / d.z};
    }
    case LampKind::kSun: break;
  }
  if (!(lamp.one_minus_cos > 0)) return {0.5f, 0.5f};
  const Vec3 d = to_local.vector(wo);
  const float sine = std::sqrt(0.5f * lamp.one_minus_cos),
              cosine = std::sqrt(std::max(0.5f * (1 + dot(wo, lamp.forward)), 1e-6f));
  const float scale = 0.25f / (sine * cosine);
  return {0.5f - scale * d.x, 0.5f - scale * d.y};
}

Rgb Lights::shade(const Lamp& lamp, const Vec3& position, const Vec3& wo, float distance) const {
  ShadingPoint p;
  p.wo = wo;
  p.position = position;
  p.ns = wo;  // of what faces its receiver
  if (lamp.s.kind == LampKind::kSun) {
    // Its place is a unit vector in the world, as Cycles has it.
    p.position =
        wo - Vec3{static_cast<float>(scene_.origin[0]), static_cast<float>(scene_.origin[1]),
                  static_cast<float>(scene_.origin[2])};
  } else if (lamp.s.kind == LampKind::kArea) {
    p.ns = lamp.forward;
  } else if (lamp.s.radius > 0 && !lamp.s.soft_falloff) {
    p.ns = normalize(position - lamp.center);
  }
  p.ng = p.ns;
  const Vec2 uv = lamp_uv(lamp, p.position, p.ns, wo);
  p.u = uv.y;
  p.v = 1 - uv.x - uv.y;
  p.lamp = &lamp.place;
  p.ray.kind = RayInfo::kEmission;
  p.ray.length = distance;
  Bsdf bsdf(Transport::kRadiance, p.wo, p.ng, p.ns, false);
  run_program(scene_, scene_.programs[lamp.s.program], p, bsdf);
  return max(bsdf.emission(), Vec3{});
}

// About the mean over what the lamp sends out, RGB averaged, seen from as far as the scene is
// large.
float Lights::mean_shade(const Lamp& lamp) const {
  double sum = 0;
  float most = 0;
  for (uint32_t i = 0; i < kProbes; ++i) {
    PhotonStart start = emit_lamp(lamp, 0.75f, sobol_2d(i, 0, 0), sobol_2d(i, 1, 0));
    const float found =
        average(shade(lamp, start.origin, start.direction,
                      lamp.s.kind == LampKind::kSun ? INFINITY : scene_.near_radius()));
    if (!std::isfinite(found)) continue;
    sum += found;
    most = std::max(most, found);
  }
  return std::max({static_cast<float>(sum / kProbes), kLeastShare * most, 1e-4f});
}

Rgb Lights::first_hit_factor(const PhotonStart& start, const Vec3& receiver, float distance) const {
  const Lamp& lamp = lamps_[start.shaded_by];
  if (lamp.s.kind == LampKind::kSun) return shade(lamp, {}, start.direction, INFINITY);
  // The disc faces the receiver, not the photon
  if (lamp.s.kind != LampKind::kArea && lamp.s.radius > 0 && lamp.s.soft_falloff) {
    const Vec3 to = lamp.center - receiver;
    distance = length2(to) / std::max(-dot(to, start.direction), 1e-20f);
    return shade(lamp, receiver - start.direction * distance, start.direction, distance);
  }
  return shade(lamp, start.origin, start.direction, distance);
}

}  // namespace photon_splat
