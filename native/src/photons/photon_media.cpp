// Photons in media: they scatter there as they do on surfaces, or fade on their way.
#include "photons/photon_tracer.h"

namespace photon_splat {

// Light of suns and of the world has come a long way through a medium that fills the world.
bool PhotonTracer::start_in_media(Path& path, const PhotonStart& start) const {
  path.media = scene_.media()->around(start.origin, path.time);
  if (!start.from_afar || scene_.world_volume < 0) return true;
  RayInfo ray;
  ray.kind = RayInfo::kShadow;
  ray.time = path.time;
  path.power *= scene_.media()->transmittance(path.media, start.origin, -start.direction, 0,
                                              INFINITY, ray, path.random);
  return !is_black(path.power);
}

// The way of a path up to the next surface, `far` off. Caustic light is what scatters nowhere on
// it; beams bring what does.
PhotonTracer::InMedium PhotonTracer::pass_media(Path& path, float far, const PhotonStart& start,
                                                const Draws& draws, Vec3& origin,
                                                Vec3& direction) const {
  if (path.media.empty()) return InMedium::kPasses;
  const Media& media = *scene_.media();
  const MediumStack around = media.seen(path.media, ray_bit(kind_of_way(path, path.bounces)));
  if (around.empty()) return InMedium::kPasses;
  RayInfo ray;
  ray.kind = RayInfo::kShadow;
  ray.time = path.time;
  Flight flight;
  if (scatters_in_media()) {
    // Light of a lamp that faces its receivers starts where it passes the lamp's centre.
    const float near = path.bounces == 0 ? std::max(start.soft_nearest - path.travelled, 0.0f) : 0;
    flight =
        media.fly(around, origin, direction, near, far, path.power, path.power, ray, path.random);
  } else {
    flight.weight = media.transmittance(around, origin, direction, 0, far, ray, path.random);
  }
  path.power *= flight.weight;
  if (is_black(path.power) || !is_finite(path.power)) return InMedium::kEnds;
  if (!flight.scatters) return InMedium::kPasses;
  return scatter_in_medium(path, around, flight, start, draws, origin, direction)
             ? InMedium::kScattered
             : InMedium::kEnds;
}

// Transmittance before the point of the path that is nearest to the centre of a lamp that faces its
// receivers: `distance` from where the path starts, a receiver sees the light leave the disc
// PhotonStart::before_nearest() before that.
Rgb PhotonTracer::transmittance_at_lamp(Path& path, float distance,
                                        const PhotonStart& start) const {
  const float before = start.before_nearest(distance);
  if (!(before > 0)) return {1, 1, 1};
  RayInfo ray;
  ray.kind = RayInfo::kShadow;
  ray.time = path.time;
  const Vec3 nearest = start.origin + start.direction * start.soft_nearest;
  const MediumStack around = scene_.media()->around(nearest, path.time);
  return scene_.media()->transmittance(scene_.media()->seen(around, ray_bit(ray.kind)), nearest,
                                       -start.direction, 0, before, ray, path.random);
}

// In one of the media that it has flown through; false where the path ends.
bool PhotonTracer::scatter_in_medium(Path& path, const MediumStack& around, const Flight& flight,
                                     const PhotonStart& start, const Draws& draws, Vec3& origin,
                                     Vec3& direction) const {
  const bool direct = path.bounces == 0;
  if (path.bounces == max_bounces_ || path.bounces >= start.max_bounces ||
      !scatters_for(start, path, ray_bit(RayInfo::kVolume)))
    return false;
  if (path.guessed && path.kind != (straight(path, start) ? RayInfo::kShadow : RayInfo::kVolume))
    return false;
  const Vec3 place = origin + direction * flight.distance;
  const float distance = path.travelled + flight.distance;
  if (direct && !arrives(path, place, distance, start)) return false;
  if (!light_up(path, place, distance, start)) return false;
  if (direct && start.asks_ray) {
    const Rgb share =
        lights_.environment().share(-start.direction, RayInfo{}.scattered_in_medium());
    path.power *= share;
    path.reference *= max_component(share);
  }
  const float choice = path.random.next();
  const Vec2 u = draws.next(path);
  const bool guesses = scene_.kinds_differ();
  float chance = 1;
  const RayInfo::Kind seen_by =
      guesses ? guess_kind(path.random, RayInfo::kDiffuse, &chance) : RayInfo::kDiffuse;
  // Of the media there those scatter that the ray sees which looks back from where the path goes
  MediumPoint point = flight.point;
  if (scene_.media()->hides()) {
    const MediumStack back = scene_.media()->seen(around, ray_bit(seen_by));
    if (back.empty()) return false;
    RayInfo ray;
    ray.kind = seen_by;
    ray.time = path.time;
    point = scene_.media()->at(back, place, -direction, ray);
  }
  const Vec3 way = point.sample(direction, choice, u);
  float pdf;
  const Rgb scattered = point.evaluate(direction, way, &pdf);
  if (!(pdf > 0)) return false;
  path.power *= scattered * (share_of_way(path, start, {place, {}, true}, pdf) / pdf);
  path.kind = seen_by;
  path.guessed = guesses;
  path.power *= 1 / chance;
  float survival = std::min(1.0f, max_abs(path.power) / path.reference);
  if (worth_) survival *= worth_->chance(place, luminance(path.power), total_);
  if (!(survival > 0) || path.random.next() >= survival || !is_finite(path.power)) return false;
  path.power *= 1 / survival;
  path.caustic = 0;
  path.left_normal = PhotonBeam::kInside;
  ++path.bounces;
  path.travelled = 0;
  path.left = 0;
  origin = place;
  direction = way;
  return true;
}

}  // namespace photon_splat
