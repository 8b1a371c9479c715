#include "camera_tracer.h"

namespace photon_splat {
namespace {

constexpr int kTileSize = 16;

// Dimensions of the camera's low-discrepancy sequence, in pairs.
enum Dimension : uint32_t { kFilterPair, kChoicePair, kLightPair, kBsdfPair, kLensPair = 64 };

void add_finite(Rgb& sum, const Rgb& value, uint64_t& bad) {
  if (is_finite(value)) sum += value;
  else ++bad;
}

}  // namespace

template <class Shade>
void CameraTracer::for_each_pixel(uint32_t sample, Film& film, const CancelFlag& cancel, Shade&& shade) {
  const int across = (film.width + kTileSize - 1) / kTileSize, down = (film.height + kTileSize - 1) / kTileSize;
  tiles_.resize(static_cast<size_t>(across) * down);
  scene_.pool().for_each(tiles_.size(), cancel, [&](size_t t, int) {
    Tile& tile = tiles_[t];
    tile.records.clear();
    tile.rays = tile.bad_samples = 0;
    const int x_begin = static_cast<int>(t % across) * kTileSize, y_begin = static_cast<int>(t / across) * kTileSize;
    const int x_end = std::min(x_begin + kTileSize, film.width), y_end = std::min(y_begin + kTileSize, film.height);
    for (int y = y_begin; y < y_end; ++y)
      for (int x = x_begin; x < x_end; ++x) {
        const uint32_t index = static_cast<uint32_t>(y) * film.width + x;
        const CameraSettings& c = camera_.settings();
        // The place in the whole frame seeds a pixel, so that a border renders the same pixels.
        const uint32_t frame_index = static_cast<uint32_t>(y + c.y0) * c.width + (x + c.x0);
        const uint32_t seed = hash_combine(seed_, frame_index);
        Pixel& pixel = film.pixels[index] = {};
        pixel.depth = kBackgroundDepth;
        const auto ray = camera_.ray(x, y, sobol_2d(sample, kFilterPair, seed), sobol_2d(sample, kLensPair, seed));
        if (!ray) {  // outside the lens' image: black, not transparent
          pixel.alpha = 1;
          continue;
        }
        ++tile.rays;
        Surface hit;
        if (first_hit(*ray, pixel, hit)) shade(*ray, hit, pixel, index, seed, tile);
      }
  });
  for (const Tile& tile : tiles_) {
    rays_ += tile.rays;
    bad_samples_ += tile.bad_samples;
  }
}

// Writes what needs no light from elsewhere: background, emission, depth, normal. False: nothing hit.
bool CameraTracer::first_hit(const CameraRay& ray, Pixel& pixel, Surface& hit) const {
  const bool found = scene_.intersect(ray.origin, ray.direction, ray.near, ray.far, true, hit);
  pixel.depth = found ? hit.distance * ray.cosine : kBackgroundDepth;
  pixel.surface_id = found ? static_cast<float>(hit.key & 0xffffff) : 0;
  pixel.emission += lights_.lamps_seen(ray.origin, ray.direction, found ? hit.distance : ray.far >= 1e30f ? INFINITY : ray.far);
  if (!found) {
    if (!camera_.settings().transparent) {
      pixel.environment += lights_.world();
      pixel.alpha += 1;
    }
    return false;
  }
  pixel.alpha += 1;
  pixel.normal += hit.ns;
  pixel.emission += scene_.emission(hit);
  return true;
}

// The ray starts off the surface, so it is aimed anew; before an emissive surface it stops as far off that one.
bool CameraTracer::shadowed(const LightSample& light, const Vec3& x, const Vec3& origin, float epsilon) const {
  if (!std::isfinite(light.distance)) return scene_.occluded(origin, light.direction, 0, INFINITY);
  const Vec3 target = x + light.direction * light.distance + light.normal * std::max(epsilon, ray_epsilon(x, light.distance));
  const Vec3 way = target - origin;
  const float distance = length(way);
  return distance > 0 && scene_.occluded(origin, way / distance, 0, distance * (1 - 1e-5f));
}

Rgb CameraTracer::direct_irradiance(const Surface& hit, float choice, const Vec2& light, const Vec2& bsdf,
                                    uint64_t& rays) const {
  Rgb irradiance{};
  const float epsilon = ray_epsilon(hit.position, hit.distance);
  const Vec3 origin = hit.position + hit.ng * epsilon;
  if (const auto s = lights_.sample(hit.position, hit.ng, choice, light)) {
    const float cosine = dot(s->direction, hit.ns);
    if (cosine > 0 && dot(s->direction, hit.ng) > 0) {
      float mis = 1;
      if (s->use_mis) {
        const float bsdf_pdf = cosine / kPi;
        mis = s->pdf * s->pdf / (s->pdf * s->pdf + bsdf_pdf * bsdf_pdf);
      }
      ++rays;
      if (!shadowed(*s, hit.position, origin, epsilon)) irradiance += s->weight * (cosine * mis);
    }
  }
  if (lights_.wants_bsdf_ray(hit.position)) {
    const Vec3 local = sample_cosine_hemisphere(bsdf);
    const Vec3 direction = Basis(hit.ns).to_world(local);
    if (local.z > 0 && dot(direction, hit.ng) > 0) {
      const float pdf = local.z / kPi;
      ++rays;
      Surface next;
      const bool found = scene_.intersect(origin, direction, 0, INFINITY, false, next);
      Rgb radiance = lights_.lamps_met(hit.position, hit.ng, direction, found ? next.distance : INFINITY, pdf);
      if (!found) {
        radiance += lights_.world();
      } else {
        const Rgb emission = scene_.emission(next);
        if (!is_black(emission)) radiance += emission * lights_.surface_mis_weight(hit.position, hit.ng, next, pdf);
      }
      irradiance += radiance * kPi;
    }
  }
  return irradiance;
}

Rgb CameraTracer::shade_direct(const Surface& hit, uint32_t sample, uint32_t seed, Pixel& pixel, Tile& tile) const {
  const Rgb albedo = scene_.albedo(hit);
  pixel.diffuse_color += albedo;
  if (is_black(albedo)) return albedo;
  const Rgb direct = direct_irradiance(hit, sobol_2d(sample, kChoicePair, seed).x, sobol_2d(sample, kLightPair, seed),
                                       sobol_2d(sample, kBsdfPair, seed), tile.rays);
  add_finite(pixel.diffuse_direct, albedo * direct * (1 / kPi), tile.bad_samples);
  return albedo;
}

const std::vector<Record>& CameraTracer::trace(uint32_t sample, Film& film, const CancelFlag& cancel) {
  for_each_pixel(sample, film, cancel,
                 [&](const CameraRay& ray, const Surface& hit, Pixel& pixel, uint32_t index, uint32_t seed, Tile& tile) {
    const Rgb albedo = shade_direct(hit, sample, seed, pixel, tile);
    if (is_black(albedo)) return;
    tile.records.push_back({hit.position, hit.key, hit.ng, camera_.footprint_at(ray, hit.distance),
                            albedo * (1 / kPi), index, hit.instance, hit.triangle});
  });
  ranges_.assign(tiles_.size() + 1, 0);
  for (size_t t = 0; t < tiles_.size(); ++t) ranges_[t + 1] = ranges_[t] + tiles_[t].records.size();
  records_.resize(ranges_.back());
  scene_.pool().for_each(tiles_.size(), cancel, [&](size_t t, int) {
    std::copy(tiles_[t].records.begin(), tiles_[t].records.end(), records_.begin() + ranges_[t]);
  });
  return records_;
}

Rgb CameraTracer::indirect_radiance(Surface hit, Rgb throughput, int max_bounces, Random& random, uint64_t& rays) const {
  Rgb sum{};
  for (int bounce = 1; bounce <= max_bounces; ++bounce) {
    const Vec3 local = sample_cosine_hemisphere(random.next2());
    const Vec3 direction = Basis(hit.ns).to_world(local);
    if (!(local.z > 0) || dot(direction, hit.ng) <= 0) return sum;
    const Vec3 origin = hit.position + hit.ng * ray_epsilon(hit.position, hit.distance);
    ++rays;
    if (!scene_.intersect(origin, direction, 0, INFINITY, false, hit)) return sum;
    const Rgb albedo = scene_.albedo(hit);
    throughput *= albedo;
    if (is_black(throughput)) return sum;
    const float choice = random.next();
    const Vec2 light = random.next2(), bsdf = random.next2();
    sum += throughput * direct_irradiance(hit, choice, light, bsdf, rays) * (1 / kPi);
    if (bounce >= 3) {
      const float survival = std::min(1.0f, max_component(throughput) * 1.2f);
      if (random.next() >= survival) return sum;
      throughput *= 1 / survival;
    }
  }
  return sum;
}

void CameraTracer::trace_reference(uint32_t sample, int max_bounces, Film& film, const CancelFlag& cancel) {
  for_each_pixel(sample, film, cancel,
                 [&](const CameraRay&, const Surface& hit, Pixel& pixel, uint32_t, uint32_t seed, Tile& tile) {
    const Rgb albedo = shade_direct(hit, sample, seed, pixel, tile);
    if (is_black(albedo)) return;
    Random random(sample, seed);
    add_finite(pixel.diffuse_indirect, indirect_radiance(hit, albedo, max_bounces, random, tile.rays), tile.bad_samples);
  });
}

}  // namespace photon_splat
