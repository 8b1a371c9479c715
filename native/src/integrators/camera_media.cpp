// Camera paths in media: they scatter there as they do on surfaces, and see lamps, surfaces and the
// world through them.
#include "integrators/camera_path.h"

namespace photon_splat {
namespace {

constexpr float kThinAims = 0.4f;  // more than half of samples that go where lamps are, at most

}  // namespace

void CameraTracer::add_emission_of_media(Path& path, const Rgb& emission) const {
  if (is_black(emission)) return;
  const Rgb kept = path.emission_throughput;  // photons bring nothing of this light
  path.emission_throughput = kept + path.withheld + path.world_emission;
  add_met(path, emission, path.pixel.emission,
          path.groups ? scene_.media()->light_group_of(path.media) : kNoLightGroup);
  path.emission_throughput = kept;
}

// A path's way to what its ray has found, `hit` (or nothing), through the media around it.
CameraTracer::InMedium CameraTracer::pass_media(Path& path, const Surface* hit, float far) const {
  const Rgb throughput = path.throughput + path.world_throughput;
  add_beams(path, far);
  const bool single = add_single_scattering(path, far);
  if (path.vertex == 0 && far > path.near && !scene_.has_catchers())
    if (const auto medium =
            scene_.media()->homogeneous(scene_.media()->seen(path.media, ray_mask(path.info)));
        medium && !is_black(medium->scattering))
      return split_in_medium(path, *medium, hit, far, single);
  const Flight flight = scene_.media()->fly(
      scene_.media()->seen(path.media, ray_mask(path.info)), path.origin, path.direction, path.near,
      far, throughput, path.emission_throughput + path.withheld + path.world_emission, path.info,
      path.flight());
  add_emission_of_media(path, flight.emission);
  path.scale(flight.weight);
  if (!path.is_sound()) return InMedium::kAbsorbed;
  const bool first = path.vertex == 0 && !path.through_glass;
  if (!flight.scatters) {
    if (max_abs(path.emission_throughput + path.withheld + path.world_emission) > 0)
      return InMedium::kNothing;
    if (first) path.pixel.alpha += 1;
    return InMedium::kAbsorbed;
  }
  if (first) {
    path.pixel.alpha += 1;
    if (hit && path.shows_normal) show_depth_behind(path, *hit);
  }
  if (path.shows_features) {
    path.pixel.albedo += path.features * flight.point.scattering;
    path.shows_features = false;
  }
  return scatter_in_medium(path, flight, !single) ? InMedium::kScattered : InMedium::kAbsorbed;
}

// Where a medium is the same everywhere, what is behind it shows in all samples, as much as it lets
// through; another path shows what it scatters.
CameraTracer::InMedium CameraTracer::split_in_medium(Path& path, const MediumPoint& medium,
                                                     const Surface* hit, float far,
                                                     bool single) const {
  const StraightWay way =
      Media::straight_way(medium, far - path.near, path.throughput + path.world_throughput);
  add_emission_of_media(path, way.emission);
  const bool first = path.vertex == 0 && !path.through_glass;
  const bool opaque = hit && !scene_.may_be_transparent(*hit);
  if (first) {
    const float part = opaque ? 1 : 1 - average(way.through);
    path.pixel.alpha += path.shown * part;
    path.shown *= 1 - part;
  }
  FlightNumbers numbers = path.flight();
  const float chance = dot(way.chance, way.scatters);
  if (numbers.decide(chance)) {
    Path part = path;
    part.shows_normal = false;
    part.take_numbers_of_exit();
    part.random = Random(path.random.state(), 1);
    const Flight flight =
        Media::scatter_on(way, medium, path.near, far, FlightNumbers(part.random));
    part.scale(flight.weight / chance);
    if (part.shows_features) part.pixel.albedo += part.features * medium.scattering;
    part.shows_features = false;
    if (part.is_sound() && scatter_in_medium(part, flight, !single)) {
      if (lights_.shadow_linked()) add_linked(part);
      follow(part);
    }
  }
  path.scale(way.through);
  path.behind *= 1 - chance;
  const float left = max_abs(path.emission_throughput + path.withheld + path.world_emission);
  const float survival = path.survival(left);
  if (left > 0 && !path.ends(survival)) {
    path.shown /= survival;
    path.behind /= survival;
    return InMedium::kNothing;
  }
  if (hit && path.shows_normal) show_depth_behind(path, *hit);
  return InMedium::kAbsorbed;
}

// Media have no depth: the pixel shows that of the first thing behind, from `hit` on, which stops
// all light.
void CameraTracer::show_depth_behind(Path& path, Surface hit) const {
  constexpr int kMostLayers = 64;
  for (int layer = 0; layer < kMostLayers; ++layer) {
    if (!scene_.may_be_transparent(hit)) return show_depth(path, hit);
    if (!scene_.intersect_past(hit, path.origin, path.direction, path.far, true,
                               ray_mask(path.info), path.info.time))
      return;
  }
}

// Light samples of a medium that is the same everywhere: scattered at a place of its own on each
// way, whether the path scatters there or not. False where the path's own scattering is left to
// take them.
bool CameraTracer::add_single_scattering(Path& path, float far) const {
  const auto medium =
      scene_.media()->homogeneous(scene_.media()->seen(path.media, ray_mask(path.info)));
  if (!medium || is_black(medium->scattering)) return medium.has_value();
  const float near = path.near, extinction = average(medium->extinction()),
              inside = std::isfinite(far) ? -std::expm1(-extinction * (far - near)) : 1;
  if (!(far > near) || !(inside > 0) || is_zero(path.throughput + path.world_throughput))
    return true;
  const Vec2 how = path.numbers(kMediumPair), where = path.numbers(kMediumPlacePair);
  // Thin media scatter all along the ray, but light of near lamps alone comes from near them.
  const float aims =
      lights_.all_near() ? 0.5f + kThinAims * std::exp(-extinction * (far - near)) : 0.5f;
  float distance;
  std::optional<float> by_lights;
  if (const auto aimed = how.x < aims ? lights_.sample_along(path.origin, path.direction, near, far,
                                                             how.y, where.x)
                                      : std::nullopt) {
    distance = aimed->distance;
    by_lights = aimed->pdf;
  } else {
    distance = near - std::log1p(-where.x * inside) / extinction;
    by_lights = lights_.pdf_along(path.origin, path.direction, near, far, distance);
  }
  const float t = distance - near;
  const float by_extinction = extinction * std::exp(-extinction * t) / inside;
  const float pdf = by_lights ? aims * *by_lights + (1 - aims) * by_extinction : by_extinction;
  if (!(t >= 0) || !(distance <= far) || !(pdf > 0) || !std::isfinite(pdf)) return true;
  const Rgb all = medium->extinction();
  const Rgb through{std::exp(-all.x * t), std::exp(-all.y * t), std::exp(-all.z * t)};
  Receiver receiver{path.origin + path.direction * distance, {}, true};
  receiver.bounces = static_cast<uint16_t>(path.vertex);
  receiver.time = path.info.time;
  receiver.catchers_only = path.info.catchers_only;
  const Rgb throughput = path.throughput, world = path.world_throughput;
  path.throughput = throughput * through / pdf;
  path.world_throughput = world * through / pdf;
  add_direct_in_medium(path, *medium, receiver);
  path.throughput = throughput;
  path.world_throughput = world;
  return true;
}

// What scatters at a point of a medium: light of lamps, and the path's own next way. False where it
// ends.
bool CameraTracer::scatter_in_medium(Path& path, const Flight& flight, bool direct) const {
  const MediumPoint& point = flight.point;
  const Vec3 x = path.origin + path.direction * flight.distance;
  Receiver receiver{x, {}, true};
  receiver.bounces = static_cast<uint16_t>(path.vertex);
  receiver.time = path.info.time;
  receiver.catchers_only = path.info.catchers_only;
  path.covered = path.withheld = path.diffuse_emission = {};
  path.covered_diffuse = path.withheld_diffuse = {};
  if (direct) add_direct_in_medium(path, point, receiver);

  const Vec2 choice = path.numbers(kLobePair), way = path.way();
  const Vec3 direction = point.sample(path.direction, choice.x, way);
  float pdf;
  const Rgb scattered = point.evaluate(path.direction, direction, &pdf);
  if (!(pdf > 0)) return false;
  const Rgb weight = scattered / pdf, before = path.throughput,
            world_before = path.world_throughput;
  const bool last = path.vertex >= path.max_bounces;
  path.emission_throughput = before * weight;
  const bool all_by_beams = beams_bring_all(path);
  if (beams_.caustic && !all_by_beams && sees_beams(path)) {
    path.covered = before * weight;
    path.covered_diffuse = path.vertex == 0 ? Rgb{} : path.covered * path.diffuse_part;
  }
  path.throughput = last || all_by_beams ? Rgb{} : before * weight;
  path.world_emission = world_before * weight;
  path.world_throughput = last || !lights_.world_by_paths()
                              ? Rgb{}
                              : (before + world_before) * weight - path.throughput;
  const float strength = max_abs(path.emission_throughput + path.world_emission);
  const float survival = path.survival(strength);
  if (!is_finite(path.emission_throughput) || !is_finite(path.world_emission)) {
    ++path.tile.bad_samples;
    return false;
  }
  if (path.ends(survival)) return false;
  if (path.vertex == 0) {
    path.category = path.beside = LobeCategory::kVolume;
    path.diffuse_part = {};
  }
  if (lights_.environment().asks_ray()) path.before = path.info;
  path.clear = false;
  path.info = path.info.scattered_in_medium();
  path.travelled += flight.distance;
  path.origin = x;
  path.direction = direction;
  path.near = 0;
  path.far = INFINITY;
  path.from = receiver;
  path.from.ray = static_cast<uint8_t>(ray_bit(RayInfo::kVolume));
  path.from.ray_pdf = pdf;
  path.pdf = pdf;
  path.deep = path.is_beyond();  // what it meets next is direct light of this place
  path.after_medium |= scene_.media()->homogeneous(path.media).has_value();
  ++path.gather_bounces;  // what it meets then is seen blurred
  ++path.vertex;
  return true;
}

void CameraTracer::add_direct_in_medium(Path& path, const MediumPoint& point,
                                        const Receiver& receiver) const {
  path.info.left = 0;
  const Vec2 choice = path.numbers(kChoicePair), place = path.numbers(kLightPair);
  if (const auto light = lights_.sample(receiver, choice.x, place))
    add_light_in_medium(path, point, receiver, *light);
}

void CameraTracer::add_light_in_medium(Path& path, const MediumPoint& point,
                                       const Receiver& receiver, const LightSample& light) const {
  if (!(light.seen_by & ray_bit(RayInfo::kVolume))) return;
  float pdf;
  Rgb scattered = point.evaluate(path.direction, light.direction, &pdf);
  scattered *= light.from_world ? path.throughput + path.world_throughput : path.throughput;
  if (!(max_abs(scattered) > 0)) return;
  ++path.tile.rays;
  path.tile.deep_rays += path.is_beyond();
  if (light.exact >= 0 &&
      lights_.blocked_exactly(static_cast<uint32_t>(light.exact), receiver.x, light.place,
                              receiver.time, exact_blockers(path.info)))
    return;
  const float far = std::isfinite(light.distance)
                        ? light.distance - 2 * ray_epsilon(receiver.x, light.distance)
                        : INFINITY;
  Rgb arriving = light.weight;
  if (far > 0)
    arriving *= transmittance(receiver.x, light.direction, far, path.info, light.blockers,
                              path.media, path.random);
  if (light.from_world && lights_.world_shares())
    arriving *= 1 - lights_.ray_share_of_world(light.direction, pdf);
  else if (light.use_mis)
    arriving *= light.pdf * light.pdf / (light.pdf * light.pdf + pdf * pdf);
  if (light.from_world && lights_.environment().asks_ray())
    arriving *= lights_.environment().share(light.direction, path.info.scattered_in_medium());
  if (path.is_beyond()) see_deep(path, arriving * scattered);
  if (path.groups) GroupLight{path.groups, scattered}.add(arriving, light.light_group);
  if (path.vertex == 0)
    add_finite(path.pixel.volume_direct, arriving * scattered, path.tile.bad_samples);
  else
    add_indirect(path, arriving * scattered, path.diffuse_part);
}

}  // namespace photon_splat
