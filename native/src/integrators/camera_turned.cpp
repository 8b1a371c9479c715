// What smooth glass and mirrors, and what is nearly as smooth, show of what lies along them. Their
// normals, where bumps tell them, turn towards who sees them until they mirror the horizon: hardly
// any photon that comes from there reaches such a viewer, so that diffuse surfaces, whose light
// photons bring, look for it themselves.
#include "integrators/camera_path.h"

namespace photon_splat {
namespace {

constexpr uint32_t kTurnedStream = 0x7475726eu;
constexpr float kLook = 0.5f;  // chance of a look

}  // namespace

// From where photons bring the diffuse light, along one ray of it.
void CameraTracer::look_for_turned_mirrors(const Path& path, const Surface& hit,
                                           const Bsdf& bsdf) const {
  const float here = average(bsdf.gather()), through = average(bsdf.gather_through());
  if (path.vertex + 1 >= path.max_bounces || !(here + through > 0)) return;
  Path aside = path;
  aside.random = Random(path.sample, hash_combine(path.seed, kTurnedStream + path.vertex));
  const bool below = aside.random.next() * (here + through) < through;
  const Rgb albedo = below ? bsdf.gather_through() * ((here + through) / through)
                           : bsdf.gather() * ((here + through) / here);
  aside.throughput = path.throughput * albedo;
  const float survival = kLook * std::min(1.0f, max_abs(aside.throughput));
  if (!(survival > 0) || aside.random.next() >= survival) return;
  aside.throughput *= 1 / survival;
  aside.emission_throughput = aside.diffuse_emission = aside.covered = aside.withheld =
      aside.world_throughput = aside.world_emission = {};
  aside.diffuse_part = path.vertex == 0 ? Rgb{1, 1, 1} : path.diffuse_part;
  aside.category = path.vertex == 0 ? LobeCategory::kDiffuse : path.category;
  aside.learns = aside.shows_features = aside.shows_normal = false;
  aside.info = path.info.scattered(true, below, false);
  aside.direction =
      Basis(below ? -hit.ng : hit.ng).to_world(sample_cosine_hemisphere(aside.random.next2()));
  aside.origin = leave(hit, aside.direction);
  aside.near = 0;
  aside.far = INFINITY;
  aside.travelled += hit.distance;
  aside.info.left = hit.mark;
  ++aside.vertex;
  if (below && scene_.media())
    scene_.media()->cross(aside.media, hit, gap_beside(hit, aside.direction), aside.info.time);
  Surface mirror;
  ++path.tile.rays;
  if (!scene_.intersect(aside.origin, aside.direction, 0, INFINITY, false, mirror,
                        ray_mask(aside.info), aside.info.time, aside.info.left) ||
      !mirror.program || !mirror.program->turns_mirrors || mirror.on_strand())
    return;
  if (!aside.media.empty())
    aside.throughput *= scene_.media()->transmittance(
        scene_.media()->seen(aside.media, ray_mask(aside.info)), aside.origin, aside.direction, 0,
        mirror.distance, aside.info, aside.random);
  aside.info.length = mirror.distance;
  aside.info.left = mirror.mark;
  aside.info.footprint = camera_.footprint_at(aside.ray, aside.travelled + mirror.distance);
  Bsdf glass(Transport::kRadiance, -aside.direction, mirror.ng, mirror.ns, mirror.back);
  scene_.shade(mirror, -aside.direction, aside.info, glass);
  if (!glass.keep_turned()) return;
  Receiver receiver{mirror.position, {}, true, scene_.instances[mirror.instance].group};
  receiver.ns = mirror.ns;
  receiver.time = aside.info.time;
  receiver.bounces = static_cast<uint16_t>(aside.vertex);
  add_direct(aside, mirror, glass, receiver);
  aside.only_turned = true;
  if (scatter(aside, mirror, glass, receiver, false)) follow(aside);
}

}  // namespace photon_splat
