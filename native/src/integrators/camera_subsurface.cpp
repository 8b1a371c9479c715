// Camera paths below surfaces: where they leave, a white Lambertian surface takes their place,
// which light samples, photons and further bounces light as any other.
#include "integrators/camera_path.h"
#include "subsurface/walk.h"

namespace photon_splat {
namespace {

constexpr float kLeastChance = 0.1f;  // of what goes below, and of what does not, where both do
constexpr uint32_t kBelowStream = 0x62656c77u;

}  // namespace

// A surface with light below it. From the first vertex a path of its own goes there, else either by
// chance.
bool CameraTracer::meet_body(Path& path, const Surface& hit, Bsdf& bsdf) const {
  if (path.vertex == 0) {
    Path below = path;
    below.random = Random(path.sample, hash_combine(path.seed, kBelowStream));
    if (go_below(below, hit, bsdf)) follow(below);
    return meet(path, hit, bsdf);
  }
  const Rgb throughput = path.throughput + path.world_throughput;
  const float goes = max_abs(throughput * bsdf.below_weight()),
              stays = max_abs(throughput * (bsdf.albedo() - bsdf.below_weight()));
  const float chance =
      stays > 0 ? std::clamp(goes / (goes + stays), kLeastChance, 1 - kLeastChance) : 1;
  if (path.random.next() < chance) {
    path.scale(Rgb{1, 1, 1} / chance);
    return go_below(path, hit, bsdf);
  }
  path.scale(Rgb{1, 1, 1} / (1 - chance));
  return meet(path, hit, bsdf);
}

// The path enters the body, and is lit where it leaves; false where it ends.
bool CameraTracer::go_below(Path& path, const Surface& hit, const Bsdf& bsdf) const {
  const float choice = bsdf.below_count() > 1 ? path.numbers(kBelowPair).x : 0;
  float weights[4], all = 0;
  for (int i = 0; i < bsdf.below_count(); ++i)
    all += weights[i] = max_abs((path.throughput + path.world_throughput) * bsdf.below(i).weight);
  if (!(all > 0)) return false;
  int own = 0;
  float left = choice * all;
  for (; own < bsdf.below_count() - 1 && left >= weights[own]; ++own) left -= weights[own];
  if (!(weights[own] > 0)) return false;
  const Vec3 wo = -path.direction;
  WalkNumbers numbers = path.vertex == 0
                            ? WalkNumbers(path.random, path.sample, path.seed, kWalkPairs, kWalkEnd)
                            : WalkNumbers(path.random);
  const auto exit = scatter_below(scene_, hit, bsdf.below(own), wo,
                                  path.throughput + path.world_throughput, numbers, path.info.time);
  if (!exit) return false;
  path.scale(exit->weight * (all / weights[own]));
  if (!is_finite(path.throughput) || !is_finite(path.world_throughput)) {
    ++path.tile.bad_samples;
    return false;
  }
  path.take_numbers_of_exit();
  Surface surface = exit->surface;
  surface.distance = hit.distance;
  Bsdf white(Transport::kRadiance, exit->way, surface.ng, surface.ns, surface.back);
  const Vec3 normal = exit_normal(path, surface, exit->way);
  white.add_diffuse({1, 1, 1}, surface.back ? -normal : normal, 0);
  white.finish();
  return meet(path, surface, white);
}

// What light leaves about: the surface's shading normal, or that of its closures, as in Cycles.
Vec3 CameraTracer::exit_normal(const Path& path, const Surface& exit, const Vec3& wo) const {
  if (!exit.program || !exit.program->bends_subsurface) return exit.ns;
  Bsdf bsdf(Transport::kRadiance, wo, exit.ng, exit.ns, exit.back);
  bsdf.keep_subsurface(SubsurfaceUse::kAll);
  scene_.shade(exit, wo, path.info, bsdf);
  Vec3 sum{};
  for (int i = 0; i < bsdf.below_count(); ++i)
    sum += bsdf.below(i).n * average(bsdf.below(i).weight);
  const float l = length(sum);
  return l > 0 && std::isfinite(l) ? sum / l : exit.ns;
}

}  // namespace photon_splat
