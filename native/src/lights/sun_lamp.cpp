// Suns: parallel light, or that of a disc of directions.
#include "lights/lamp.h"

namespace photon_splat {

LampOutput set_up_sun(Lamp& lamp) {
  const LampSettings& settings = lamp.s;
  const Rgb strength = settings.strength;
  LampOutput out;
  const float half = 0.5f * std::clamp(settings.angle, 0.0f, kPi), sine = std::sin(half);
  lamp.one_minus_cos = 2 * std::sin(0.5f * half) * std::sin(0.5f * half);
  lamp.intensity = strength;
  if (lamp.one_minus_cos > 0)
    lamp.radiance = settings.normalize ? strength / (kPi * sine * sine) : strength;
  const Rgb through_disc =
      lamp.one_minus_cos > 0 ? lamp.radiance * (2 * kPi * lamp.one_minus_cos) : strength;
  out.importance = average(through_disc);
  out.parallel_flux = average(through_disc);
  return out;
}

bool sample_sun(const Scene& scene, const Lamp& lamp, const Vec2& u, LightSample& out) {
  out.direction = Basis(-lamp.forward).to_world(sample_cone(u, lamp.one_minus_cos));
  out.distance = INFINITY;
  out.pdf = lamp.one_minus_cos > 0 ? 1 / (2 * kPi * lamp.one_minus_cos) : 0;
  // Radiance over the cone's pdf is its flux per area; the cosine belongs to the receiver.
  out.weight =
      lamp.one_minus_cos > 0 ? lamp.radiance * (2 * kPi * lamp.one_minus_cos) : lamp.intensity;
  if (lamp.s.program >= 0) out.weight *= lamp_program(scene, lamp, {}, -out.direction, INFINITY);
  return !is_black(out.weight);
}

Rgb sun_met(const Scene& scene, const Lamp& lamp, const Vec3& direction, float far, float& pdf,
            float* met_at) {
  pdf = 0;
  if (std::isfinite(far) || lamp.one_minus_cos <= 0 ||
      length2(direction + lamp.forward) > 2 * lamp.one_minus_cos)
    return {};
  if (met_at) *met_at = INFINITY;
  const Rgb factor =
      lamp.s.program < 0 ? Rgb{1, 1, 1} : lamp_program(scene, lamp, {}, -direction, INFINITY);
  pdf = 1 / (2 * kPi * lamp.one_minus_cos);
  return lamp.radiance * factor;
}

}  // namespace photon_splat
