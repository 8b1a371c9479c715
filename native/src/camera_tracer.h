// The camera's side: rays from the lens to the first diffuse surfaces, direct light there, and records of what
// photons are to add later.
#pragma once

#include "camera.h"
#include "film.h"
#include "lights.h"

namespace photon_splat {

// A place where a camera path asks for indirect irradiance E: film[pixel] += throughput * E. A path may leave any
// number of records; nothing downstream knows the camera.
struct Record {
  Vec3 position;
  uint32_t key;
  Vec3 ng;
  float footprint;     // width of a camera sample there, m
  Rgb throughput;      // albedo / pi times what the path gathered on its way
  uint32_t pixel;
  uint32_t instance, triangle;
};

class CameraTracer {
 public:
  CameraTracer(Scene& scene, const Lights& lights, const Camera& camera, uint32_t seed)
      : scene_(scene), lights_(lights), camera_(camera), seed_(seed) {}

  // Camera sample number `sample` of every pixel, instead of what `film` held; returns the records in tile order.
  const std::vector<Record>& trace(uint32_t sample, Film& film, const CancelFlag& cancel);

  // One sample per pixel of the unbiased path tracer, indirect light included; leaves no records.
  void trace_reference(uint32_t sample, int max_bounces, Film& film, const CancelFlag& cancel);

  uint64_t rays() const { return rays_; }
  // Samples whose light was not finite and was left out: 0 unless something is wrong.
  uint64_t bad_samples() const { return bad_samples_; }
  // Records of tile t are [tile_ranges()[t], tile_ranges()[t + 1]); no two tiles share a pixel.
  const std::vector<size_t>& tile_ranges() const { return ranges_; }

 private:
  struct Tile {
    std::vector<Record> records;
    uint64_t rays = 0, bad_samples = 0;
  };
  template <class Shade>
  void for_each_pixel(uint32_t sample, Film& film, const CancelFlag& cancel, Shade&& shade);
  bool first_hit(const CameraRay& ray, Pixel& pixel, Surface& hit) const;
  bool shadowed(const LightSample& light, const Vec3& x, const Vec3& origin, float epsilon) const;
  Rgb direct_irradiance(const Surface& hit, float choice, const Vec2& light, const Vec2& bsdf, uint64_t& rays) const;
  // Albedo and direct light of the first surface into the pixel; returns the albedo.
  Rgb shade_direct(const Surface& hit, uint32_t sample, uint32_t seed, Pixel& pixel, Tile& tile) const;
  Rgb indirect_radiance(Surface hit, Rgb throughput, int max_bounces, class Random& random, uint64_t& rays) const;

  Scene& scene_;
  const Lights& lights_;
  const Camera& camera_;
  uint32_t seed_;
  std::vector<Tile> tiles_;
  std::vector<Record> records_;
  std::vector<size_t> ranges_;
  uint64_t rays_ = 0, bad_samples_ = 0;
};

}  // namespace photon_splat
