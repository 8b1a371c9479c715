// Lamps: what Blender says of them, and what all estimators compute with. Each kind has a file of
// its own with the same four questions: set up, sampled from a place, met by a ray, and as the
// start of a photon; point_lamp.cpp (spots too), area_lamp.cpp, sun_lamp.cpp.
#pragma once

#include <optional>

#include "lights/emission/photon_start.h"
#include "lights/light_sample.h"

namespace photon_splat {

enum class LampKind { kPoint, kSpot, kSun, kArea };

// A lamp as Blender means it; positions relative to the scene's origin. Which radiometric quantity
// `strength` stands for is said beside the conversion, in set_up_*().
struct LampSettings {
  LampKind kind = LampKind::kPoint;
  Affine to_world;
  Rgb strength{};
  float radius = 0;
  bool soft_falloff = true;
  float spot_size = kPi / 4, spot_blend = 0;
  float angle = 0;
  float size_x = 1, size_y = 1;
  bool ellipse = false;
  float spread = kPi;
  bool normalize = true;
  bool camera_visible = false;
  int program = -1;  // into Scene::programs: its emission is a factor of `strength`
  uint64_t lit_groups = ~uint64_t{0};  // of light linking: instances with one of these bits see it
  uint64_t blockers = ~uint64_t{0};    // of shadow linking: the others let its light pass
  int16_t light_group = kNoLightGroup;
  // Rays of these kinds bring its light; what shadow rays bring is scattered as if by one of them
  RayMask seen_by = kAllRays;
  uint32_t max_bounces = ~0u;  // of a path before it finds the lamp
  bool met_by_rays = true;     // else by light samples alone
  // Else light samples pass everything, which other rays to the lamp do not
  bool casts_shadows = true;
};

// A lamp ready to be sampled.
struct Lamp {
  static constexpr uint32_t kUnnumbered = ~0u;
  uint32_t number = kUnnumbered;  // among those given
  LampSettings s;
  Vec3 center, axis_x, axis_y, forward;  // unit axes; forward: where the light shines
  // W/m^2/sr; W/sr of point and spot; W/m^2 of a sun in `intensity`
  Rgb radiance, intensity;
  float half_x = 0, half_y = 0, area = 0;
  bool holds_geometry = false;  // a spherical lamp with something inside it
  bool faces_geometry = false;  // the same of one that faces its receiver
  float one_minus_cos = 0;      // of a sun's half angle
  float cos_half = 0, inverse_smooth = 0, scale_x = 1, scale_y = 1, scale_z = 1;  // spot cone
  float tan_half_spread = 0, normalize_spread = 0;
  // Cumulative distribution of the photon's direction: spots and narrow areas, see area_lamp.cpp
  std::vector<float> angle_cdf;
  // Lower end of the tabled variable; the upper end is 1 (spot) or in angle_high
  float angle_low = 0;
  float angle_high = 1;
  LampPlace place;  // of those with a program
};

// What a lamp sends out.
struct LampOutput {
  float importance = 0;      // over squared distance it ranks emitters; of a sun not over that
  double power = 0;          // W, mean over RGB
  double parallel_flux = 0;  // of a sun: through a surface that faces it, mean over RGB, W/m^2
  float radius = 0;          // of the bounding sphere, m
};

// Radiance and so on from the settings; none for a lamp that emits nothing. The power of a sun is
// known where its light's cross section is.
std::optional<LampOutput> set_up_point_lamp(const Scene& scene, Lamp& lamp);
std::optional<LampOutput> set_up_area_lamp(Lamp& lamp);
LampOutput set_up_sun(Lamp& lamp);

// A direction in which the lamp is seen from x; false where no light comes. All of `out` that is
// the lamp's own is written: direction, distance, pdf, weight.
bool sample_point_lamp(const Scene& scene, const Lamp& lamp, const Vec3& x, const Vec2& u,
                       LightSample& out);
bool sample_area_lamp(const Scene& scene, const Lamp& lamp, const Vec3& x, const Vec2& u,
                      LightSample& out);
bool sample_sun(const Scene& scene, const Lamp& lamp, const Vec2& u, LightSample& out);

// Radiance against a ray that meets the lamp between `near` and `far`; `pdf` is that of sampling it
// for this direction, 0 where the lamp is not met, else `met_at` (if any) says where.
Rgb point_lamp_met(const Scene& scene, const Lamp& lamp, const Vec3& origin, const Vec3& direction,
                   float near, float far, float& pdf, float* met_at);
Rgb area_lamp_met(const Scene& scene, const Lamp& lamp, const Vec3& origin, const Vec3& direction,
                  float near, float far, float& pdf, float* met_at);
Rgb sun_met(const Scene& scene, const Lamp& lamp, const Vec3& direction, float far, float& pdf,
            float* met_at);

// A photon in proportion to the power that the lamp sends there, its program aside. (A sun's starts
// across the scene: PhotonStart PhotonEmitter::emit_parallel().)
PhotonStart emit_point_lamp(const Lamp& lamp, float coin, const Vec2& place, const Vec2& way);
PhotonStart emit_area_lamp(const Lamp& lamp, const Vec2& place, const Vec2& way);

// lamp_program.cpp: the factor of the lamp's radiance by its program, at `position` (of a sun:
// anything) seen from `distance` along -wo. White for lamps without one.
Rgb lamp_program(const Scene& scene, const Lamp& lamp, const Vec3& position, const Vec3& wo,
                 float distance);

// Factor on a spot lamp's radiant intensity in a direction from it.
float spot_attenuation(const Lamp& lamp, const Vec3& from_lamp);
// Factor on an area lamp's radiance, by the tangent of the angle to its axis.
inline float spread_attenuation(const Lamp& lamp, float tangent) {
  if (lamp.normalize_spread == 0) return 1;
  return std::max(0.0f, (lamp.tan_half_spread - tangent) * lamp.normalize_spread);
}
inline bool inside_shape(const Lamp& lamp, const Vec3& from_center) {
  const float px = dot(from_center, lamp.axis_x) / lamp.half_x,
              py = dot(from_center, lamp.axis_y) / lamp.half_y;
  return lamp.s.ellipse ? px * px + py * py <= 1 : std::abs(px) <= 1 && std::abs(py) <= 1;
}
// The area of an area lamp that sends light to x, m^2.
inline float sampled_area(const Lamp& lamp, const Vec3& x) {
  if (lamp.normalize_spread == 0) return lamp.area;
  const float beam = dot(lamp.center - x, lamp.forward) * lamp.tan_half_spread;
  return std::min(lamp.area, std::max(kPi * beam * beam, 1e-30f));
}
// Cosine to the axis z, and turns about it.
inline Vec3 around_axis(const Vec3& x, const Vec3& y, const Vec3& z, float cosine, float turn) {
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const Vec2 around = cos_sin_of_turn(turn);
  return x * (sine * around.x) + y * (sine * around.y) + z * cosine;
}

}  // namespace photon_splat
