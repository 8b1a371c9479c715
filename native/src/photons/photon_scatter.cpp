// What happens to a photon path where it meets a surface that is not bounced off with others.
#include "photons/photon_tracer.h"

namespace photon_splat {
namespace {

constexpr int kMaxTransparent = 4096;  // layers that let a path through before it is given up
// What the first surface may leave of a caustic path before that goes on at less than certainty:
// light that faint reflections throw about comes by many faint photons.
constexpr float kFaint = 1 / 32.0f;
constexpr float kSentThrough = 0.25f;  // of photons at glass that one side sends nothing through
constexpr float kGrazing = 0.1f;       // cosine, below which seen_twin() does not look all the way

// By which the next vertex of a camera path sees what the photon comes from.
RayInfo::Kind kind_of(const BsdfSample& s) {
  return s.transmitted ? RayInfo::kTransmission : s.diffuse ? RayInfo::kDiffuse : RayInfo::kGlossy;
}

// Taken for those of deltas.
bool is_sharp(RayInfo::Kind kind) {
  return kind == RayInfo::kGlossy || kind == RayInfo::kTransmission;
}

}  // namespace

// A kind of ray, most often `first`, which is of shadows straight from a lamp alone; *chance: its
// probability. What media scatter is seen by a kind of its own.
RayInfo::Kind PhotonTracer::guess_kind(Random& random, RayInfo::Kind first, float* chance) const {
  const float u = random.next();
  if (first == RayInfo::kDiffuse && scatters_in_media()) {
    *chance = u < 0.4f ? 0.4f : 0.2f;
    return u < 0.4f   ? first
           : u < 0.6f ? RayInfo::kGlossy
           : u < 0.8f ? RayInfo::kTransmission
                      : RayInfo::kVolume;
  }
  *chance = u < 0.5f ? 0.5f : 0.25f;
  return u < 0.5f ? first : u < 0.75f ? RayInfo::kGlossy : RayInfo::kTransmission;
}

// The kind of ray, scattered by a medium or diffusely, that sees the instance, where only one of
// them does.
RayInfo::Kind PhotonTracer::kind_that_sees(uint32_t instance) const {
  return scene_.instances[instance].seen_by & ray_bit(RayInfo::kVolume) ? RayInfo::kVolume
                                                                        : RayInfo::kDiffuse;
}

// Where nothing has asked yet by which of these two the path is looked back along, a surface does
// that only one of them sees.
void PhotonTracer::choose_kind(Path& path, const Surface& hit) const {
  if (path.guessed || path.bounces == 0 || !scatters_in_media() ||
      !scene_.volume_differs(hit.instance))
    return;
  path.kind = path.random.next() < 0.5f ? RayInfo::kVolume : RayInfo::kDiffuse;
  path.guessed = true;
  path.power *= 2;
}

// Guesses, for a path that a surface without a program is about to scatter, by which kind of ray
// that will be seen, where it matters; false where such rays do not see the surface.
bool PhotonTracer::sends_on(Path& path, const Surface& hit) const {
  path.kind = RayInfo::kDiffuse;
  path.guessed = scene_.kinds_differ();
  if (!scene_.limits_rays()) return true;
  if (path.guessed) {
    float chance;
    path.kind = guess_kind(path.random, RayInfo::kDiffuse, &chance);
    path.power *= 1 / chance;
  } else if (scatters_in_media() && scene_.volume_differs(hit.instance)) {
    path.kind = kind_that_sees(hit.instance);
    path.guessed = true;
  }
  return scene_.instances[hit.instance].seen_by & ray_bit(path.kind);
}

bool PhotonTracer::arrives(const Path& path, const Vec3& place, float distance,
                           const PhotonStart& start) const {
  if (start.exact >= 0 &&
      lights_.blocked_exactly(static_cast<uint32_t>(start.exact), place, start.place, path.time))
    return false;
  const float since_lamp = distance - start.soft_nearest;
  if (start.soft_radius2 >= 0 && !(since_lamp >= path.soft_from && since_lamp <= path.soft_to))
    return false;
  return start.accepts(distance);
}

// Whether the surface takes the light: the first one only what its lamp gives it.
bool PhotonTracer::lit(const Path& path, const Surface& hit, const PhotonStart& start) const {
  if (path.bounces > 0) return true;
  return (start.lit_groups & scene_.instances[hit.instance].group) &&
         arrives(path, hit.position + hit.ng * ray_epsilon(hit.position, hit.distance),
                 path.travelled + hit.distance, start);
}

// Light passes what the ray that looks back along its way does not see, and, straight from its
// lamp, what does not block that; it lights those all the same.
bool PhotonTracer::blocks(const Path& path, const Surface& hit, const PhotonStart& start) const {
  if (!(scene_.instances[hit.instance].seen_by & ray_bit(kind_of_way(path, path.bounces))))
    return false;
  return path.bounces > 0 ||
         (start.casts_shadows && start.blockers & scene_.instances[hit.instance].group);
}

// A surface that stands before the point nearest to the centre of a lamp that faces its receivers.
// The nearer of them are lit from before the surface, and it shadows them; those further off are
// lit from behind it. Of a transparent surface either, by chance.
bool PhotonTracer::pass_before_lamp(Path& path, const Surface& hit, const Vec3& direction,
                                    const PhotonStart& start, Vec3& origin) const {
  Rgb weight{1, 1, 1};
  const float before = start.soft_nearest - path.travelled - hit.distance;
  if (blocks(path, hit, start) && before > 0) {
    const float limit = start.soft_miss2 / before;
    Rgb transparency{};
    if (scene_.may_be_transparent(hit)) {
      RayInfo ray;
      ray.kind = RayInfo::kShadow;
      ray.transparent_depth = path.passed;
      ray.time = path.time;
      transparency = scene_.lets_through(hit, direction, ray);
    }
    const bool either = average(transparency) > 0;
    if (either && path.random.next() < 0.5f) {
      path.soft_to = std::min(path.soft_to, limit);
      weight = transparency * 2;
    } else {
      path.soft_from = std::max(path.soft_from, limit);
      if (either) weight = {2, 2, 2};
    }
  }
  path.unshadowed |= !start.casts_shadows;
  return path.soft_from <= path.soft_to && go_straight_on(path, hit, weight, origin);
}

// The surface in which one lies that the path passes unseen, if rays that see along its way meet
// that: going on from there would miss it.
std::optional<Surface> PhotonTracer::seen_twin(const Path& path, const Surface& hit,
                                               const Vec3& direction) const {
  const RayMask kinds = ray_bit(kind_of_way(path, path.bounces));
  if (scene_.instances[hit.instance].seen_by & kinds || hit.on_strand()) return {};
  const float far =
      2 * ray_epsilon(hit.position, hit.distance) / std::max(-dot(direction, hit.ng), kGrazing);
  Surface twin;
  if (!scene_.intersect(leave(hit, hit.ng), direction, 0, far, false, twin, kinds, path.time))
    return {};
  twin.distance = hit.distance;
  return twin;
}

// Sends a path on that a surface lets pass with this weight (its transparency over the chance to
// pass); false where it ends.
bool PhotonTracer::go_straight_on(Path& path, const Surface& hit, const Rgb& weight,
                                  Vec3& origin) const {
  path.power *= weight;
  const float survival = std::min(1.0f, max_abs(path.power) / path.reference);
  if (++path.passed > kMaxTransparent || !(survival > 0) || path.random.next() >= survival)
    return false;
  path.power *= 1 / survival;
  path.travelled += hit.distance;
  if (scene_.media()) scene_.media()->cross(path.media, hit, gap_beside(hit, -hit.ng), path.time);
  origin = leave(hit, -hit.ng);
  return true;
}

// What lands after a bounce is indirect light, or caustic light, or a share of each.
void PhotonTracer::store(const Path& path, const Surface& hit, const Vec3& direction,
                         const SurfaceFilter& visible, Photons& photons) const {
  if (path.bounces == 0 || hit.on_strand() || !visible.contains(hit.key)) return;
  // What is stored stands for a diffuse ray from here
  if (path.guessed && path.kind != receiver_kind_) return;
  const float share = share_of(path.caustic);
  const float cos_shading = -dot(direction, hit.ns), cos_geometric = -dot(direction, hit.ng);
  if (!(share > 0) || cos_shading <= 0 || cos_geometric <= 0) return;
  // Density on the surface measures the geometric cosine; the BSDF wants the shading one (Veach
  // 1997, section 5.3).
  const Rgb power = path.power * (share * cos_shading / cos_geometric);
  if (scene_.moves(hit.instance)) {
    const PlaceAtRest rest = scene_.at_rest(hit, path.time);
    if (!(rest.area > 0) || !is_finite(rest.ng)) return;  // there is nothing of it
    photons.push_back({rest.position, hit.key, encode_direction(rest.ng),
                       encode_direction(rest.turn(-direction)), power * rest.area});
    return;
  }
  photons.push_back(
      {hit.position, hit.key, encode_direction(hit.ng), encode_direction(-direction), power});
}

// Where a path scatters first, its power is known if its lamp has a program; false where that is
// nothing.
bool PhotonTracer::light_up(Path& path, const Vec3& place, float distance,
                            const PhotonStart& start) const {
  if (path.bounces > 0) return true;
  if (scene_.media()) path.power *= transmittance_at_lamp(path, distance, start);
  if (start.shaded_by < 0) return true;
  const Rgb factor = emitter_.first_hit_factor(start, place, distance);
  path.power *= factor;
  path.reference *= max_component(factor);
  return path.reference > 0;
}

// Where a world asks by what ray it is seen: by that of the lobe that scatters its photon first.
// `diffuse`: share of the light that diffuse lobes send that way.
bool PhotonTracer::light_up_by_ray(Path& path, const PhotonStart& start, const Rgb& diffuse,
                                   bool transmitted, bool delta) const {
  if (path.bounces > 0 || !start.asks_ray) return true;
  const auto share = [&](bool by_diffuse) {
    RayInfo ray = Environment::photon_ray(by_diffuse, transmitted, delta);
    ray.transparent_depth = path.passed;
    return lights_.environment().share(-start.direction, ray);
  };
  Rgb factor{};
  if (!is_black(diffuse)) factor += diffuse * share(true);
  if (const Rgb rest = Rgb{1, 1, 1} - diffuse; !is_black(rest)) factor += rest * share(false);
  path.power *= factor;
  path.reference *= max_component(factor);
  return path.reference > 0;
}

// What a surface with two sides scatters of light that comes along `direction`: what goes through
// as a camera path that looks back along that way sees it, as its normals are others from there.
// `ways`: through smooth glass.
std::optional<BsdfSample> PhotonTracer::sample_sided(Path& path, const Surface& hit,
                                                     const Vec3& direction, const RayInfo& ray,
                                                     const Bsdf& bsdf, const Bsdf::SmoothWays& ways,
                                                     float choice, const Vec2& u) const {
  const bool sharp = stream_ == PhotonStream::kCaustic;
  // This side's chance of going through smooth glass may be none where the other side sees some
  const float own = bsdf.smooth_chance(sharp),
              forced = ways.count > 0 && own < kSentThrough ? kSentThrough : 0;
  std::optional<BsdfSample> s;
  bool smooth = forced > 0 && path.random.next() < forced;
  if (!smooth) {
    s = sharp ? bsdf.sample_sharp(choice, u) : bsdf.sample(choice, u);
    if (!s) return {};
    smooth = s->transmitted && s->pdf <= 0;
    s->weight *= 1 / (1 - forced);
    s->per_value *= 1 / (1 - forced);
  }
  if (smooth) {
    if (ways.count == 0) return {};
    const auto number = static_cast<int>(path.random.next() * static_cast<float>(ways.count));
    const Bsdf::SmoothWay& way = ways.ways[std::min(number, ways.count - 1)];
    const float chance = (forced + (1 - forced) * own) / static_cast<float>(ways.count);
    BsdfSample through;
    through.direction = way.to;
    through.transmitted = true;
    through.weight = through.rest =
        seen_from(Scene::other_side(hit), way.to, ray).smooth_share(way.lobe) *
        (way.spread / chance);
    s = through;
  } else if (s->transmitted) {
    s->weight = seen_from(Scene::other_side(hit), s->direction, ray).evaluate(-direction, nullptr) *
                s->per_value;
  }
  if (is_black(s->weight)) return {};
  return s;
}

// The closures of a surface, or of its other side, as a camera path sees them that comes from wo.
Bsdf PhotonTracer::seen_from(const Surface& side, const Vec3& wo, const RayInfo& ray) const {
  Bsdf bsdf(Transport::kRadiance, wo, side.ng, side.ns, side.back);
  if (side.program->features & kProgramSubsurface) bsdf.keep_subsurface(SubsurfaceUse::kWalks);
  scene_.shade(side, wo, ray, bsdf);
  return bsdf;
}

// Stores a photon where one belongs and sends the path on; false where it ends.
bool PhotonTracer::shade(Path& path, const Surface& hit, const PhotonStart& start,
                         const Draws& draws, const SurfaceFilter& visible, Vec3& origin,
                         Vec3& direction, Photons& photons) const {
  path.left = hit.mark;
  choose_kind(path, hit);
  if (path.bounces == 0 && path.travelled + hit.distance < start.soft_nearest)
    return pass_before_lamp(path, hit, direction, start, origin);
  if (hit.program)
    return scatter_by_program(path, hit, start, draws, visible, origin, direction, photons);
  const bool accepted = lit(path, hit, start);
  if (!blocks(path, hit, start)) {  // the light goes on and is scattered: either, by chance
    const bool passes = !accepted || path.random.next() < 0.5f;
    if (accepted) path.power *= 2;
    if (passes) {
      path.unshadowed |= path.bounces == 0 && !start.casts_shadows;
      if (const auto twin = seen_twin(path, hit, direction))
        return shade(path, *twin, start, draws, visible, origin, direction, photons);
      return go_straight_on(path, hit, {1, 1, 1}, origin);
    }
  }
  if (!accepted) return false;
  store(path, hit, direction, visible, photons);
  if (!light_up(path, hit.position, path.travelled + hit.distance, start) ||
      !light_up_by_ray(path, start, {1, 1, 1}, false, false))
    return false;
  const float cos_shading = -dot(direction, hit.ns), cos_geometric = -dot(direction, hit.ng);
  if (cos_shading <= 0 || cos_geometric <= 0) return false;
  if (path.bounces == max_bounces_ || path.bounces >= start.max_bounces ||
      stream_ == PhotonStream::kCaustic)
    return false;
  if (!scatters_for(start, path, ray_bit(RayInfo::kDiffuse))) return false;
  if (path.guessed && path.kind != (straight(path, start) ? RayInfo::kShadow : RayInfo::kDiffuse))
    return false;
  if (!sends_on(path, hit)) return false;
  const Receiver at{hit.position, hit.ng, false, scene_.instances[hit.instance].group};
  path.power *= scene_.albedo(hit) * (cos_shading / cos_geometric *
                                      share_of_way(path, start, at, cos_shading * (1 / kPi)));
  const float survival = std::min(1.0f, max_component(path.power) / path.reference);
  if (!(survival > 0) || path.random.next() >= survival) return false;
  path.power *= 1 / survival;
  origin = leave(hit, hit.ng);
  direction = Basis(hit.ng).to_world(sample_cosine_hemisphere(draws.next(path)));
  ++path.bounces;
  path.caustic = 0;
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
  const bool direct = path.bounces == 0, by_shadow = straight(path, start),
             asked = hit.program->asks_kind || scene_.kinds_differ(),
             decided = !asked && scatters_in_media() && scene_.volume_differs(hit.instance);
  float chance = 1;
  RayInfo ray;
  ray.kind = asked     ? guess_kind(path.random, receiver_kind_, &chance)
             : decided ? kind_that_sees(hit.instance)
                       : receiver_kind_;
  ray.singular = is_sharp(ray.kind);
  ray.depth = path.bounces;
  ray.transparent_depth = path.passed;
  ray.time = path.time;
  // It is seen by way of where the photon goes next: about as far off as where it came from
  if (viewer_) ray.footprint = viewer_->footprint_by_way(hit.position, hit.distance);
  Bsdf bsdf(Transport::kFlux, -direction, hit.ng, hit.ns, hit.back);
  if (hit.program->features & kProgramSubsurface && !hit.on_strand())
    bsdf.keep_subsurface(SubsurfaceUse::kWalks);
  scene_.shade(hit, -direction, ray, bsdf);
  // Who sees the surface from where the light goes may see other closures
  const bool asked_back = hit.program->asks_view && !hit.on_strand() && bsdf.lobe_count() > 0;
  if (asked_back) bsdf.send_back();
  // And so may who sees it from the other side
  const bool sided = (hit.program->asks_side || hit.program->has_own_normals) &&
                     hit.program->features & kProgramTransmits && !hit.on_strand();
  Bsdf::SmoothWays ways;
  if (sided) {
    Bsdf from_there(Transport::kFlux, -direction, hit.ng, hit.ns, hit.back);
    // Seen from where the light is bent to: straight on nothing may shine through
    const Vec3 viewer = bsdf.way_on().value_or(direction);
    const Surface other = Scene::other_side(hit);
    scene_.shade(other, viewer, ray, from_there);
    bsdf.send_through(from_there);
    if (from_there.has_smooth_glass()) ways = seen_from(other, viewer, ray).smooth_ways(-direction);
  }
  const bool blocking = blocks(path, hit, start);
  Rgb transparency = blocking ? bsdf.transparency() : Rgb{1, 1, 1};
  const bool may_pass = blocking && scene_.may_be_transparent(hit),
             passing_asked = may_pass && (by_shadow ? hit.program->asks_shadow : asked);
  RayInfo passing_ray = ray;
  float passing_chance = 1;
  if (passing_asked) {
    passing_ray.kind = path.kind;
    if (!path.guessed)
      passing_ray.kind =
          guess_kind(path.random, by_shadow ? RayInfo::kShadow : receiver_kind_, &passing_chance);
    passing_ray.singular = is_sharp(passing_ray.kind);
  }
  if (passing_asked || (may_pass && hit.program->asks_side))
    transparency = scene_.lets_through(hit, direction, passing_ray);
  const bool accepted = lit(path, hit, start);
  if (accepted) store(path, hit, direction, visible, photons);

  const float mean = average(transparency);
  if (mean > 0) {  // straight on, as if nothing had been hit, or not
    const float scattered =
        accepted && bsdf.scatters() ? std::max(average(bsdf.albedo()), 0.05f) : 0;
    const float passing = mean / (mean + scattered);
    if (scattered == 0 || path.random.next() < passing) {
      if (passing_asked) path.kind = passing_ray.kind, path.guessed = true;
      path.unshadowed |= direct && !blocking && !start.casts_shadows;
      const Rgb weight = transparency / (passing * passing_chance);
      if (!blocking)
        if (const auto twin = seen_twin(path, hit, direction)) {
          path.power *= weight;
          return shade(path, *twin, start, draws, visible, origin, direction, photons);
        }
      return go_straight_on(path, hit, weight, origin);
    }
    path.power *= 1 / (1 - passing);
  }
  if (!(scene_.instances[hit.instance].seen_by & ray_bit(ray.kind))) return false;
  if (!accepted || path.bounces == max_bounces_ || path.bounces >= start.max_bounces ||
      !bsdf.scatters() || !light_up(path, hit.position, path.travelled + hit.distance, start))
    return false;
  float choice = path.random.next();
  const bool caustic = stream_ == PhotonStream::kCaustic;
  if (bsdf.below_count() > 0 && !caustic) {
    const float goes = average(bsdf.below_weight()),
                stays = std::max(average(bsdf.albedo()) - goes, 0.0f);
    const float below = bsdf.lobe_count() > 0 ? goes / std::max(goes + stays, 1e-20f) : 1;
    if (choice < below) {
      // Seen from where it lands it is a diffuse ray
      if (!scatters_for(start, path, ray_bit(RayInfo::kDiffuse)) ||
          (path.guessed && path.kind != (by_shadow ? RayInfo::kShadow : RayInfo::kDiffuse)) ||
          !light_up_by_ray(path, start, {1, 1, 1}, false, false))
        return false;
      const float cosine = std::abs(dot(direction, hit.ns));
      const Receiver at{hit.position, hit.ng, false, scene_.instances[hit.instance].group};
      path.power *= share_of_way(path, start, at, cosine * (1 / kPi)) / (below * chance);
      if (!go_below(path, hit, bsdf, ray, draws, origin, direction)) return false;
      path.kind = ray.kind;
      path.guessed = asked || decided;
      return true;
    }
    choice = (choice - below) / (1 - below);
    path.power *= 1 / (1 - below);
  }
  const Vec2 u = draws.next(path);
  auto s = sided     ? sample_sided(path, hit, direction, ray, bsdf, ways, choice, u)
           : caustic ? bsdf.sample_sharp(choice, u)
                     : bsdf.sample(choice, u);
  if (s && asked_back && !s->transmitted && s->pdf > 0) {
    s->weight = seen_from(hit, s->direction, ray).evaluate(-direction, nullptr) * s->per_value;
    if (is_black(s->weight)) return false;
  }
  // No viewer sees that by the same normal: CameraTracer::look_for_turned_mirrors()
  if (!s || (s->by_turned_normal && hit.program->turns_mirrors)) return false;
  if (direct && s->pdf <= 0 && (!start.deltas || path.unshadowed)) return false;
  if (path.guessed) {
    const bool delta = s->pdf <= 0;
    if (path.kind == RayInfo::kShadow
            ? delta
            : (by_shadow && !delta && start.told_apart < 0) || kind_of(*s) != path.kind)
      return false;
  }
  if (direct && (start.asks_ray || start.seen_by != kAllRays)) {
    const float light_pdf = start.of_world ? lights_.world_density(-start.direction) : INFINITY;
    const Rgb diffuse = caustic ? Rgb{} : bsdf.diffuse_share(*s, light_pdf),
              rest = Rgb{1, 1, 1} - diffuse;
    path.power *= (start.seen_by & lobe_rays(true, s->transmitted) ? diffuse : Rgb{}) +
                  (start.seen_by & lobe_rays(false, s->transmitted) ? rest : Rgb{});
    if (!light_up_by_ray(path, start, diffuse, s->transmitted, s->pdf <= 0)) return false;
  }
  if (direct && path.guessed && start.told_apart >= 0 && !s->diffuse && s->pdf > 0) {
    const float by_rays =
        lights_.ray_share_of_lamp(static_cast<uint32_t>(start.told_apart),
                                  {hit.position, {}, true, scene_.instances[hit.instance].group},
                                  -start.direction, bsdf.ray_pdf(s->direction));
    path.power *= path.kind == RayInfo::kShadow ? 1 - by_rays : by_rays;
  }
  if (direct && (start.shares_with_rays || path.unshadowed)) {
    const Receiver at{hit.position, bsdf.transmits() ? Vec3{} : hit.ng, bsdf.has_rest(),
                      scene_.instances[hit.instance].group};
    path.power *= share_of_way(path, start, at, s->pdf > 0 ? bsdf.ray_pdf(s->direction) : INFINITY);
  }
  path.caustic *= s->diffuse ? 0 : sharpness(s->roughness);
  if (caustic && !(path.caustic > 0)) return false;
  path.power *= s->weight / chance;
  // Refraction scales power by the square of the relative index and undoes it on the way out: no
  // reason to end a path.
  if (s->transmitted) path.reference *= std::clamp(max_abs(s->weight), 0.1f, 10.0f);
  if (caustic && direct)
    path.reference *= std::clamp(max_abs(path.power) / path.reference, kFaint, 1.0f);
  const float survival = std::min(1.0f, max_abs(path.power) / path.reference);
  if (!(survival > 0) || path.random.next() >= survival || !is_finite(path.power)) return false;
  path.power *= 1 / survival;
  ++path.bounces;
  path.travelled = 0;
  path.kind = ray.kind;
  path.guessed = asked || decided;
  if (scene_.media() && dot(s->direction, hit.ng) < 0)
    scene_.media()->cross(path.media, hit, gap_beside(hit, s->direction), path.time);
  origin = leave(hit, s->direction);
  direction = s->direction;
  return true;
}

}  // namespace photon_splat
