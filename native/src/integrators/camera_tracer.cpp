#include "integrators/camera_path.h"

namespace photon_splat {
namespace {

// What diffuse lobes keep of their chance where photons bring their light: rays share some direct
// light with light samples.
constexpr float kDiffuseShared = 0.5f, kDiffuseLeast = 0.05f;
// A sun and a sky, neither of which may be in sight, are looked at twice from the first vertices of
// a path.
constexpr float kSunny = 0.7f;
constexpr int kSunnyVertices = 2;
// Light samples of the first vertex where paths bring all light: their places are shaded already
constexpr int kFirstLights = 2;
constexpr float kBrightest = 20;       // times the world's mean: a sighting counts at most as much
constexpr int kMaxTransparent = 4096;  // layers that let a path through before it is given up

struct Moments {
  double sum = 0, squares = 0;
  void add(double x) { sum += x, squares += x * x; }
  float variance(uint32_t count) const {
    if (count < 2) return 0;
    return static_cast<float>(std::max(squares - sum * sum / count, 0.0) / (count - 1));
  }
};

// Leaves of what lobes scatter that of those whose rays see the light.
void keep_seen(const LightSample& light, const Surface& hit, Rgb& scattered, Rgb& diffuse,
               float& sharp) {
  const Rgb rest = scattered - diffuse;
  const bool through = dot(light.direction, hit.ng) < 0;
  const bool keeps_rest =
      light.seen_by & ray_bit(through ? RayInfo::kTransmission : RayInfo::kGlossy);
  const float before = average(scattered);
  if (!(light.seen_by & ray_bit(RayInfo::kDiffuse))) diffuse = {};
  scattered = diffuse + (keeps_rest ? rest : Rgb{});
  const float after = average(scattered);
  sharp = keeps_rest && after > 0 ? std::min(sharp * before / after, 1.0f) : 0;  // of what is left
}

}  // namespace

void CameraTracer::trace_pixel(const Job& job, int x, int y, PackedFilm& film, Pixel& pixel,
                               Tile& tile) const {
  const uint32_t index = static_cast<uint32_t>(y) * film.width + x;
  Rgb* const groups = film.groups_of(index);
  const PixelRays rays(scene_, camera_, x, y, seed_);
  const bool learns = job.learns && hash_combine(rays.seed(), job.pass) % job.learning_share == 0;
  const uint32_t first = job.choice ? job.choice->first(index, job.pass) : job.pass;
  const uint32_t count = job.choice ? job.choice->count(index) : 1;
  float depth = kBackgroundDepth, surface_id = 0;
  pixel = {};
  std::fill_n(groups, film.light_groups, Rgb{});
  pixel.samples = static_cast<float>(count);
  Moments all, shallow;  // of a trial
  const bool tries = trial_ == Trial::kDensity;
  const size_t place =
      static_cast<size_t>(y % kTileSize) * kTileSize + static_cast<size_t>(x % kTileSize);
  for (uint32_t sample = first; sample < first + count; ++sample) {
    const float light_before = tries ? luminance(pixel.combined()) : 0,
                deep_before = tries ? tile.deep[place] : 0;
    pixel.depth = kBackgroundDepth;
    pixel.surface_id = 0;
    const float time = rays.time(sample);
    const auto ray = rays.ray(sample, time);
    if (ray) {
      Path path(*ray, pixel, tile, index, sample, rays.seed(), time);
      path.max_bounces = job.max_bounces;
      path.leaves_gather_points = job.leaves_gather_points;
      path.learns = learns;
      path.tries_density = trial_ == Trial::kDensity;
      path.place = place;
      path.groups = groups;
      trace_path(path);
    } else {  // outside the lens' image: black, not transparent
      pixel.alpha += 1;
    }
    if (sample == first) {
      depth = pixel.depth;
      surface_id = pixel.surface_id;
    }
    if (tries) {
      const float light = luminance(pixel.combined()) - light_before;
      all.add(light);
      shallow.add(light - (tile.deep[place] - deep_before));
    }
  }
  if (tries) tile.variances.emplace_back(all.variance(count), shallow.variance(count));
  pixel.depth = depth;
  pixel.surface_id = surface_id;
}

void CameraTracer::trace_path(Path& path) const {
  const Media* const media = scene_.media();
  if (media) path.media = media->around(path.origin + path.direction * path.near, path.info.time);
  follow(path);
}

void CameraTracer::follow(Path& path) const {
  const Media* const media = scene_.media();
  for (;;) {
    Surface hit;
    ++path.tile.rays;
    path.tile.deep_rays += path.deep;
    const bool found =
        scene_.intersect(path.origin, path.direction, path.near, path.far, path.vertex == 0, hit,
                         ray_mask(path.info), path.info.time, path.info.left);
    add_lamps(path, found ? hit.distance : path.far >= 1e30f ? INFINITY : path.far);
    if (found && path.vertex > 0 && path.info.transparent_depth == 0)
      see_world(path, path.from, path.direction, {}, true);
    if (media && !path.media.empty()) {
      const InMedium met =
          pass_media(path, found ? &hit : nullptr, found ? hit.distance : INFINITY);
      if (met == InMedium::kAbsorbed) return;
      if (met == InMedium::kScattered) {
        if (lights_.shadow_linked()) add_linked(path);
        continue;
      }
    }
    if (!found) {
      add_world(path);
      return;
    }
    if (scene_.has_catchers() && catches(path, hit)) return catch_shadows(path, hit);
    if (!meet_surface(path, hit)) return;
  }
}

// A surface that the path has come to; false where it ends.
bool CameraTracer::meet_surface(Path& path, const Surface& hit) const {
  const Vec3 wo = -path.direction;
  path.info.length = hit.distance;
  path.info.left = hit.mark;
  path.info.footprint = camera_.footprint_at(path.ray, path.travelled + hit.distance);
  Bsdf bsdf(Transport::kRadiance, wo, hit.ng, hit.ns, hit.back);
  if (scene_.features() & kProgramSubsurface && !hit.on_strand())
    bsdf.keep_subsurface(path.info.after_diffuse ? SubsurfaceUse::kWalks : SubsurfaceUse::kAll);
  scene_.shade(hit, wo, path.info, bsdf);
  const bool holdout = path.vertex == 0 && scene_.instances[hit.instance].holdout;
  if (!holdout) add_emission(path, hit, bsdf.emission());
  if (path.vertex == 0 && path.info.transparent_depth == 0) path.pixel.normal += bsdf.mean_normal();
  const bool scatters =
      !holdout && bsdf.scatters() && max_abs(path.throughput + path.world_throughput) > 0;
  if (path.vertex == 0 && !holdout) {
    path.pixel.diffuse_color += bsdf.diffuse_albedo() * path.throughput;
    path.pixel.albedo += bsdf.albedo() * path.throughput;
  }
  if (ambient_distance_ > 0 && path.vertex == 0 && !holdout && !path.through_glass)
    add_ambient_occlusion(path, hit, bsdf);
  // Light is gathered whether the path then stays or not: it has no part in that choice
  const bool body = bsdf.below_count() > 0;
  const bool badly_served = path.badly_served;
  std::optional<Meeting> meeting;
  if (scatters && !body) meeting = light(path, hit, bsdf);
  const Passing passing = pass_through(path, hit, bsdf);
  if (passing == Passing::kPasses) {
    path.badly_served = badly_served;
    return true;
  }
  if (passing == Passing::kAbsorbed) {
    if (path.vertex == 0 && !path.through_glass) path.pixel.alpha += 1;
    return false;
  }
  if (path.vertex == 0 && !holdout && !path.through_glass)
    show_first(path, hit, 1 - bsdf.holdout());
  return scatters && (body ? meet_body(path, hit, bsdf) : go_on(path, hit, bsdf, *meeting));
}

// Light at a surface, and the path's next way; false where it ends.
bool CameraTracer::meet(Path& path, const Surface& hit, Bsdf& bsdf) const {
  const Meeting meeting = light(path, hit, bsdf);
  return go_on(path, hit, bsdf, meeting);
}

// What lights and photons bring to a surface.
CameraTracer::Meeting CameraTracer::light(Path& path, const Surface& hit, Bsdf& bsdf) const {
  Receiver receiver{hit.position, bsdf.transmits() ? Vec3{} : hit.ng, bsdf.has_rest(),
                    scene_.instances[hit.instance].group};
  if (!brings_all()) receiver.guide = lights_.guide_at(receiver.x, receiver.n);
  receiver.ns = hit.ns;
  receiver.bent = scene_.bent(hit);
  receiver.time = path.info.time;
  receiver.catchers_only = path.info.catchers_only;
  receiver.bounces = static_cast<uint16_t>(path.vertex);
  if (path.vertex < kSunnyVertices && lights_.environment().contrast() > kSunny)
    receiver.world_samples = 2;
  const bool gathers = path.leaves_gather_points && path.vertex < path.max_bounces &&
                       !is_black(path.throughput),
             continued = gathers && continues(path, hit, bsdf);
  if (path.leaves_gather_points && bsdf.has_rest()) {
    const bool shares_diffuse =
        lights_.wants_bsdf_ray({receiver.x, receiver.n, false, receiver.group});
    bsdf.prefer_rest(continued || lights_.world_by_paths() ? 1
                     : shares_diffuse                      ? kDiffuseShared
                                                           : kDiffuseLeast);
  }
  add_direct(path, hit, bsdf, receiver);
  if (gathers && !hit.on_strand() && (!continued || caustic_photons_))
    leave_gather_points(path, hit, bsdf, continued);
  return {receiver, continued};
}

// The path's next way from there; false where it ends.
bool CameraTracer::go_on(Path& path, const Surface& hit, const Bsdf& bsdf,
                         const Meeting& meeting) const {
  if (!scatter(path, hit, bsdf, meeting.receiver, meeting.continued)) return false;
  if (lights_.shadow_linked()) add_linked(path);
  return true;
}

void CameraTracer::show_first(Path& path, const Surface& hit, float alpha) const {
  path.pixel.alpha += alpha;
  path.pixel.depth = hit.distance * path.ray.cosine;
  path.pixel.surface_id = static_cast<float>(hit.key & 0xffffff);
}

// Where diffuse lobes look, as a ray of the shadows sees it; of what the surface does not let
// through.
void CameraTracer::add_ambient_occlusion(Path& path, const Surface& hit, const Bsdf& bsdf) const {
  if (bsdf.holdout() >= 1) return;
  const Vec3 direction = Basis(bsdf.mean_diffuse_normal())
                             .to_world(sample_cosine_hemisphere(path.numbers(kAmbientPair)));
  MediumStack media = path.media;
  if (scene_.media() && passes_below(hit, direction)) scene_.media()->cross(media, hit);
  Random random = path.random;  // the path goes on as if nobody had looked
  const Rgb stays = Rgb{1, 1, 1} - (bsdf.transparency() - bsdf.straight());
  const Rgb open = transmittance(shadow_origin(hit, direction, path), direction, ambient_distance_,
                                 path.info, ~uint64_t{0}, media, random);
  ++path.tile.rays;
  add_finite(path.pixel.ambient_occlusion, path.throughput * stays * open, path.tile.bad_samples);
}

// Light that the ray met: emitted, or sent on by the last vertex as direct light, or further on its
// way.
void CameraTracer::add_met(Path& path, const Rgb& radiance, Rgb& seen, int16_t light_group) const {
  const Rgb light = path.emission_throughput * radiance;
  if (path.deep) see_deep(path, light);
  if (path.groups) GroupLight{path.groups, path.emission_throughput}.add(radiance, light_group);
  if (path.vertex == 0) {
    add_finite(seen, light, path.tile.bad_samples);
  } else if (path.vertex == 1) {
    const Rgb diffuse = path.diffuse_emission * radiance;
    add_finite(path.pixel.diffuse_direct, diffuse, path.tile.bad_samples);
    add_finite(direct_of(path.pixel, path.category == LobeCategory::kDiffuse ? LobeCategory::kGlossy
                                                                             : path.category),
               light - diffuse, path.tile.bad_samples);
  } else {
    add_finite(indirect_of(path.pixel, path.category), light, path.tile.bad_samples);
  }
}

void CameraTracer::add_lamps(Path& path, float far) const {
  GroupLight light{path.groups, path.emission_throughput}, *const groups =
                                                               path.groups ? &light : nullptr;
  Attenuation attenuation;
  if (!path.media.empty())
    attenuation = [&](float distance) {
      return scene_.media()->transmittance(path.media, path.origin, path.direction, path.near,
                                           distance, path.info, path.random);
    };
  const Attenuation* const through = attenuation ? &attenuation : nullptr;
  const Rgb radiance =
      path.vertex == 0 && !path.through_glass
          ? lights_.lamps_seen(path.origin, path.direction, path.near, far, path.info.time, groups,
                               through)
          : lights_.lamps_met(path.from, path.direction, path.near, far, path.pdf, groups, through);
  if (!is_black(radiance)) add_met(path, radiance, path.pixel.emission);
}

// Before the ray of a lobe is traced, what it would find behind surfaces that do not block it.
void CameraTracer::add_linked(Path& path) const {
  GroupLight light{path.groups, path.emission_throughput};
  const auto through = [&](float far, uint64_t blockers) {
    return transmittance(path.origin, path.direction, far, path.info, blockers, path.media,
                         path.random);
  };
  const Rgb radiance = lights_.linked_met(path.from, path.origin, path.direction, path.pdf,
                                          path.info, through, path.groups ? &light : nullptr);
  if (!is_black(radiance)) add_met(path, radiance, path.pixel.emission);
}

void CameraTracer::add_world(Path& path) const {
  const bool first = path.vertex == 0 && !path.through_glass;
  if (first) path.pixel.alpha += 1;
  const CameraSettings& film = camera_.settings();
  if (film.transparent && (first || (path.clear && film.transparent_glass >= 0))) {
    path.pixel.alpha -= average(path.emission_throughput);
    return;
  }
  const Rgb light = world_seen(path);
  if (path.vertex > 0) see_world(path, path.from, path.direction, light / path.pdf, true);
  if (path.vertex > 0 && lights_.environment().asks_ray()) return add_world_by_ray(path, light);
  add_met(path, light, path.pixel.environment, scene_.world_light_group);
}

Rgb CameraTracer::world_seen(const Path& path) const {
  const Environment& world = lights_.environment();
  return path.vertex == 0 && world.asks_camera()
             ? world.radiance(path.direction, path.info)
             : lights_.world_met(path.from, path.direction, path.pdf);
}

// The world's light as a ray of each kind sees it. What diffuse lobes sent on this way and what
// others did adds up to all, whichever the ray was drawn by, as for light samples: they and rays
// then share the same light.
void CameraTracer::add_world_by_ray(Path& path, const Rgb& light) const {
  const Environment& world = lights_.environment();
  const bool delta = !(path.pdf < INFINITY), through = path.info.through;
  const auto share = [&](bool diffuse) {
    RayInfo ray = path.before.scattered(diffuse, through, delta);
    ray.transparent_depth = path.info.transparent_depth;
    return world.share(path.direction, ray);
  };
  const Rgb diffuse = is_black(path.diffuse_share) ? Rgb{} : share(true), rest = share(false);
  const Rgb all = path.emission_throughput + path.withheld + path.world_emission;
  const Rgb withheld = lights_.world_by_paths() ? Rgb{} : path.withheld;
  const Rgb kept = path.emission_throughput, kept_diffuse = path.diffuse_emission;
  path.diffuse_emission = path.diffuse_emission * diffuse;
  path.emission_throughput =
      all * (path.diffuse_share * diffuse + (Rgb{1, 1, 1} - path.diffuse_share) * rest) -
      withheld * rest;
  add_met(path, light, path.pixel.environment, scene_.world_light_group);
  path.emission_throughput = kept;
  path.diffuse_emission = kept_diffuse;
}

void CameraTracer::add_emission(Path& path, const Surface& hit, const Rgb& emission) const {
  if (is_black(emission)) return;
  if (hit.on_strand()) return add_strand_emission(path, hit, emission);
  const float weight = path.vertex == 0 ? 1 : lights_.surface_mis_weight(path.from, hit, path.pdf);
  if (weight > 0)
    add_met(path, emission * weight, path.pixel.emission,
            scene_.instances[hit.instance].light_group);
}

// No photons bring it, and no light samples.
void CameraTracer::add_strand_emission(Path& path, const Surface& hit, const Rgb& emission) const {
  const Instance& instance = scene_.instances[hit.instance];
  if (path.vertex > 0 && !(instance.lit_groups & path.from.group)) return;
  const Rgb kept = path.emission_throughput;
  path.emission_throughput += path.withheld;
  add_met(path, emission, path.pixel.emission, instance.light_group);
  path.emission_throughput = kept;
}

// Transparency is no lobe: the path goes straight on, as if nothing had been hit, or it stays and
// scatters.
CameraTracer::Passing CameraTracer::pass_through(Path& path, const Surface& hit,
                                                 const Bsdf& bsdf) const {
  const Rgb transparency = bsdf.transparency();
  const float mean = average(transparency);
  if (!(mean > 0)) return Passing::kStays;
  const float scattered = bsdf.scatters() ? std::max(average(bsdf.albedo()), 0.05f) : 0;
  const float passing = mean / (mean + scattered);
  const bool passes = scattered == 0 || path.passes(passing);
  path.scale(passes ? transparency / passing : Rgb{1, 1, 1} / (1 - passing));
  if (!passes) return Passing::kStays;
  const Rgb emission = path.emission_throughput + path.withheld + path.world_emission;
  const float survival = std::min(1.0f, max_abs(emission) * kRoulette);
  if (++path.info.transparent_depth > kMaxTransparent || path.random.next() >= survival)
    return Passing::kAbsorbed;
  path.scale(Rgb{1, 1, 1} / survival);
  path.near = std::nextafter(hit.distance + ray_epsilon(hit.position, hit.distance), INFINITY);
  if (scene_.media()) scene_.media()->cross(path.media, hit);
  if (!is_black(bsdf.straight())) pass_glass(path, hit);
  return Passing::kPasses;
}

// What lies behind is seen by a ray of transmission: lamps that hide from the camera show.
void CameraTracer::pass_glass(Path& path, const Surface& hit) const {
  path.info.kind = RayInfo::kTransmission;
  path.info.singular = true;
  ++path.info.depth;
  ++path.info.transmission_depth;
  if (path.vertex > 0 || path.through_glass) return;
  path.through_glass = true;
  path.from = {path.origin, {}, true};
  path.from.time = path.info.time;
  show_first(path, hit, 1);
}

void CameraTracer::add_direct(Path& path, const Surface& hit, const Bsdf& bsdf,
                              const Receiver& receiver) const {
  if (path.vertex == 0 && brings_all())
    return bsdf.only_delta() ? void() : add_first_direct(path, hit, bsdf, receiver);
  const Vec2 choice = path.numbers(kChoicePair), place = path.numbers(kLightPair);
  if (bsdf.only_delta()) return;
  if (const auto light = lights_.sample(receiver, choice.x, place))
    add_light(path, hit, bsdf, receiver, *light, false);
  const Vec2 sky = path.numbers(kSkyPair);
  for (uint32_t i = 0; i < receiver.world_samples; ++i)
    if (const auto world = lights_.sample_world(receiver, i, sky))
      add_light(path, hit, bsdf, receiver, *world, true);
}

// Several samples, each with its part of the light.
void CameraTracer::add_first_direct(Path& path, const Surface& hit, const Bsdf& bsdf,
                                    const Receiver& receiver) const {
  const Rgb throughput = path.throughput, covered = path.covered;
  path.throughput = throughput * (1.0f / kFirstLights);
  path.covered = covered * (1.0f / kFirstLights);
  for (uint32_t i = 0; i < kFirstLights; ++i) {
    const uint32_t index = path.sample * kFirstLights + i;
    if (const auto light = lights_.sample(receiver, sobol_2d(index, kChoicePair, path.seed).x,
                                          sobol_2d(index, kLightPair, path.seed)))
      add_light(path, hit, bsdf, receiver, *light, false);
  }
  path.throughput = throughput;
  path.covered = covered;
}

void CameraTracer::see_deep(const Path& path, const Rgb& light) {
  if (!path.tile.deep.empty() && can_be_added(light))
    path.tile.deep[path.place] += luminance(light);
}

// Something that was met on the way to the world or in its direction, for what learns from it.
void CameraTracer::see_world(Path& path, const Receiver& from, const Vec3& direction,
                             const Rgb& light, bool ray) const {
  if (!path.learns || !(path.pdf < INFINITY || !ray)) return;
  const float cosine = is_black(from.n) ? 1 : std::max(0.0f, dot(from.n, direction));
  const float most = kBrightest * luminance(lights_.environment().mean()) * 4 * kPi;
  path.tile.sightings.push_back(
      {from.x, from.n, direction, std::min(luminance(light) * cosine, most), ray});
}

void CameraTracer::add_light(Path& path, const Surface& hit, const Bsdf& bsdf,
                             const Receiver& receiver, const LightSample& light, bool world) const {
  float pdf = 0, sharp = 0;
  Rgb diffuse{};
  const bool any_covered = !is_black(path.covered);
  Rgb scattered =
      receiver.bent
          ? bsdf.evaluate_smooth(light.direction, &pdf, &diffuse, any_covered ? &sharp : nullptr)
          : bsdf.evaluate(light.direction, &pdf, nullptr, &diffuse, any_covered ? &sharp : nullptr);
  if (light.seen_by != kAllRays) keep_seen(light, hit, scattered, diffuse, sharp);
  const Rgb throughput =
      light.from_world ? path.throughput + path.world_throughput : path.throughput;
  if (!(max_abs(throughput * scattered) > 0)) return;
  ++path.tile.rays;
  path.tile.deep_rays += path.is_beyond();
  Rgb arriving = light.weight * light_through(light, hit, path);
  if (light.use_mis) arriving *= light.pdf * light.pdf / (light.pdf * light.pdf + pdf * pdf);
  if (world) {
    see_world(path, receiver, light.direction, arriving, false);
  }
  if (light.from_world && lights_.environment().asks_ray()) {
    const bool through = dot(light.direction, hit.ng) < 0;
    const Rgb seen =
        lights_.environment().share(light.direction, path.info.scattered(true, through, false));
    const Rgb seen_rest = bsdf.has_rest()
                              ? lights_.environment().share(
                                    light.direction, path.info.scattered(false, through, false))
                              : Rgb{};
    const Rgb covered = lights_.world_by_paths() ? Rgb{} : path.covered;
    const Rgb rest = (throughput * (scattered - diffuse) - covered * scattered * sharp) * seen_rest;
    diffuse = throughput * diffuse * seen;
    scattered = diffuse + rest;
  } else {
    arriving *= throughput - path.covered * sharp;
  }
  if (path.is_beyond()) see_deep(path, arriving * scattered);
  if (path.groups) GroupLight{path.groups, scattered}.add(arriving, light.light_group);
  if (path.vertex == 0) {
    const bool through = passes_below(hit, light.direction);
    add_finite(path.pixel.diffuse_direct, arriving * diffuse, path.tile.bad_samples);
    add_finite(direct_of(path.pixel, through ? LobeCategory::kTransmission : LobeCategory::kGlossy),
               arriving * (scattered - diffuse), path.tile.bad_samples);
  } else {
    add_finite(indirect_of(path.pixel, path.category), arriving * scattered, path.tile.bad_samples);
  }
}

// Whether light from there comes through the surface; not where the smooth normal sees it.
bool CameraTracer::passes_below(const Surface& hit, const Vec3& to_light) const {
  if (!(dot(to_light, hit.ng) < 0)) return false;
  return !(scene_.bent(hit) && dot(to_light, hit.ns) > 0);
}

Vec3 CameraTracer::shadow_origin(const Surface& hit, const Vec3& direction,
                                 const Path& path) const {
  if (hit.on_strand()) return hit.position;
  const float epsilon = ray_epsilon(hit.position, hit.distance);
  return scene_.shadow_ray_origin(hit, direction, path.info.time) +
         hit.ng * (passes_below(hit, direction) ? -epsilon : epsilon);
}

// The ray starts off the surface, so it is aimed anew; before an emissive surface it stops as far
// off that one.
Rgb CameraTracer::light_through(const LightSample& light, const Surface& hit, Path& path) const {
  const float epsilon = ray_epsilon(hit.position, hit.distance);
  const bool below = passes_below(hit, light.direction);
  const Vec3 origin = shadow_origin(hit, light.direction, path);
  if (light.exact >= 0 &&
      lights_.blocked_exactly(static_cast<uint32_t>(light.exact), origin, light.place,
                              path.info.time, exact_blockers(path.info)))
    return {};
  MediumStack media = path.media;
  if (scene_.media() && below) scene_.media()->cross(media, hit);
  if (!std::isfinite(light.distance))
    return transmittance(origin, light.direction, INFINITY, path.info, light.blockers, media,
                         path.random);
  const Vec3 target = hit.position + light.direction * light.distance +
                      light.normal * std::max(epsilon, ray_epsilon(hit.position, light.distance));
  const Vec3 way = target - origin;
  const float distance = length(way);
  if (!(distance > 0)) return {1, 1, 1};
  return transmittance(origin, way / distance, distance * (1 - 1e-5f), path.info, light.blockers,
                       media, path.random);
}

Rgb CameraTracer::transmittance(const Vec3& origin, const Vec3& direction, float far,
                                const RayInfo& ray, uint64_t blockers, const MediumStack& media,
                                Random& random) const {
  return scene_.media() ? scene_.transmittance(origin, direction, far, ray, blockers, media, random)
                        : scene_.transmittance(origin, direction, far, ray, blockers);
}

// Where photons on the surface are found.
Vec3 CameraTracer::place_of(const Path& path, const Surface& hit) const {
  return scene_.moves(hit.instance) ? scene_.at_rest(hit, path.info.time).position : hit.position;
}

bool CameraTracer::brings_all() const {
  return strategy_ && strategy_->kind() == IndirectStrategy::Kind::kPathTraced;
}

bool CameraTracer::continues(Path& path, const Surface& hit, const Bsdf& bsdf) const {
  const bool here = !is_black(bsdf.gather());
  if (!here && is_black(bsdf.gather_through())) return false;
  if (follows_motion_ && !scene_.moves(hit.instance) && scene_.moves_near(hit.position))
    return true;
  if (!strategy_) return false;
  if (strategy_->kind() == IndirectStrategy::Kind::kPathTraced) return true;
  if (strategy_->kind() == IndirectStrategy::Kind::kFinalGather && path.gather_bounces == 0)
    return true;
  ++path.tile.places;
  const uint32_t key = here ? hit.key : hit.key ^ 1u;
  if (!(path.badly_served && !strategy_->knows(key)) &&
      !strategy_->at(key, place_of(path, hit), hit.instance, hit.triangle, radius_factor_,
                     path.tile.near))
    return false;
  ++path.tile.continued;
  path.badly_served = true;
  return true;
}

void CameraTracer::leave_gather_points(Path& path, const Surface& hit, const Bsdf& bsdf,
                                       bool caustics_only) const {
  Vec3 position = hit.position, normal = hit.ng;
  if (scene_.moves(hit.instance)) {
    const PlaceAtRest rest = scene_.at_rest(hit, path.info.time);
    position = rest.position;
    normal = rest.ng;
  }
  const auto leave = [&](const Rgb& albedo, uint32_t key, const Vec3& ng) {
    const Rgb throughput = path.throughput * albedo * (1 / kPi);
    if (is_black(throughput)) return;
    if (!is_finite(throughput))
      ++path.tile.bad_samples;
    else
      path.tile.gather_points.push_back({position, key, ng, path.info.footprint, throughput,
                                         path.pixel_index, hit.instance, hit.triangle,
                                         path.category, caustics_only, path.gather_bounces > 0});
  };
  leave(bsdf.gather(), hit.key, normal);
  leave(bsdf.gather_through(), hit.key ^ 1u, -normal);
}

// Sends the path on for light that gather points do not bring; false where it ends.
bool CameraTracer::scatter(Path& path, const Surface& hit, const Bsdf& bsdf,
                           const Receiver& receiver, bool continued) const {
  const bool last = path.vertex >= path.max_bounces,
             whole = !path.leaves_gather_points || continued;
  const bool goes_on = !last && (whole || bsdf.has_rest());
  if (!goes_on && !bsdf.has_rest() && !lights_.wants_bsdf_ray(receiver)) return false;
  const Vec2 lobe = path.numbers(kLobePair), way = path.way();
  const auto s = bsdf.sample(lobe.x, way);
  if (!s) return false;
  Rgb diffuse = s->diffuse ? s->weight : Rgb{};
  if (path.vertex == 0 && bsdf.has_rest() && s->pdf > 0) {
    float pdf;
    bsdf.evaluate(s->direction, &pdf, nullptr, &diffuse);
    diffuse = diffuse / s->pdf;
  }
  if (lights_.environment().asks_ray()) {
    path.before = path.info;
    path.diffuse_share = s->diffuse ? Rgb{1, 1, 1} : Rgb{};
    if (bsdf.has_rest() && s->pdf > 0) {
      float pdf;
      Rgb by_diffuse;
      const Rgb whole_way = bsdf.evaluate(s->direction, &pdf, nullptr, &by_diffuse);
      path.diffuse_share = divided(by_diffuse, whole_way);
    }
  }
  const Rgb before = path.throughput, world_before = path.world_throughput;
  path.throughput = !goes_on ? Rgb{} : whole ? before * s->weight : before * s->rest;
  const Rgb still_covered = s->diffuse ? Rgb{} : path.covered * s->weight * sharpness(s->roughness);
  path.withheld = still_covered;
  path.emission_throughput = before * s->weight - still_covered;
  path.covered = still_covered;
  path.world_emission = world_before * s->weight;
  path.world_throughput = last || !lights_.world_by_paths()
                              ? Rgb{}
                              : (before + world_before) * s->weight - path.throughput;
  path.deep = path.is_beyond();
  path.gather_bounces += continued;
  path.diffuse_bounces += continued && s->diffuse;
  if (continued && caustic_photons_) path.covered += before * (s->weight - s->rest);
  path.diffuse_emission = before * diffuse;
  if (!is_finite(path.emission_throughput) || !is_finite(path.throughput) ||
      !is_finite(path.diffuse_emission) || !is_finite(path.world_throughput) ||
      !is_finite(path.world_emission)) {
    ++path.tile.bad_samples;
    return false;
  }
  const float strength = std::max(max_abs(path.throughput + path.world_throughput),
                                  max_abs(path.emission_throughput + path.world_emission));
  const float worth = path.vertex == 0             ? kFirstRoulette
                      : path.vertex < kSureBounces ? kRoulette
                                                   : 1.2f;
  const float survival = std::min(1.0f, strength * worth);
  if (path.random.next() >= survival) return false;
  path.scale(Rgb{1, 1, 1} / survival);

  if (path.vertex == 0)
    path.category = s->transmitted ? LobeCategory::kTransmission
                    : s->diffuse   ? LobeCategory::kDiffuse
                                   : LobeCategory::kGlossy;
  path.clear &=
      s->transmitted && !s->diffuse && s->roughness <= camera_.settings().transparent_glass;
  path.info = path.info.scattered(s->diffuse, s->transmitted, s->pdf <= 0);
  if (dot(s->direction, hit.ng) < 0 && scene_.media()) scene_.media()->cross(path.media, hit);
  path.travelled += hit.distance;
  path.origin = leave(hit, s->direction);
  path.direction = s->direction;
  path.near = 0;
  path.far = INFINITY;
  path.from = receiver;
  path.from.ray = static_cast<uint8_t>(ray_bit(path.info.kind));
  path.pdf = s->pdf > 0 ? s->pdf : INFINITY;
  ++path.vertex;
  return true;
}

}  // namespace photon_splat
