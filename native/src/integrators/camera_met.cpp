// Light that rays of camera paths meet: lamps, shining surfaces, the world.
#include "integrators/camera_path.h"

namespace photon_splat {

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
    add_finite(direct_of(path.pixel, path.beside), light - diffuse, path.tile.bad_samples);
  } else {
    add_indirect(path, light,
                 path.diffuse_part_of(path.emission_throughput + path.withheld, path.withheld,
                                      path.withheld_diffuse));
  }
}

// Light that has scattered more than once on its way to the camera, at surfaces or in media.
void CameraTracer::add_indirect(Path& path, const Rgb& light, const Rgb& diffuse_part) {
  const Rgb diffuse = light * diffuse_part;
  add_finite(path.pixel.diffuse_indirect, diffuse, path.tile.bad_samples);
  add_finite(indirect_of(path.pixel, path.beside), light - diffuse, path.tile.bad_samples);
}

void CameraTracer::add_lamps(Path& path, float far) const {
  GroupLight light{path.groups, path.emission_throughput}, *const groups =
                                                               path.groups ? &light : nullptr;
  Attenuation attenuation;
  if (!path.media.empty())
    attenuation = [&](float distance) {
      return scene_.media()->transmittance(scene_.media()->seen(path.media, ray_mask(path.info)),
                                           path.origin, path.direction, path.near, distance,
                                           path.info, path.random);
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
  RayInfo shadows = path.info;
  --shadows.depth;  // those of the vertex, as for light samples
  const auto through = [&](float far, uint64_t blockers) {
    return transmittance(path.origin, path.direction, far, shadows, blockers, path.media,
                         path.random);
  };
  const Rgb radiance = lights_.linked_met(path.from, path.origin, path.direction, path.pdf,
                                          path.info, through, path.groups ? &light : nullptr);
  if (!is_black(radiance)) add_met(path, radiance, path.pixel.emission);
}

void CameraTracer::add_world(Path& path) const {
  const bool first = path.vertex == 0 && !path.through_glass;
  if (first) path.pixel.alpha += path.shown;
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
  if (path.vertex > 0 && world.asks_ray()) {  // add_world_by_ray() looks who sees it
    Receiver from = path.from;
    from.ray = from.diffuse_ray = 0xff;
    return lights_.world_met(from, path.direction, path.pdf);
  }
  if (path.vertex > 0 || !world.asks_camera())
    return lights_.world_met(path.from, path.direction, path.pdf);
  return scene_.world_seen_by & path.from.ray ? world.radiance(path.direction, path.info) : Rgb{};
}

// The world's light as a ray of each kind sees it. What diffuse lobes sent on this way and what
// others did adds up to all, whichever the ray was drawn by, as for light samples: they and rays
// then share the same light.
void CameraTracer::add_world_by_ray(Path& path, const Rgb& light) const {
  const Environment& world = lights_.environment();
  const bool delta = !(path.pdf < INFINITY), through = path.info.through;
  const auto share = [&](bool diffuse) {
    const uint8_t kinds = diffuse ? path.from.diffuse_ray : path.from.ray;
    if (!(scene_.world_seen_by & kinds)) return Rgb{};
    RayInfo ray = path.before.scattered(diffuse, through, delta);
    ray.transparent_depth = path.info.transparent_depth;
    return world.share(path.direction, ray);
  };
  const Rgb diffuse = is_black(path.from.diffuse_share_of_world) ? Rgb{} : share(true),
            rest = share(false);
  const Rgb all = path.emission_throughput + path.withheld + path.world_emission;
  const Rgb withheld = lights_.world_by_paths() ? Rgb{} : path.withheld;
  const Rgb kept = path.emission_throughput, kept_diffuse = path.diffuse_emission;
  path.diffuse_emission = path.diffuse_emission * diffuse;
  path.emission_throughput = all * (path.from.diffuse_share_of_world * diffuse +
                                    (Rgb{1, 1, 1} - path.from.diffuse_share_of_world) * rest) -
                             withheld * rest;
  add_met(path, light, path.pixel.environment, scene_.world_light_group);
  path.emission_throughput = kept;
  path.diffuse_emission = kept_diffuse;
}

void CameraTracer::add_emission(Path& path, const Surface& hit, const Rgb& emission) const {
  if (hit.program && hit.program->asks_kind && !is_zero(path.withheld) && !hit.on_strand())
    add_unlike_photons(path, hit, emission);
  if (is_zero(emission)) return;
  if (hit.on_strand()) return add_found_emission(path, hit, emission);
  const Rgb shines = max(emission, Rgb{}), takes = emission - shines;
  if (!is_zero(takes)) add_found_emission(path, hit, takes);
  if (is_black(shines)) return;
  const float weight = path.vertex == 0 ? 1 : lights_.surface_mis_weight(path.from, hit, path.pdf);
  if (weight > 0)
    add_met(path, shines * weight, path.pixel.emission, scene_.instances[hit.instance].light_group);
}

// Photons bring what no kind of ray sees: the rest of what this one does is added to that.
void CameraTracer::add_unlike_photons(Path& path, const Surface& hit, const Rgb& emission) const {
  RayInfo none{RayInfo::kEmission};
  none.time = path.info.time;
  none.depth = 1;
  const Rgb rest = emission - scene_.emission(hit, -path.direction, none);
  if (is_zero(rest)) return;
  const Rgb kept = path.emission_throughput;
  path.emission_throughput = path.withheld;
  add_met(path, rest, path.pixel.emission, scene_.instances[hit.instance].light_group);
  path.emission_throughput = kept;
}

// That of strands, or below 0: no photons bring it, and no light samples.
void CameraTracer::add_found_emission(Path& path, const Surface& hit, const Rgb& emission) const {
  const Instance& instance = scene_.instances[hit.instance];
  if (path.vertex > 0 && !(instance.lit_groups & path.from.group)) return;
  const Rgb kept = path.emission_throughput;
  path.emission_throughput += path.withheld;
  add_met(path, emission, path.pixel.emission, instance.light_group);
  path.emission_throughput = kept;
}

}  // namespace photon_splat
