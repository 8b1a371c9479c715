// One render. It is filled, built, and asked for passes; render_pass() is the only loop over the
// stages of a pass, and reads like one. The stages can be called one by one, for tests and
// measurements of a single one.
#pragma once

#include "film/render_film.h"
#include "integrators/data_passes.h"
#include "render/beam_map.h"
#include "render/camera_pass.h"
#include "render/external_splatter.h"
#include "render/photon_budget.h"
#include "scene/coincident.h"

namespace photon_splat {

class Renderer {
 public:
  explicit Renderer(int threads) : scene(threads) {}

  // To be filled before build()
  Scene scene;
  std::vector<LampSettings> lamps;
  CameraSettings camera_settings;
  RenderOptions options;
  std::unique_ptr<NeighbouringFrames> frames;  // for data_passes(); or null: nothing moves

  // Acceleration structure, lights, photon maps, film. Throws Cancelled like every stage below.
  void build();
  // A whole pass: camera samples, and the photons of every photon map, which `elsewhere` splats if
  // there is one. Limits of time cut photons short, never camera samples.
  void render_pass(uint32_t pass, const PassLimits& limits = {},
                   ExternalSplatter* elsewhere = nullptr);
  // One sample per pixel of the unbiased path tracer instead of all that.
  void trace_reference(uint32_t sample);
  // No pass follows: gives back memory that passes alone need.
  void end_passes();

  // What the next pass has: camera samples in each pixel on average, and photons over those of the
  // first pass, by their work.
  struct PassSize {
    double samples = 1, photons = 1;
  };
  PassSize next_pass();
  // Camera samples in each pixel of the last pass, in the mean: not what next_pass() said where a
  // first pass has tried what paths can do.
  double samples_of_last_pass() const { return samples_of_last_pass_; }
  // Less in the passes to come; one camera sample in each pixel at the least.
  void limit_pass(const PassSize& most);

  // A part of a picture (RenderOptions::part) first has passes of no part, which all parts have in
  // common and which teach photon maps, radii and samples as those of a render do. The first pass
  // does this where it has not been done. Passes get smaller where `seconds` do not suffice, but
  // have one camera sample in each pixel. Returns the seconds of such a sample and of a first pass'
  // photons; zeros if nothing was to be done.
  PassSize learn_in_common(double seconds, ExternalSplatter* elsewhere = nullptr);

  // --- the stages of a pass ---
  // Camera samples with their direct light; gather points where photons are wanted.
  void trace_camera(uint32_t pass) { trace_camera(pass, PassClock(INFINITY)); }
  // The photon map that the following stages are about: 0, indirect light, at first; 1, caustics.
  size_t map_count() const { return maps_.size(); }
  void select_map(size_t i) { current_ = maps_.at(i).get(); }
  PhotonMap& map();
  const PhotonMaps& maps() const { return maps_; }
  // Photon paths of a pass in that map: 0 where camera paths bring all of its light. So many of
  // them are best traced and splatted at once: in memory they take no more than the points.
  uint64_t paths_per_pass() const;
  uint64_t paths_per_batch() const;
  // Visible points for the gather points; the first call traces the pilot that chooses radii.
  void place_points(uint32_t pass);
  // Adds the pass to the film, the points' irradiance with it. Until then the film is that of the
  // passes before.
  void resolve();

  // --- other views of the scene, after build(): renderer_view.cpp ---
  // Another camera: empties the film, so that passes begin anew.
  void set_view();
  // Other lamps, materials, textures or world on the same geometry: forgets film and photons.
  void relight();
  // Another render, with the camera set meanwhile, as if by a new renderer, but for the geometry,
  // the lights and kept photons. Lamps, materials, textures or world that are others as well:
  // relight() after it.
  void begin_again();
  // For a viewport: traces `paths` more photons that serve every view, `most_bytes` in memory.
  void trace_viewport_photons(uint64_t paths, size_t most_bytes);
  // One camera sample per pixel, lit indirectly by those photons; the film then holds it alone.
  void draw_viewport();
  // The same, but the light of surfaces is read from a cache of what pictures before have found,
  // and of the samples that this one adds to it: of `most_samples` pixels, 0..1, and where nothing
  // is known yet. `pixels`: of this picture, that cells are wide.
  void draw_from_cache(float pixels, float most_samples);
  // Gives the cache the light of the film that passes have made since set_view(), which stays.
  // `share`: of its samples that are new since it was given last. `pixels` as above. `picture`: the
  // film without its noise, RGBA of its pixels, exposed.
  void teach_light_cache(float pixels, float share, const float* picture);
  const LightCache& light_cache() const { return light_cache_; }
  // Of the last such picture.
  struct CacheCounts {
    uint64_t readings = 0, samples = 0;
  };
  const CacheCounts& cache_counts() const { return cache_counts_; }

  void cancel() { cancel_.set(); }
  // Takes cancel() back, when no stage runs.
  void resume() { cancel_.clear(); }
  const CancelFlag& cancel_flag() const { return cancel_; }

  // After build(); options.seed decides the samples.
  DataPasses data_passes(const DataLabels& labels, DataSettings settings);

  AdaptiveSampler& sampler() { return sampler_; }
  RenderFilm& film() { return film_; }
  const RenderFilm& film() const { return film_; }
  void make_error_estimate();
  RenderStatistics statistics();
  const StageSeconds& seconds() const { return seconds_; }
  // Points and photons of the selected map; nothing before build().
  const VisiblePoints& points() const { return current_ ? current_->points() : no_points_; }
  const Photons& photons() const { return current_ ? current_->photons() : no_photons_; }
  // Area lamps that lie in the plane of a surface.
  std::vector<Lights::InSurface> lights_in_surfaces() const;
  // Surfaces that lie exactly in each other, in view or beside it; nothing before build().
  std::vector<Coincident> coincident_surfaces() const;

 private:
  RenderContext context();
  void make_lights();
  void make_camera_pass();
  void make_maps();
  void make_beams();
  bool wants_indirect_beams();
  std::array<BeamMap*, 2> beam_maps() const {
    return {caustic_beams_.get(), indirect_beams_.get()};
  }
  void check_light_groups() const;
  void add_photons_to_samples();
  void read_light_cache();
  void reset_film();
  void finish_pass(bool whole);  // whole: it has samples of all pixels
  void trace_camera(uint32_t pass, const PassClock& clock);
  bool splat_photons(double seconds, uint64_t paths_per_batch, ExternalSplatter* elsewhere);

  CancelFlag cancel_;
  AdaptiveSampler sampler_;
  StageSeconds seconds_;
  size_t kept_bytes_ = 0;  // of photons kept by all maps
  bool gathers_ = false;   // see RenderContext
  std::unique_ptr<Lights> lights_;
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<CameraPass> camera_pass_;
  PhotonMaps maps_;
  std::unique_ptr<BeamMap> caustic_beams_, indirect_beams_;  // or null: there are none
  std::optional<bool> indirect_beams_wanted_;                // in this view, once that is known
  LightCache light_cache_;
  float cache_share_ = 1;  // of the samples that its cells want, in the next picture
  uint32_t cache_pictures_ = 0;
  CacheCounts cache_counts_;
  PhotonMap* current_ = nullptr;
  const VisiblePoints no_points_{};
  const Photons no_photons_{};
  RenderFilm film_;
  bool begun_ = false;   // the film has a pass, or what comes before has been learnt
  bool learns_ = false;  // passes teach, and are not for the film
  double samples_of_last_pass_ = 1;
  uint64_t bad_light_ = 0;  // gather points whose light from photons was not finite
};

}  // namespace photon_splat
