// Lamps with node trees: a program that runs wherever the lamp is looked at. What it is told of the
// lamp (coordinates, normals) was measured on Cycles, lamp by lamp.
#include "lights/lamp.h"

namespace photon_splat {
namespace {

// The lamp's own coordinates: over an area lamp; of the sphere around a point lamp; over a spot's
// cone at a distance of 1; over a sun's disc, by half the sine of half the angle to its middle.
Vec2 lamp_uv(const Lamp& lamp, const Vec3& position, const Vec3& normal, const Vec3& wo) {
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

}  // namespace

Rgb lamp_program(const Scene& scene, const Lamp& lamp, const Vec3& position, const Vec3& wo,
                 float distance) {
  ShadingPoint p;
  p.wo = wo;
  p.position = position;
  p.ns = wo;  // of what faces its receiver
  if (lamp.s.kind == LampKind::kSun) {
    // Its place is a unit vector in the world, as Cycles has it.
    p.position = wo - Vec3{static_cast<float>(scene.origin[0]), static_cast<float>(scene.origin[1]),
                           static_cast<float>(scene.origin[2])};
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
  run_program(scene, scene.programs[lamp.s.program], p, bsdf);
  return max(bsdf.emission(), Vec3{});
}

}  // namespace photon_splat
