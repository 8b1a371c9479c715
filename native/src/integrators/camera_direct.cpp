// Light samples at the surfaces that camera paths meet, and what of them gets there.
#include "integrators/camera_path.h"

namespace photon_splat {
namespace {

// Light samples of the first vertex where paths bring all light: their places are shaded already
constexpr int kFirstLights = 2;
constexpr float kBrightest = 20;  // times the world's mean: a sighting counts at most as much

// Leaves of what lobes scatter that of those whose rays see the light.
void keep_seen(const LightSample& light, bool through, Rgb& scattered, Rgb& diffuse, float& sharp) {
  const Rgb rest = scattered - diffuse;
  const bool keeps_rest = light.seen_by & lobe_rays(false, through);
  const float before = average(scattered);
  if (!(light.seen_by & lobe_rays(true, through))) diffuse = {};
  scattered = diffuse + (keeps_rest ? rest : Rgb{});
  const float after = average(scattered);
  sharp = keeps_rest && after > 0 ? std::min(sharp * before / after, 1.0f) : 0;  // of what is left
}

}  // namespace

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

void CameraTracer::add_light(Path& path, const Surface& hit, const Bsdf& bsdf,
                             const Receiver& receiver, const LightSample& light, bool world) const {
  float pdf = 0, sharp = 0;
  Rgb diffuse{};
  const bool any_covered = !is_zero(path.covered);
  // Cycles has no light samples of a world that is the same everywhere.
  const bool lit = !light.from_world || !lights_.environment().constant();
  Rgb scattered = bsdf.evaluate_light(light.direction, {receiver.bent, lit}, &pdf, &diffuse,
                                      any_covered ? &sharp : nullptr);
  if (light.from_world && lights_.world_asks() && !path.only_mirrored)
    diffuse =
        scattered * bsdf.diffuse_share(light.direction, lights_.world_density(light.direction));
  if (light.seen_by != kAllRays)
    keep_seen(light, passes_below(hit, light.direction), scattered, diffuse, sharp);
  if (path.only_mirrored) {
    scattered = scattered - diffuse;
    diffuse = {};
  }
  const Rgb throughput =
      light.from_world ? path.throughput + path.world_throughput : path.throughput;
  if (!(max_abs(throughput * scattered) > 0)) return;
  ++path.tile.rays;
  path.tile.deep_rays += path.is_beyond();
  Rgb arriving = light.weight * light_through(light, hit, path);
  if (light.from_world && lights_.world_shares())
    arriving *= 1 - lights_.ray_share_of_world(light.direction, bsdf.ray_pdf(light.direction));
  else if (light.use_mis)
    arriving *= light.pdf * light.pdf / (light.pdf * light.pdf + pdf * pdf);
  if (world) {
    see_world(path, receiver, light.direction, arriving, false);
  }
  if (light.from_world && lights_.environment().asks_ray()) {
    const bool through = passes_below(hit, light.direction);
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
    add_indirect(
        path, arriving * scattered,
        path.diffuse_part_of(throughput, path.covered * sharp, path.covered_diffuse * sharp));
  }
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

// Whether light from there comes through the surface; not where the smooth normal sees it.
bool CameraTracer::passes_below(const Surface& hit, const Vec3& to_light) const {
  if (!(dot(to_light, hit.ng) < 0)) return false;
  return !(scene_.bent(hit) && dot(to_light, hit.ns) > 0);
}

Vec3 CameraTracer::shadow_origin(const Surface& hit, const Vec3& direction, const Path& path,
                                 float offset) const {
  if (hit.on_strand()) return hit.position;
  return scene_.shadow_ray_origin(hit, direction, path.info.time) +
         hit.ng * (passes_below(hit, direction) ? -offset : offset);
}

// The ray starts off the surface, so it is aimed anew; before an emissive surface it stops as far
// off that one.
Rgb CameraTracer::light_through(const LightSample& light, const Surface& hit, Path& path) const {
  const float epsilon = std::max(ray_epsilon(hit.position, hit.distance), hit.rounding);
  const bool below = passes_below(hit, light.direction);
  if (light.exact >= 0 &&
      lights_.blocked_exactly(static_cast<uint32_t>(light.exact),
                              shadow_origin(hit, light.direction, path, epsilon), light.place,
                              path.info.time, exact_blockers(path.info)))
    return {};
  const Vec3 origin = shadow_origin(hit, light.direction, path, ray_offset(hit));
  MediumStack media = path.media;
  if (scene_.media() && below)
    scene_.media()->cross(media, hit, gap_beside(hit, light.direction), path.info.time);
  if (!std::isfinite(light.distance))
    return transmittance(origin, light.direction, INFINITY, path.info, light.blockers, media,
                         path.random);
  const Vec3 target =
      hit.position + light.direction * light.distance +
      light.normal * std::max({epsilon, ray_epsilon(hit.position, light.distance), light.rounding});
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

}  // namespace photon_splat
