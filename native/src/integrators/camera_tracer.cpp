#include "integrators/camera_path.h"

#include <utility>

namespace photon_splat {
namespace {

// What diffuse lobes keep of their chance where photons bring their light: rays share some direct
// light with light samples.
constexpr float kDiffuseShared = 0.5f, kDiffuseLeast = 0.05f;
// A sun and a sky, neither of which may be in sight, are looked at twice from the first vertices of
// a path.
constexpr float kSunny = 0.7f;
constexpr int kSunnyVertices = 2;
// What a denoiser looks through: nothing but lobes up to this roughness, but for a quarter
constexpr float kMirrorRoughness = 0.27f, kMirrorShare = 0.75f;
constexpr float kAsGiven = 1 - 1e-6f;  // cosine from which on a normal is taken for not bent
constexpr int kMaxTransparent = 4096;  // layers that let a path through before it is given up

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
    const auto ray = job.reads_light ? rays.central_ray(time) : rays.ray(sample, time);
    if (ray) {
      Path path(*ray, pixel, tile, index, sample, rays.seed(), time);
      path.max_bounces = job.max_bounces;
      path.leaves_gather_points = job.leaves_gather_points;
      path.learns = learns;
      path.tries_density = trial_ == Trial::kDensity;
      path.place = place;
      path.reads_light = job.reads_light;
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
  if (tries)
    tile.variances.emplace_back(static_cast<float>(all.variance(count)),
                                static_cast<float>(shallow.variance(count)));
  pixel.depth = depth;
  pixel.surface_id = surface_id;
}

void CameraTracer::trace_path(Path& path) const {
  const Media* const media = scene_.media();
  if (media)  // one around the camera that it does not see is none all the way, as in Cycles
    path.media =
        media->seen(media->around(path.origin + path.direction * path.near, path.info.time),
                    ray_mask(path.info));
  follow(path);
}

void CameraTracer::follow(Path& path, Surface hit) const {
  const Media* const media = scene_.media();
  for (;;) {
    ++path.tile.rays;
    path.tile.deep_rays += path.deep;
    const bool found =
        (std::exchange(path.passed_layer, false) &&
         scene_.meets_layer(hit, path.origin, path.direction, ray_mask(path.info),
                            path.info.time)) ||
        scene_.intersect(path.origin, path.direction, path.near, path.far, path.vertex == 0, hit,
                         ray_mask(path.info), path.info.time, path.info.left);
    if (found && media)
      media->meet_touched(hit, path.origin, path.direction, ray_mask(path.info), path.info.time);
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
      if (path.vertex > 0 && path.shows_features) {  // what is mirrored is even there
        path.pixel.albedo += path.features;
        path.pixel.feature_normal += path.mirror_normal;
      }
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
  if (follows_bumps_) bsdf.gather_bumps();
  scene_.shade(hit, wo, path.info, bsdf);
  const bool clear = seen_clearly(path), holdout = clear && scene_.instances[hit.instance].holdout;
  if (!holdout) add_emission(path, hit, bsdf.emission());
  if (path.survives < 1 && path.ends(std::exchange(path.survives, 1.0f))) return false;
  const bool hole = bsdf.holdout() >= 1 || (holdout && is_black(bsdf.transparency()));
  if (path.vertex == 0 && path.shows_normal && !hole) show_first(path, hit, bsdf);
  const bool scatters =
      !holdout && bsdf.scatters() && max_abs(path.throughput + path.world_throughput) > 0;
  if ((path.vertex == 0 || clear) && !holdout) {  // behind glass that the film sees as clear, too
    path.pixel.diffuse_color += bsdf.diffuse_albedo() * path.throughput;
    if (lobe_colors_) {
      const Bsdf::Colors colors = bsdf.colors();
      path.pixel.glossy_color += colors.glossy * path.throughput;
      path.pixel.transmission_color += colors.transmission * path.throughput;
    }
  }
  const Rgb mirrored = path.shows_features && !holdout ? show_features(path, bsdf) : Rgb{};
  if (ambient_distance_ > 0 && path.vertex == 0 && !holdout && !path.through_glass)
    add_ambient_occlusion(path, hit, bsdf);
  // Light is gathered whether the path then stays or not: it has no part in that choice
  const bool body = bsdf.below_count() > 0;
  const bool badly_served = path.badly_served;
  std::optional<Meeting> meeting;
  const bool reads = path.reads_light && scatters && !body && !hit.on_strand();
  path.only_mirrored = reads;
  if (scatters && !body && (!reads || read_light(path, hit, bsdf)))
    meeting = light(path, hit, bsdf);
  if (clear && (holdout || bsdf.holdout() > 0)) {
    const Rgb held = holdout ? Rgb{1, 1, 1} - bsdf.transparency() : Rgb{1, 1, 1} * bsdf.holdout();
    path.pixel.alpha -= average(held * path.emission_throughput);
  }
  const Passing passing = pass_through(path, hit, bsdf);
  if (passing == Passing::kPasses) {
    path.badly_served = badly_served;
    return true;
  }
  if (passing == Passing::kAbsorbed) {
    if (path.vertex == 0 && !path.through_glass) path.pixel.alpha += path.shown;
    return false;
  }
  if (path.vertex == 0 && path.shows_normal && !hole) show_depth(path, hit);
  if (path.shows_features && !holdout) end_features(path, bsdf, mirrored);
  if (path.vertex == 0 && !path.through_glass) path.pixel.alpha += path.shown;
  if (body) return scatters && meet_body(path, hit, bsdf);
  return meeting && go_on(path, hit, bsdf, *meeting);
}

// Light at a surface, and the path's next way; false where it ends.
bool CameraTracer::meet(Path& path, const Surface& hit, Bsdf& bsdf) const {
  const Meeting meeting = light(path, hit, bsdf);
  return go_on(path, hit, bsdf, meeting);
}

// What lights and photons bring to a surface.
CameraTracer::Meeting CameraTracer::light(Path& path, const Surface& hit, Bsdf& bsdf) const {
  Receiver receiver{hit.position, bsdf.transmits() ? Vec3{} : hit.ng, bsdf.has_narrow(),
                    scene_.instances[hit.instance].group};
  if (!brings_all()) receiver.guide = lights_.guide_at(receiver.x, receiver.n);
  // Light samples start where the normal that a displacement has bent sees the light
  Surface bent;
  const Surface* lit = &hit;
  if (scene_.smooth(hit) && dot(bsdf.bent_normal(), hit.ns) < kAsGiven) {
    bent = hit;
    bent.ns = bsdf.bent_normal();
    lit = &bent;
  }
  receiver.ns = lit->ns;
  receiver.bent = scene_.bent(*lit);
  receiver.time = path.info.time;
  receiver.catchers_only = path.info.catchers_only;
  receiver.bounces = static_cast<uint16_t>(path.vertex);
  if (path.vertex < kSunnyVertices && lights_.environment().contrast() > kSunny)
    receiver.world_samples = 2;
  const bool gathers = path.leaves_gather_points && !path.only_mirrored &&
                       path.vertex < path.max_bounces && !is_zero(path.throughput),
             continued = gathers && continues(path, hit, bsdf);
  if (path.leaves_gather_points && bsdf.has_rest()) {
    const bool shares_diffuse =
        lights_.wants_bsdf_ray({receiver.x, receiver.n, false, receiver.group});
    bsdf.prefer_rest(continued || lights_.world_by_paths() || lights_.world_shares() ? 1
                     : shares_diffuse ? kDiffuseShared
                                      : kDiffuseLeast);
  }
  add_direct(path, *lit, bsdf, receiver);
  if (gathers && !hit.on_strand() && (!continued || caustic_photons_))
    leave_gather_points(path, hit, bsdf, continued);
  if (gathers && !hit.on_strand() && !continued && turned_mirrors_)
    look_for_turned_mirrors(path, hit, bsdf);
  return {receiver, continued};
}

// The path's next way from there; false where it ends.
bool CameraTracer::go_on(Path& path, const Surface& hit, const Bsdf& bsdf,
                         const Meeting& meeting) const {
  if (!scatter(path, hit, bsdf, meeting.receiver, meeting.continued)) return false;
  if (lights_.shadow_linked()) add_linked(path);
  return true;
}

// Tells a denoiser what the pixel shows. A mirror or clear glass shows what the path finds from
// there on, as in Cycles: returns the albedo of its sharp lobes then, else nothing.
Rgb CameraTracer::show_features(Path& path, const Bsdf& bsdf) const {
  const Rgb all = bsdf.albedo(), sharp = bsdf.sharp_albedo(kMirrorRoughness);
  if (average(sharp) > kMirrorShare * average(all)) return sharp;
  path.pixel.albedo += path.features * all;
  return {};
}

// Where the path stays at a surface.
void CameraTracer::end_features(Path& path, const Bsdf& bsdf, const Rgb& mirrored) const {
  const Vec3 normal = bsdf.mean_normal();
  if (is_black(mirrored)) {
    path.pixel.feature_normal += normal * path.behind;
    path.shows_features = false;
    return;
  }
  if (is_black(path.mirror_normal)) path.mirror_normal = normal;
  path.features *= mirrored;
}

// The first surface as opaque as that, as Cycles has it: glass that bends nothing is.
void CameraTracer::show_first(Path& path, const Surface& hit, const Bsdf& bsdf) const {
  const float through = average(bsdf.transparency() - bsdf.straight());
  if (through > 0 && 1 - through < camera_.settings().alpha_threshold) return;
  path.pixel.normal += bsdf.mean_normal() * path.behind;
  show_depth(path, hit);
  path.shows_normal = false;
}

// Of that surface, or of one that lets more through where the path ends at it, as in Cycles.
void CameraTracer::show_depth(Path& path, const Surface& hit) const {
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
  if (scene_.media() && passes_below(hit, direction))
    scene_.media()->cross(media, hit, gap_beside(hit, direction), path.info.time);
  Random random = path.random;  // the path goes on as if nobody had looked
  const Rgb stays = Rgb{1, 1, 1} - (bsdf.transparency() - bsdf.straight());
  const Vec3 origin = shadow_origin(hit, direction, path, ray_offset(hit));
  const Rgb open =
      transmittance(origin, direction, ambient_distance_, path.info, ~uint64_t{0}, media, random);
  ++path.tile.rays;
  add_finite(path.pixel.ambient_occlusion, path.throughput * stays * open, path.tile.bad_samples);
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
  if (++path.info.transparent_depth > kMaxTransparent || path.ends(survival))
    return Passing::kAbsorbed;
  path.near = past(hit);
  path.passed_layer = scene_.instances[hit.instance].layered;
  if (scene_.media())
    scene_.media()->cross(path.media, hit, gap_at(hit, path.origin, path.direction),
                          path.info.time);
  if (!is_black(bsdf.straight())) pass_glass(path);
  return Passing::kPasses;
}

// What lies behind is seen by a ray of transmission: lamps that hide from the camera show.
void CameraTracer::pass_glass(Path& path) const {
  path.info.kind = RayInfo::kTransmission;
  path.info.singular = true;
  ++path.info.depth;
  ++path.info.transmission_depth;
  if (path.vertex > 0 || path.through_glass) return;
  path.through_glass = true;
  path.from = {path.origin, {}, true};
  path.from.time = path.info.time;
  path.from.ray = path.from.diffuse_ray = lobe_rays(false, true);
  path.pixel.alpha += path.shown;
}

}  // namespace photon_splat
