// Area lamps: rectangles and ellipses that shine to one side, within their spread.
#include "lights/lamp.h"
#include "math/table.h"

namespace photon_splat {
namespace {

constexpr float kSmallestSpread = 0.1f * kPi / 180;

}  // namespace

std::optional<LampOutput> set_up_area_lamp(Lamp& lamp) {
  const LampSettings& settings = lamp.s;
  const Rgb strength = settings.strength;
  LampOutput out;
  lamp.half_x = 0.5f * settings.size_x * lamp.scale_x;
  lamp.half_y = 0.5f * settings.size_y * lamp.scale_y;
  lamp.area = 4 * lamp.half_x * lamp.half_y * (settings.ellipse ? kPi / 4 : 1.0f);
  if (!(lamp.area > 0)) return {};  // Blender's area light of size 0 emits nothing
  const Vec3 plane = cross(lamp.axis_x, lamp.axis_y);
  if (!(length(plane) > 0)) return {};
  lamp.forward = normalize(plane) * std::copysign(1.0f, dot(plane, lamp.forward));
  lamp.radiance = settings.normalize ? strength / (kPi * lamp.area) : strength / kPi;
  const float half_spread = 0.5f * std::clamp(settings.spread, kSmallestSpread, kPi);
  float sin2_max = 1;
  if (half_spread < 0.5f * kPi - 1e-4f) {
    lamp.tan_half_spread = std::tan(half_spread);
    // tan(h) - h by its series where the difference would cancel.
    const float h3 = half_spread * half_spread * half_spread;
    const float excess = half_spread < 0.05f ? h3 / 3 + 2 * h3 * half_spread * half_spread / 15
                                             : lamp.tan_half_spread - half_spread;
    lamp.normalize_spread = 1 / excess;
    const float sine = std::sin(half_spread);
    sin2_max = sine * sine;
    lamp.angle_high = sin2_max;
    lamp.angle_cdf = tabulate(0.0f, sin2_max, [&](float s2) {
      return spread_attenuation(lamp, std::sqrt(s2 / (1 - s2)));
    });
  }
  const float share = lamp.angle_cdf.empty() ? 1.0f : lamp.angle_cdf.back();
  out.radius = std::sqrt(lamp.half_x * lamp.half_x + lamp.half_y * lamp.half_y);
  out.importance = average(lamp.radiance) * lamp.area;
  out.power = average(lamp.radiance) * double(lamp.area) * kPi * share;
  return out;
}

bool sample_area_lamp(const Scene& scene, const Lamp& lamp, const Vec3& x, const Vec2& u,
                      LightSample& out) {
  Vec3 point;
  const float area = sampled_area(lamp, x);
  if (area < lamp.area) {  // only what lies in the beam that reaches x
    const Vec2 p = sample_disk(u);
    const float radius = std::sqrt(area / kPi);
    point = x + lamp.forward * dot(lamp.center - x, lamp.forward) + lamp.axis_x * (p.x * radius) +
            lamp.axis_y * (p.y * radius);
    if (!inside_shape(lamp, point - lamp.center)) return false;
  } else {
    Vec2 p{2 * u.x - 1, 2 * u.y - 1};
    if (lamp.s.ellipse) p = sample_disk(u);
    point = lamp.center + lamp.axis_x * (p.x * lamp.half_x) + lamp.axis_y * (p.y * lamp.half_y);
  }
  out.place = point;
  const Vec3 to = point - x;
  const float d2 = length2(to);
  if (!(d2 > 0)) return false;
  out.distance = std::sqrt(d2);
  out.direction = to / out.distance;
  const float cosine = -dot(out.direction, lamp.forward);
  if (cosine <= 0) return false;
  out.pdf = d2 / (cosine * area);
  const float along = dot(to, lamp.forward);
  out.weight = lamp.radiance *
               (spread_attenuation(lamp, length(to - lamp.forward * along) / -along) / out.pdf);
  if (lamp.s.program >= 0)
    out.weight *= lamp_program(scene, lamp, point, -out.direction, out.distance);
  return !is_black(out.weight);
}

Rgb area_lamp_met(const Scene& scene, const Lamp& lamp, const Vec3& origin, const Vec3& direction,
                  float near, float far, float& pdf, float* met_at) {
  pdf = 0;
  const auto shaded = [&](float distance) {
    if (met_at) *met_at = distance;
    if (lamp.s.program < 0) return Rgb{1, 1, 1};
    return lamp_program(scene, lamp, origin + direction * distance, -direction, distance);
  };
  const float cosine = -dot(direction, lamp.forward);
  if (cosine <= 0) return {};
  const Vec3 to = lamp.center - origin;
  const float t = -dot(to, lamp.forward) / cosine;
  if (!(t > near) || t > far) return {};
  if (!inside_shape(lamp, direction * t - to)) return {};
  pdf = t * t / (cosine * sampled_area(lamp, origin));
  return lamp.radiance * spread_attenuation(lamp, length(cross(direction, lamp.forward)) / cosine) *
         shaded(t);
}

PhotonStart emit_area_lamp(const Lamp& lamp, const Vec2& place, const Vec2& way) {
  PhotonStart start;
  Vec2 p{2 * place.x - 1, 2 * place.y - 1};
  if (lamp.s.ellipse) p = sample_disk(place);
  start.origin =
      lamp.center + lamp.axis_x * (p.x * lamp.half_x) + lamp.axis_y * (p.y * lamp.half_y);
  float sin2 = way.x, pdf = 1;  // of sin^2: cosine-weighted directions are uniform in it
  if (!lamp.angle_cdf.empty()) {
    const TableSample s = sample_table(lamp.angle_cdf, 0, lamp.angle_high, way.x);
    sin2 = s.value;
    pdf = s.pdf;
  }
  const float cosine = std::sqrt(std::max(0.0f, 1 - sin2));
  const Basis basis(lamp.forward);
  start.direction = around_axis(basis.tangent, basis.bitangent, basis.normal, cosine, way.y);
  start.power = lamp.radiance *
                (lamp.area * kPi *
                 spread_attenuation(lamp, std::sqrt(sin2 / std::max(1 - sin2, 1e-12f))) / pdf);
  return start;
}

}  // namespace photon_splat
