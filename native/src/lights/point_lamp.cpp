// Point and spot lamps: a point, a sphere, or a disc that faces its receiver (soft falloff). A
// spot's light is smooth within a cone that the lamp's scale may widen.
#include "lights/lamp.h"
#include "math/table.h"

namespace photon_splat {
namespace {

float smoothstep(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

}  // namespace

float spot_attenuation(const Lamp& lamp, const Vec3& from_lamp) {
  const Vec3 local{dot(from_lamp, lamp.axis_x) / lamp.scale_x,
                   dot(from_lamp, lamp.axis_y) / lamp.scale_y,
                   dot(from_lamp, lamp.forward) / lamp.scale_z};
  return smoothstep((local.z / length(local) - lamp.cos_half) * lamp.inverse_smooth);
}

std::optional<LampOutput> set_up_point_lamp(const Scene& scene, Lamp& lamp) {
  const LampSettings& settings = lamp.s;
  const Rgb strength = settings.strength;
  LampOutput out;
  // Blender's watts are spread over all directions: I = P / (4 pi); without `normalize` L = P /
  // pi.
  const float r = settings.radius, disc = kPi * r * r;
  lamp.intensity =
      settings.normalize ? strength / (4 * kPi) : strength * ((r > 0 ? disc : 1.0f) / kPi);
  if (r > 0) lamp.radiance = lamp.intensity / disc;
  const bool crowded = r > 0 && scene.anything_within(lamp.center, r);
  lamp.holds_geometry = crowded && !settings.soft_falloff;
  lamp.faces_geometry = crowded && settings.soft_falloff;
  float share = 4 * kPi;
  if (lamp.s.kind == LampKind::kSpot) {
    lamp.cos_half = std::cos(0.5f * std::clamp(settings.spot_size, 0.0f, kPi));
    lamp.inverse_smooth = 1 / std::max((1 - lamp.cos_half) * settings.spot_blend, 1e-6f);
    if (!(lamp.cos_half < 1)) return {};
    lamp.angle_low = lamp.cos_half;
    lamp.angle_cdf = tabulate(lamp.angle_low, 1.0f, [&](float c) {
      const float t = std::clamp((c - lamp.cos_half) * lamp.inverse_smooth, 0.0f, 1.0f);
      return t * t * (3 - 2 * t);
    });
    share = 2 * kPi * lamp.angle_cdf.back();
  }
  out.radius = r;
  out.importance = average(lamp.intensity);
  out.power = average(lamp.intensity) * share;
  return out;
}

bool sample_point_lamp(const Scene& scene, const Lamp& lamp, const Vec3& x, const Vec2& u,
                       LightSample& out) {
  const Vec3 to = lamp.center - x;
  const float d2 = length2(to);
  if (!(d2 > 0)) return false;
  const float d = std::sqrt(d2), r = lamp.s.radius;
  if (r <= 0) {
    out.direction = to / d;
    out.distance = d;
    out.weight = lamp.intensity / d2;
  } else if (lamp.s.soft_falloff) {  // the disc that faces x fills a cone exactly
    const float one_minus_cos = (r * r / (d2 + r * r)) / (1 + d / std::sqrt(d2 + r * r));
    const Vec3 local = sample_cone(u, one_minus_cos);
    out.direction = Basis(to / d).to_world(local);
    out.distance = d / local.z;
    out.pdf = 1 / (2 * kPi * one_minus_cos);
    out.weight = lamp.radiance / out.pdf;
  } else if (d > r) {
    const float sin2 = r * r / d2;
    const float one_minus_cos = sin2 / (1 + std::sqrt(1 - sin2));
    const Vec3 local = sample_cone(u, one_minus_cos);
    out.direction = Basis(to / d).to_world(local);
    const float miss2 = d2 * (local.x * local.x + local.y * local.y);
    out.distance = d * local.z - std::sqrt(std::max(0.0f, r * r - miss2));
    out.pdf = 1 / (2 * kPi * one_minus_cos);
    out.weight = lamp.radiance / out.pdf;
  } else {  // inside a spherical lamp, which shines inwards too, and there without a spot's cone
    out.direction = sample_sphere(u);
    const float along = dot(to, out.direction);
    out.distance = along + std::sqrt(std::max(0.0f, along * along - d2 + r * r));
    out.pdf = 1 / (4 * kPi);
    out.weight = lamp.radiance / out.pdf;
    if (lamp.s.program >= 0)
      out.weight *=
          lamp_program(scene, lamp, x + out.direction * out.distance, -out.direction, out.distance);
    return !is_black(out.weight);
  }
  if (lamp.s.kind == LampKind::kSpot) out.weight *= spot_attenuation(lamp, -out.direction);
  if (lamp.s.program >= 0)
    out.weight *=
        lamp_program(scene, lamp, x + out.direction * out.distance, -out.direction, out.distance);
  return !is_black(out.weight);
}

Rgb point_lamp_met(const Scene& scene, const Lamp& lamp, const Vec3& origin, const Vec3& direction,
                   float near, float far, float& pdf, float* met_at) {
  pdf = 0;
  const auto shaded = [&](float distance) {
    if (met_at) *met_at = distance;
    if (lamp.s.program < 0) return Rgb{1, 1, 1};
    return lamp_program(scene, lamp, origin + direction * distance, -direction, distance);
  };
  const Vec3 to = lamp.center - origin;
  const float along = dot(to, direction), d2 = length2(to), r2 = lamp.s.radius * lamp.s.radius;
  // d2 - along^2 loses the digits of small lamps
  const float miss2 = length2(to - direction * along);
  if (r2 <= 0 || miss2 > r2) return {};
  float one_minus_cos, distance;
  if (lamp.s.soft_falloff) {
    distance = d2 / along;
    if (along <= 0 || distance <= near || distance > far || miss2 * (d2 + r2) > r2 * d2) return {};
    one_minus_cos = (r2 / (d2 + r2)) / (1 + std::sqrt(d2 / (d2 + r2)));
  } else if (d2 > r2) {
    const float entry = along - std::sqrt(r2 - miss2);
    if (entry <= near || entry > far) return {};
    distance = entry;
    const float sin2 = r2 / d2;
    one_minus_cos = sin2 / (1 + std::sqrt(1 - sin2));
  } else {  // from inside
    const float exit = along + std::sqrt(r2 - miss2);
    if (exit <= near || exit > far) return {};
    pdf = 1 / (4 * kPi);
    return lamp.radiance * shaded(exit);
  }
  pdf = 1 / (2 * kPi * one_minus_cos);
  const Rgb radiance = lamp.radiance * shaded(distance);
  return lamp.s.kind == LampKind::kSpot ? radiance * spot_attenuation(lamp, -direction) : radiance;
}

PhotonStart emit_point_lamp(const Lamp& lamp, float coin, const Vec2& place, const Vec2& way) {
  PhotonStart start;
  // Lines of uniform density that pass the centre within the radius.
  if (lamp.s.kind == LampKind::kPoint) {
    start.direction = sample_sphere(way);
    start.power = lamp.intensity * (4 * kPi);
  } else {
    const TableSample s = sample_table(lamp.angle_cdf, lamp.angle_low, 1, way.x);
    const float t = std::clamp((s.value - lamp.cos_half) * lamp.inverse_smooth, 0.0f, 1.0f);
    const Vec3 local = around_axis({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, s.value, way.y);
    const Vec3 scaled{local.x * lamp.scale_x, local.y * lamp.scale_y, local.z * lamp.scale_z};
    const float len = length(scaled);
    const float jacobian = lamp.scale_x * lamp.scale_y * lamp.scale_z / (len * len * len);
    start.direction =
        normalize(lamp.axis_x * scaled.x + lamp.axis_y * scaled.y + lamp.forward * scaled.z);
    start.power = lamp.intensity * (2 * kPi * t * t * (3 - 2 * t) * jacobian / s.pdf);
  }
  // A spherical spot's cone holds outside it alone: inside it is a point lamp.
  if (lamp.s.kind == LampKind::kSpot && lamp.holds_geometry && coin < 0.5f)
    start.direction = sample_sphere(way);
  start.origin = lamp.center;
  const float r = lamp.s.radius;
  if (r > 0) {
    const Vec2 p = sample_disk(place);
    const float half = r * std::sqrt(std::max(0.0f, 1 - p.x * p.x - p.y * p.y));
    const float ahead = !lamp.s.soft_falloff ? half : lamp.faces_geometry ? -half : 0;
    // What stands inside a spherical lamp is lit by its far wall and does not shadow what is
    // outside: either photons.
    const bool inside = lamp.holds_geometry && coin < 0.5f;
    start.origin += Basis(start.direction).to_world({p.x * r, p.y * r, inside ? -ahead : ahead});
    if (inside) {
      start.first_hit_to = 2 * ahead;
      if (lamp.s.kind == LampKind::kSpot) start.power = lamp.intensity * (4 * kPi);
    }
    if (lamp.holds_geometry) start.power *= 2;
    if (lamp.s.soft_falloff) {
      start.soft_radius2 = r * r;
      start.soft_miss2 = (p.x * p.x + p.y * p.y) * r * r;
      start.soft_nearest = -ahead;
    }
  }
  return start;
}

}  // namespace photon_splat
