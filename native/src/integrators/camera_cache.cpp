// Light that camera paths read from a viewport's cache, and the samples that they add to it.
#include "integrators/camera_path.h"

namespace photon_splat {
namespace {

// What lobes as smooth as that reflect is followed, if it is more than a tenth of what all do
constexpr float kMirrorRoughness = 0.2f, kMirrorShare = 0.1f;
// How many directions cells tell apart along a half circle, by the roughness of most lobes
constexpr float kSmooth = 0.45f;
constexpr int32_t kDirectionsOfSmooth = 20, kDirectionsOfRough = 10;
constexpr float kNoAlbedo = 1e-3f;
constexpr float kFew = 2;  // cells with fewer samples want one of every path

}  // namespace

// Whether what the surface mirrors is left to be followed.
bool CameraTracer::read_light(Path& path, const Surface& hit, const Bsdf& bsdf) const {
  const Rgb all = bsdf.albedo();
  CacheLight albedo{bsdf.diffuse_albedo(), {}};
  const Rgb reflected = max(all - albedo.diffuse, {});
  const bool mirrors =
      average(bsdf.sharp_albedo(kMirrorRoughness)) > kMirrorShare * average(reflected);
  const float width = cache_use_.pixels * path.info.footprint;
  LightCache::Place place = LightCache::place(hit.key, place_of(path, hit), hit.ng, width);
  if (!mirrors && average(reflected) > kNoAlbedo) {
    albedo.reflected = reflected;
    const Vec3 n = bsdf.mean_normal(), wo = -path.direction;
    const bool smooth = average(bsdf.sharp_albedo(kSmooth)) > 0.5f * average(reflected);
    LightCache::set_mirror(place, 2 * dot(n, wo) * n - wo,
                           smooth ? kDirectionsOfSmooth : kDirectionsOfRough);
  }
  if (average(albedo.diffuse + albedo.reflected) > kNoAlbedo) {
    path.tile.readings.push_back(
        {place,
         {path.throughput * albedo.diffuse, path.throughput * albedo.reflected},
         static_cast<uint32_t>(path.place),
         path.vertex == 0 && path.info.transparent_depth == 0});
    if (wants_sample(path, place, albedo)) sample_light(path, hit, bsdf, place, albedo);
  }
  return mirrors;
}

// The fewer samples its cells have the likelier, and always where there is nothing yet; now and
// then where there are many, for what has changed.
bool CameraTracer::wants_sample(Path& path, const LightCache::Place& place,
                                const CacheLight& albedo) const {
  const LightCache& cache = *cache_use_.cache;
  float wanted = 0;
  bool unknown = false;
  const auto ask = [&](LightCache::Kind kind, const Rgb& of) {
    if (!(average(of) > kNoAlbedo)) return;
    const float samples = cache.samples(place, kind);
    wanted = std::max(wanted, samples > kFew ? kFew / samples : 1.0f);
    unknown |= !(samples > 0) && !cache.knows(place, kind);
  };
  ask(LightCache::Kind::kDiffuse, albedo.diffuse);
  ask(LightCache::Kind::kReflected, albedo.reflected);
  path.tile.cache_samples_wanted += wanted;
  if (cache_use_.share < 0) return false;
  return (unknown || path.random.next() < wanted * cache_use_.share) &&
         path.tile.cache_samples.size() < kMostSamples;
}

// A path of its own, as if it came from the camera.
void CameraTracer::sample_light(Path& path, const Surface& hit, Bsdf bsdf,
                                const LightCache::Place& place, const CacheLight& albedo) const {
  std::vector<CacheSample>& samples = path.tile.cache_samples;
  const size_t number = samples.size();
  samples.push_back({place, albedo, {}});
  Pixel found{};
  // Neighbours of a picture, and pictures, go on in the sequence of a cell.
  const auto neighbour = static_cast<uint32_t>(path.place % 2 + 2 * (path.place / kTileSize % 2));
  const uint32_t seed =
      hash_combine(hash_combine(static_cast<uint32_t>(place.u + (place.fu >= 0.5f)),
                                static_cast<uint32_t>(place.v + (place.fv >= 0.5f))),
                   hash_combine(static_cast<uint32_t>(place.surface), seed_));
  Path own(path.ray, found, path.tile, kOfSample | static_cast<uint32_t>(number),
           4 * cache_use_.picture + neighbour, seed, path.info.time);
  own.origin = path.origin;
  own.direction = path.direction;
  own.near = path.near;
  own.info = path.info;
  own.media = path.media;
  own.travelled = path.travelled;
  own.max_bounces = path.max_bounces - path.vertex;
  own.leaves_gather_points = true;
  own.shows_features = false;
  if (meet(own, hit, bsdf)) follow(own);
  const Rgb diffuse = found.diffuse_direct + found.diffuse_indirect;
  samples[number].light = {diffuse, found.combined() - diffuse};
}

const GatherPoints& CameraTracer::trace_from_cache(const CacheUse& use, int max_bounces,
                                                   PackedFilm& film, const CancelFlag& cancel) {
  cache_use_ = use;
  Job job{0, nullptr, max_bounces, true};
  job.reads_light = true;
  trace_tiles(job, film, cancel);
  return join_gather_points(cancel);
}

double CameraTracer::cache_samples_wanted() const {
  double sum = 0;
  for (const Tile& tile : tiles_) sum += tile.cache_samples_wanted;
  return sum;
}

}  // namespace photon_splat
