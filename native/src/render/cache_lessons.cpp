// A viewport's cache learns from the passes that refine a view: many samples of every pixel.
#include "render/renderer.h"

namespace photon_splat {
namespace {

constexpr int kSide = PackedFilm::kSide;
constexpr int kBlock = 2;  // pixels along what is one lesson
// Opacity of a surface that nothing is seen through; how far albedos may differ, of themselves
constexpr float kOpaque = 0.999f, kUnlike = 0.25f;
constexpr float kLeastAlbedo = 1e-3f, kLeastLight = 1e-6f;

struct Lesson {
  LightCache::Place place;
  CacheLight light;  // over the albedo
  bool diffuse, reflected;
  float samples;
};

bool alike(const Rgb& a, const Rgb& b) {
  return std::abs(average(a) - average(b)) <= kUnlike * std::max(average(a), average(b));
}

// Of the pixels of a tile what each sees straight, where that is one surface alone.
class TileReadings {
 public:
  explicit TileReadings(const std::vector<CacheReading>& readings) {
    for (const CacheReading& reading : readings) {
      Seen& seen = seen_[reading.pixel];
      seen = {seen.count ? nullptr : &reading, seen.count + 1};
    }
  }
  // The readings of the block whose first pixel that is; false where it sees more than one surface.
  bool block(int x, int y, std::array<const CacheReading*, kBlock * kBlock>& out) const {
    for (int i = 0; i < kBlock * kBlock; ++i) {
      out[i] = seen_[(y + i / kBlock) * kSide + x + i % kBlock].reading;
      if (!out[i] || !out[i]->first || out[i]->place.surface != out[0]->place.surface) return false;
    }
    return true;
  }

 private:
  struct Seen {
    const CacheReading* reading = nullptr;
    int count = 0;
  };
  std::array<Seen, kSide * kSide> seen_{};
};

// Light that is shown, by the share that each lobe has in all that has been found there; where that
// is nothing, by albedo.
CacheLight shared_out(const Rgb& shown, const Rgb& all, const CacheLight& found,
                      const CacheLight& albedo) {
  const auto part = [&](const Rgb& of, const Rgb& albedo_of) {
    const auto one = [&](int c) {
      if (all[c] > kLeastLight) return shown[c] * (of[c] / all[c]);
      const float both = albedo.diffuse[c] + albedo.reflected[c];
      return both > 0 ? shown[c] * (albedo_of[c] / both) : 0.0f;
    };
    return Rgb{one(0), one(1), one(2)};
  };
  return {part(found.diffuse, albedo.diffuse), part(found.reflected, albedo.reflected)};
}

// `pixels`: sums of the film. shown: the light of the block's without its noise.
std::optional<Lesson> lesson_of(const std::array<const CacheReading*, kBlock * kBlock>& readings,
                                const PackedFilm::Tile& pixels, const Rgb& shown) {
  Pixel sum{};
  Rgb all{};
  CacheLight albedo;
  for (const CacheReading* reading : readings) {
    const Pixel& p = pixels[reading->pixel];
    sum.samples += p.samples;
    sum.alpha += p.alpha;
    sum.diffuse_color += p.diffuse_color;
    sum.diffuse_direct += p.diffuse_direct + p.diffuse_indirect;
    sum.glossy_direct +=
        p.glossy_direct + p.glossy_indirect + p.transmission_direct + p.transmission_indirect;
    all += p.combined();
    albedo.diffuse += reading->albedo.diffuse * (1.0f / (kBlock * kBlock));
    albedo.reflected += reading->albedo.reflected * (1.0f / (kBlock * kBlock));
  }
  if (!(sum.alpha >= kOpaque * sum.samples) || !(sum.samples > 0)) return {};
  const float share = sum.share();
  const Rgb color = sum.diffuse_color * share;
  const bool diffuse = average(albedo.diffuse) > kLeastAlbedo;
  if (diffuse && !alike(color, albedo.diffuse)) return {};
  const CacheLight light = shared_out(
      shown, all * share, {sum.diffuse_direct * share, sum.glossy_direct * share}, albedo);
  return Lesson{readings[0]->place, light_over_albedo(light, {color, albedo.reflected}), diffuse,
                average(albedo.reflected) > kLeastAlbedo, sum.samples};
}

// The mean of a block's pixels in a picture.
Rgb shown_in(const float* picture, const PackedFilm& film, size_t t, int x, int y, float factor) {
  Rgb sum{};
  for (int i = 0; i < kBlock * kBlock; ++i) {
    const float* rgb = picture + 4 * film.pixel_of(t, x + i % kBlock, y + i / kBlock);
    sum += Rgb{rgb[0], rgb[1], rgb[2]};
  }
  return sum * (factor / (kBlock * kBlock));
}

}  // namespace

void Renderer::teach_light_cache(float pixels, float share, const float* picture) {
  map();
  const PackedFilm& sum = film_.sum();
  // What lies in fog, below a catcher's shadow or out of focus looks as it does from here alone.
  if (!sum.passes || camera_settings.aperture.radius > 0 || scene.media() || scene.has_catchers())
    return;
  camera_pass_->trace_from_cache({&light_cache_, pixels, -1, 0}, maps_,
                                 film_.begin_pass(ChannelMask{}));
  const CameraTracer& tracer = camera_pass_->tracer();
  std::vector<std::vector<Lesson>> lessons(sum.tiles());
  scene.pool().for_each(sum.tiles(), cancel_, [&](size_t t, int) {
    PackedFilm::Tile film;
    sum.get(t, film);
    const TileReadings seen(tracer.readings(t));
    const auto [width, height] = sum.extent_of(t);
    std::array<const CacheReading*, kBlock * kBlock> block;
    for (int y = 0; y + kBlock <= height; y += kBlock)
      for (int x = 0; x + kBlock <= width; x += kBlock)
        if (seen.block(x, y, block)) {
          const Rgb shown = shown_in(picture, sum, t, x, y, 1 / camera_settings.exposure);
          if (auto lesson = lesson_of(block, film, shown)) lessons[t].push_back(*lesson);
        }
  });
  light_cache_.begin_picture();
  for (const std::vector<Lesson>& of_tile : lessons)
    for (const Lesson& lesson : of_tile) {
      const auto add = [&](bool wanted, LightCache::Kind kind, const Rgb& light) {
        if (wanted && can_be_added(light))
          light_cache_.add(lesson.place, kind, light, lesson.samples * share);
      };
      add(lesson.diffuse, LightCache::Kind::kDiffuse, lesson.light.diffuse);
      add(lesson.reflected, LightCache::Kind::kReflected, lesson.light.reflected);
    }
}

}  // namespace photon_splat
