// What smooth glass and mirrors, and what is nearly as smooth, show of what lies along them. Their
// normals, where bumps tell them, turn towards who sees them until they mirror the horizon: hardly
// any photon that comes from there reaches such a viewer, so that diffuse surfaces, whose light
// photons bring, look for it themselves. So do smooth normals of a mesh as coarse as a cube.
#include <utility>

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
  const float side = (here + through) / (below ? through : here);
  const Rgb albedo = below ? bsdf.gather_through() : bsdf.gather();
  const float survival = kLook * std::min(1.0f, side * max_abs(path.throughput * albedo));
  if (!(survival > 0) || aside.random.next() >= survival) return;
  aside.emission_throughput = aside.diffuse_emission = aside.covered = aside.withheld =
      aside.covered_diffuse = aside.withheld_diffuse = aside.world_throughput =
          aside.world_emission = {};
  aside.diffuse_part = path.vertex == 0 ? Rgb{1, 1, 1} : path.diffuse_part;
  aside.category = path.vertex == 0 ? LobeCategory::kDiffuse : path.category;
  aside.learns = aside.shows_features = aside.shows_normal = false;
  aside.info = path.info.scattered(true, below, false);
  const Vec3 way = sample_cosine_hemisphere(aside.random.next2());
  if (!(way.z > 0)) return;
  aside.direction = Basis(below ? -hit.ng : hit.ng).to_world(way);
  aside.throughput =
      path.throughput * bsdf.gathered(aside.direction) * (kPi / way.z * side / survival);
  aside.origin = leave(hit, aside.direction);
  aside.near = 0;
  aside.far = INFINITY;
  aside.travelled += hit.distance;
  aside.info.left = hit.mark;
  ++aside.vertex;
  if (below && scene_.media())
    scene_.media()->cross(aside.media, hit, gap_beside(hit, aside.direction), aside.info.time);
  aside.only_turned = true;
  seek_turned_mirror(aside);
}

// By smooth lobes to one whose normal has turned; from there on as any path.
void CameraTracer::seek_turned_mirror(Path& path) const {
  Surface hit;
  while (path.only_turned) {
    ++path.tile.rays;
    if (!scene_.intersect(path.origin, path.direction, 0, INFINITY, false, hit, ray_mask(path.info),
                          path.info.time, path.info.left) ||
        !hit.program || !(hit.program->features & kProgramSharp) || hit.on_strand())
      return;
    if (path.survives < 1 && path.ends(std::exchange(path.survives, 1.0f))) return;
    if (!path.media.empty())
      path.scale(scene_.media()->transmittance(
          scene_.media()->seen(path.media, ray_mask(path.info)), path.origin, path.direction, 0,
          hit.distance, path.info, path.random));
    path.info.length = hit.distance;
    path.info.left = hit.mark;
    path.info.footprint = camera_.footprint_at(path.ray, path.travelled + hit.distance);
    Receiver receiver{hit.position, {}, true, scene_.instances[hit.instance].group};
    receiver.ns = hit.ns;
    receiver.time = path.info.time;
    receiver.bounces = static_cast<uint16_t>(path.vertex);
    const auto shade = [&] {
      Bsdf bsdf(Transport::kRadiance, -path.direction, hit.ng, hit.ns, hit.back);
      scene_.shade(hit, -path.direction, path.info, bsdf);
      return bsdf;
    };
    Bsdf glass = shade();
    if (!glass.keep_smooth()) return;
    if (glass.has_wide_turned()) {
      Bsdf turned = shade();
      turned.keep_turned();
      add_direct(path, hit, turned, receiver);
    }
    if (!scatter(path, hit, glass, receiver, false)) return;
  }
  follow(path);
}

}  // namespace photon_splat
