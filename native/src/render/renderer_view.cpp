// Another camera without another build: for renders of the same scene, and for a viewport, whose
// pictures while the camera moves come from photons that serve every view.
#include "render/renderer.h"
#include "shading/sees_view.h"

namespace photon_splat {

void Renderer::set_view() {
  map();
  *camera_ = Camera(camera_settings);
  reset_film();
}

void Renderer::relight() {
  map();
  check_light_groups();
  scene.update_features();
  scene.update_own_scenes(cancel_);
  scene.update_media(cancel_);
  scene.update_layers(cancel_);
  current_ = nullptr;  // what they were made of goes
  maps_.clear();
  camera_pass_.reset();
  make_lights();
  make_camera_pass();
  make_maps();
  set_view();
}

void Renderer::begin_again() {
  map();
  seconds_ = {};
  if (std::any_of(scene.programs.begin(), scene.programs.end(), sees_view)) return relight();
  make_camera_pass();
  for (const auto& map : maps_) map->begin_again();
  current_ = maps_.front().get();
  set_view();
}

void Renderer::trace_viewport_photons(uint64_t paths, size_t most_bytes) {
  map();
  for (const auto& map : maps_) map->trace_viewport_photons(paths, most_bytes / maps_.size());
}

void Renderer::draw_viewport() {
  map();
  for (const auto& map : maps_)
    if (!map->viewport_photons() || !map->viewport_photons()->radii())
      throw std::logic_error("trace_viewport_photons() comes before draw_viewport()");
  set_view();
  camera_pass_->set_beams({});
  camera_pass_->trace_gather_points(0, maps_, film_.begin_pass());
  for (const auto& map : maps_) map->place_viewport_points(*camera_pass_->gather_points());
  resolve();
}

void Renderer::draw_from_cache(float pixels, float most_samples) {
  map();
  for (const auto& map : maps_)
    if (!map->viewport_photons() || !map->viewport_photons()->radii())
      throw std::logic_error("trace_viewport_photons() comes before draw_from_cache()");
  *camera_ = Camera(camera_settings);
  film_.reset(camera_settings.region_width, camera_settings.region_height, scene.light_groups);
  bad_light_ = 0;
  begun_ = false;
  camera_pass_->trace_from_cache({&light_cache_, pixels, cache_share_, cache_pictures_++}, maps_,
                                 film_.begin_pass(channels_of_passes()));
  for (const auto& map : maps_) map->place_viewport_points(*camera_pass_->gather_points());
  Timer timer(seconds_.splat);
  add_photons_to_samples();
  read_light_cache();
  film_.end_pass(scene.pool());
  const double wanted = camera_pass_->tracer().cache_samples_wanted();
  cache_share_ = static_cast<float>(std::min(
      1.0, most_samples * static_cast<double>(film_.sum().size()) / std::max(wanted, 1.0)));
}

// Indirect light: to samples for the cache, and to the film where paths do not read it.
void Renderer::add_photons_to_samples() {
  CameraTracer& tracer = camera_pass_->tracer();
  const GatherPoints& gather_points = *camera_pass_->gather_points();
  const std::vector<size_t>& ranges = camera_pass_->tile_ranges();
  PackedFilm& film = film_.pass();
  scene.pool().for_each(film.tiles(), cancel_, [&](size_t t, int) {
    PackedFilm::Tile pixels;
    bool loaded = false;
    for (size_t i = ranges[t]; i < ranges[t + 1]; ++i) {
      Rgb light{};
      for (const auto& map : maps_) light += map->light_at(gather_points, i);
      if (!can_be_added(light)) continue;
      const GatherPoint& at = gather_points[i];
      if (at.pixel & CameraTracer::kOfSample) {
        CacheLight& to = tracer.cache_samples(t)[CameraTracer::sample_of(at.pixel)].light;
        (at.category == LobeCategory::kDiffuse ? to.diffuse : to.reflected) += light;
      } else {
        if (!loaded) film.get(t, pixels);
        loaded = true;
        indirect_of(pixels[film.place_in_tile(at.pixel)], at.category) += light;
      }
    }
    if (loaded) film.put(t, pixels);
  });
}

// Takes the samples into the cache, and then what all paths ask of it into the film.
void Renderer::read_light_cache() {
  using Kind = LightCache::Kind;
  CameraTracer& tracer = camera_pass_->tracer();
  PackedFilm& film = film_.pass();
  light_cache_.begin_picture();
  cache_counts_ = {};
  for (size_t t = 0; t < film.tiles(); ++t) {
    cache_counts_.readings += tracer.readings(t).size();
    cache_counts_.samples += tracer.cache_samples(t).size();
    for (const CacheSample& sample : tracer.cache_samples(t)) {
      const CacheLight light = sample.over_albedo();
      if (!is_black(sample.albedo.diffuse) && can_be_added(light.diffuse))
        light_cache_.add(sample.place, Kind::kDiffuse, light.diffuse);
      if (!is_black(sample.albedo.reflected) && can_be_added(light.reflected))
        light_cache_.add(sample.place, Kind::kReflected, light.reflected);
    }
  }
  scene.pool().for_each(film.tiles(), cancel_, [&](size_t t, int) {
    if (tracer.readings(t).empty()) return;
    PackedFilm::Tile pixels;
    film.get(t, pixels);
    for (const CacheReading& reading : tracer.readings(t)) {
      Pixel& pixel = pixels[reading.pixel];
      const auto read = [&](Rgb& sum, const Rgb& albedo, Kind kind) {
        if (is_black(albedo)) return;
        const Rgb light = albedo * light_cache_.light(reading.place, kind);
        if (can_be_added(light)) sum += light;
      };
      read(pixel.diffuse_indirect, reading.albedo.diffuse, Kind::kDiffuse);
      read(pixel.glossy_indirect, reading.albedo.reflected, Kind::kReflected);
    }
    film.put(t, pixels);
  });
}

}  // namespace photon_splat
