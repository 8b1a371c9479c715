// What happens to a photon path where it meets a surface with a program.
#include "photons/photon_vertex.h"

namespace photon_splat {
namespace {

// What the first surface may leave of a caustic path before that goes on at less than certainty:
// light that faint reflections throw about comes by many faint photons.
constexpr float kFaint = 1 / 32.0f;

// By which the next vertex of a camera path sees what the photon comes from.
RayInfo::Kind kind_of(const BsdfSample& s) {
  return s.transmitted ? RayInfo::kTransmission : s.diffuse ? RayInfo::kDiffuse : RayInfo::kGlossy;
}

}  // namespace

// Chance that a path which the surface scatters goes below it.
float PhotonTracer::chance_below(const Bsdf& bsdf) const {
  if (bsdf.below_count() == 0 || stream_ == PhotonStream::kCaustic) return 0;
  const float goes = average(bsdf.below_weight()),
              stays = std::max(average(bsdf.albedo()) - goes, 0.0f);
  return bsdf.lobe_count() > 0 ? goes / std::max(goes + stays, 1e-20f) : 1;
}

// Sends the path on below the surface, which it did with that chance; false where it ends.
bool PhotonTracer::scatter_below(Path& path, const Vertex& v, float below, const Draws& draws,
                                 Vec3& origin, Vec3& direction) const {
  // Seen from where it lands it is a diffuse ray
  if (!scatters_for(v.start, path, ray_bit(RayInfo::kDiffuse)) ||
      (path.guessed && path.kind != (v.by_shadow ? RayInfo::kShadow : RayInfo::kDiffuse)) ||
      !light_up_by_ray(path, v.start, {1, 1, 1}, false, false))
    return false;
  const float cosine = std::abs(dot(direction, v.hit.ns));
  path.power *=
      share_of_way(path, v.start, v.receiver(scene_, v.hit.ng, false), cosine * (1 / kPi)) /
      (below * v.chance);
  if (!go_below(path, v.hit, v.bsdf, v.ray, draws, origin, direction)) return false;
  path.kind = v.ray.kind;
  path.guessed = v.told;
  return true;
}

// Whether the light may go that way: its lamp's rays, and the kind of ray guessed where it came
// from, are of the lobe that sends it.
bool PhotonTracer::agrees(const Path& path, const Vertex& v, const BsdfSample& s) const {
  const bool delta = s.pdf <= 0;
  if (v.direct && delta && (!v.start.deltas || path.unshadowed)) return false;
  if (!path.guessed) return true;
  if (path.kind == RayInfo::kShadow) return !delta;
  return (!v.by_shadow || delta || v.start.told_apart >= 0) && kind_of(s) == path.kind;
}

// Of light straight from its lamp the part that goes that way by this kind of path; false where
// that is nothing.
bool PhotonTracer::take_own_share(Path& path, const Vertex& v, const BsdfSample& s) const {
  const PhotonStart& start = v.start;
  if (start.asks_ray || start.seen_by != kAllRays) {
    const float light_pdf = start.of_world ? lights_.world_density(-start.direction) : INFINITY;
    const Rgb diffuse =
                  stream_ == PhotonStream::kCaustic ? Rgb{} : v.bsdf.diffuse_share(s, light_pdf),
              rest = Rgb{1, 1, 1} - diffuse;
    path.power *= (start.seen_by & lobe_rays(true, s.transmitted) ? diffuse : Rgb{}) +
                  (start.seen_by & lobe_rays(false, s.transmitted) ? rest : Rgb{});
    if (!light_up_by_ray(path, start, diffuse, s.transmitted, s.pdf <= 0)) return false;
  }
  if (path.guessed && start.told_apart >= 0 && !s.diffuse && s.pdf > 0) {
    const float by_rays = lights_.ray_share_of_lamp(static_cast<uint32_t>(start.told_apart),
                                                    v.receiver(scene_, {}, true), -start.direction,
                                                    v.bsdf.ray_pdf(s.direction));
    path.power *= path.kind == RayInfo::kShadow ? 1 - by_rays : by_rays;
  }
  if (start.shares_with_rays || path.unshadowed)
    path.power *= share_of_way(
        path, start,
        v.receiver(scene_, v.bsdf.transmits() ? Vec3{} : v.hit.ng, v.bsdf.has_narrow()),
        s.pdf > 0 ? v.bsdf.ray_pdf(s.direction) : INFINITY);
  return true;
}

// Sends the path on as sampled; false where it ends.
bool PhotonTracer::follow(Path& path, const Vertex& v, const BsdfSample& s, Vec3& origin,
                          Vec3& direction) const {
  const bool caustic = stream_ == PhotonStream::kCaustic;
  path.caustic *= s.diffuse ? 0 : sharpness(s.roughness);
  if (caustic && !(path.caustic > 0)) return false;
  path.power *= s.weight / v.chance;
  // Refraction scales power by the square of the relative index and undoes it on the way out: no
  // reason to end a path.
  path.reference *= s.favour;
  if (s.transmitted) path.reference *= std::clamp(max_abs(s.weight) / s.favour, 0.1f, 10.0f);
  if (caustic && v.direct)
    path.reference *= std::clamp(max_abs(path.power) / path.reference, kFaint, 1.0f);
  const float survival = std::min(1.0f, max_abs(path.power) / path.reference);
  if (!(survival > 0) || path.random.next() >= survival || !is_finite(path.power)) return false;
  path.power *= 1 / survival;
  ++path.bounces;
  path.travelled = 0;
  path.kind = v.ray.kind;
  path.guessed = v.told;
  if (scene_.media() && dot(s.direction, v.hit.ng) < 0)
    scene_.media()->cross(path.media, v.hit, gap_beside(v.hit, s.direction), path.time);
  origin = leave(v.hit, s.direction);
  direction = s.direction;
  return true;
}

// A material may ask by what kind of ray it is seen (Light Path). On a camera path that is the ray
// from the photon's next vertex, whose kind says by which lobe the photon will scatter there: not
// known yet. So it is guessed, and the next vertex then stores photons for diffuse rays and
// scatters by lobes of that kind alone. What is passed on the way to the next vertex is seen by the
// same ray; straight from the lamp by a shadow ray, which deltas do not send, or from a delta lobe.
// Ray visibility of objects is the same question. A photon's way from A to B stands for the ray
// from B that finds A, or, from a light, for the shadow ray from B: objects that rays of that kind
// do not see are lit and do not stop it, and A sends it on only if they see A. What B stores stands
// for a diffuse ray from B, and B's lobe on the way to the eye says which kind it was: guessed at A
// where some object treats diffuse, glossy and transmitted rays differently and some surface sends
// others than diffuse ones; else it makes no difference, and diffuse ones are taken. A light that
// some kinds do not see is scattered by the first surface's lobes of the other kinds.
bool PhotonTracer::scatter_by_program(Path& path, const Surface& hit, const PhotonStart& start,
                                      const Draws& draws, const SurfaceFilter& visible,
                                      Vec3& origin, Vec3& direction, Photons& photons) const {
  Vertex v(path, hit, start, direction);
  look_at(path, v);
  const Passing passes = passing(path, v);
  const bool accepted = lit(path, hit, start);
  if (accepted) store(path, hit, direction, visible, photons);

  if (const float mean = average(passes.transparency); mean > 0) {  // straight on, or not
    const float scattered =
        accepted && v.bsdf.scatters() ? std::max(average(v.bsdf.albedo()), 0.05f) : 0;
    const float chance = mean / (mean + scattered);
    if (scattered == 0 || path.random.next() < chance) {
      if (passes.asked) path.kind = passes.ray.kind, path.guessed = true;
      path.unshadowed |= v.direct && !passes.blocking && !start.casts_shadows;
      const Rgb weight = passes.transparency / (chance * passes.chance);
      const auto twin =
          passes.blocking ? layer(path, hit, origin, direction) : seen_twin(path, hit, direction);
      if (twin) {
        if (passes.blocking) path.painted *= passes.transparency;
        path.power *= passes.blocking ? Rgb{1, 1, 1} / (chance * passes.chance) : weight;
        return shade(path, *twin, start, draws, visible, origin, direction, photons);
      }
      return go_straight_on(path, hit, weight, origin);
    }
    path.power *= 1 / (1 - chance);
  }
  path.power *= std::exchange(path.painted, Rgb{1, 1, 1});
  if (!accepted || !(scene_.instances[hit.instance].seen_by & ray_bit(v.ray.kind)) ||
      path.bounces == max_bounces_ || path.bounces >= start.max_bounces || !v.bsdf.scatters() ||
      !light_up(path, hit.position, path.travelled + hit.distance, start))
    return false;
  float choice = path.random.next();
  const float below = chance_below(v.bsdf);
  if (choice < below) return scatter_below(path, v, below, draws, origin, direction);
  choice = (choice - below) / (1 - below);
  path.power *= 1 / (1 - below);
  const auto s = sample(path, v, choice, draws.next(path));
  return s && agrees(path, v, *s) && (!v.direct || take_own_share(path, v, *s)) &&
         follow(path, v, *s, origin, direction);
}

}  // namespace photon_splat
