// One render, stage by stage: each method is one stage of a pass, timed, and called in this order
// by the session. Photons come in layers: indirect light, and caustics where something can make
// them. Stages from make_points() to splat() are called for each layer in turn, after
// select_layer().
#pragma once

#include <memory>
#include <optional>

#include "density/radius_choice.h"
#include "density/splatter.h"
#include "density/visible_points.h"
#include "film/error_estimate.h"
#include "film/sample_choice.h"
#include "photons/photon_slices.h"
#include "photons/photon_store.h"
#include "photons/seen_places.h"

namespace photon_splat {

struct RenderOptions {
  uint64_t photons_per_pass = 200000;
  int max_bounces = 32;
  float radius_scale = 1;
  float point_spacing = 1.0f / 3.0f;
  bool boundary_correction = true;
  // Photons of their own for caustics, where the scene can make them; else in with the others
  bool caustics = true;
  bool force_caustics = false;  // even where it cannot: for tests of what that costs
  bool adaptive_radius = true;
  bool adaptive_samples = true;
  bool occlusion = true;      // inside of discs; part of the boundary correction
  bool fallback = true;       // camera paths go on for indirect light where photons serve badly
  bool final_gather = false;  // they go on everywhere once, and photons light what they meet
  // Or they bring all of the indirect light, caustics excepted, where a trial finds that less work
  // (GatherTrial)
  bool gather_trial = false;
  uint32_t seed = 0;
  std::string kernel;  // of the splatter; empty: the fastest
  // Of photons that renders of other views find again (begin_again). 0: none, and photons are aimed
  // at what the view sees; else each pass has the same photons and radii whatever the view, beyond
  // this budget traced again.
  size_t kept_photon_bytes = 0;
  float fixed_radius = 0;  // of all discs in all passes, metres; 0: chosen. For comparison
};

// What photons of one light group have added to a block of points.
struct alignas(64) GroupSums {
  float r[kBlockSize], g[kBlockSize], b[kBlockSize];
};

struct StageSeconds {
  double acceleration = 0, camera = 0, photons = 0, splat = 0, boundary = 0, error = 0;
  double pilot = 0;  // of those: what a render's first pass does beyond any other
};

// Photons of one kind and the points they are splatted on, with kernels of their own.
struct Layer {
  PhotonStream stream;
  double photons_per_disc;
  uint32_t seed;
  uint64_t paths_per_pass;
  std::unique_ptr<PhotonTracer> tracer;
  std::unique_ptr<RadiusMap> radii{};
  PhotonCounts pilot{};
  // Of the power of caustic photons: their noise over that of equal ones
  float dispersion = 1;
  std::unique_ptr<Splatter> splatter{};
  VisiblePoints points{};
  // Of each light group, one for each block of points, which hold the rest until resolve()
  std::vector<GroupSums> group_sums{};
  RadiusChoice choice{};
  std::optional<PhotonStore> store{};
  PhotonSlices kept{};
  PhotonCounts before{};  // of the tracer when this render began
  // Photons handed to the splatter in this render; those of them that were kept
  uint64_t used = 0, reused = 0;
  size_t index = 0;                        // among the layers
  uint64_t first_path = 0;                 // of this pass: so many were of the passes before
  uint64_t last_paths = 0, last_used = 0;  // of the last batch: paths, and the photons they left
};

class Renderer {
 public:
  explicit Renderer(int threads) : scene(threads) {}

  Scene scene;                      // to be filled before build()
  std::vector<LampSettings> lamps;  // likewise
  CameraSettings camera_settings;   // likewise
  RenderOptions options;            // likewise

  // Acceleration structure, lights, film. Throws Cancelled like every stage below.
  void build();
  std::vector<Lights::InSurface> lamps_in_surfaces() const {
    return lights_ ? lights_->in_surfaces() : std::vector<Lights::InSurface>{};
  }

  // Camera samples of pass `pass`, direct light included, and records of where photons are wanted.
  void trace_camera(uint32_t pass);
  size_t layer_count() const { return layers_.size(); }
  const Layer& layer(size_t i) const { return *layers_.at(i); }
  // The layer that the following stages are about; 0, the indirect light, at first.
  void select_layer(size_t i) { current_ = layers_.at(i).get(); }
  // What the next pass has: camera samples in each pixel on average, and photons over those of the
  // first pass, by their work.
  struct PassSize {
    double samples = 1, photons = 1;
  };
  PassSize next_pass();
  // Less in the passes to come; one camera sample in each pixel at the least.
  void limit_pass(const PassSize& most);
  // Photon paths of a pass in the selected layer: 0 where camera paths bring all of its light, as
  // the first trace_camera() may find. So many of them are best traced and splatted at once: in
  // memory they take no more than the points, and rarely look at each.
  uint64_t paths_per_batch() const;
  uint64_t paths_per_pass() const { return current_ && !idle(*current_) ? paths_of(*current_) : 0; }
  // Visible points for those records; the first call traces the pilot that chooses radii.
  void make_points(uint32_t pass);
  // Photon paths [first, first + count) of the pass that trace_camera() has begun. Kept until the
  // next call.
  void trace_photons(uint64_t first, uint64_t count);
  // Adds those photons to the points.
  void splat();
  // No more of the pass' photons come in the selected layer than `paths` of them have brought:
  // their light counts for all.
  void end_photons(uint64_t paths);
  // Instead of splat(), for a splatter elsewhere: which of the photons [first, first + count) each
  // block may catch. That splatter writes its sums into blocks().
  const Splatter& find_pairs(size_t first, size_t count);
  PointBlocks& blocks() { return selected().points.blocks(); }
  // Instead of trace_photons(): photons made elsewhere.
  void set_photons(Photons photons);
  // Adds the pass to the film, the points' irradiance with it. Until then the film is that of the
  // passes before.
  void resolve();
  // One sample per pixel of the unbiased path tracer instead of all of the above.
  void trace_reference(uint32_t sample);

  // For a viewport, after build(); see renderer_view.cpp. Another camera: empties the film, so that
  // passes begin anew.
  void set_view();
  // Other lamps, materials, textures or world on the same geometry: forgets film and photons.
  void relight();
  // After build(): another render, with the camera set meanwhile, as if by a new renderer, but for
  // the geometry, the lights and kept photons. Lamps, materials, textures or world that are others
  // as well: relight() after it.
  void begin_again();
  // Traces `paths` more for the store, up to `most_bytes` of photons.
  void trace_store(uint64_t paths, size_t most_bytes);
  // One camera sample per pixel, lit indirectly by the photons of the store; traces none. The film
  // then holds it alone.
  void draw_store();

  void cancel() { cancel_.set(); }
  // Takes cancel() back, when no stage runs.
  void resume() { cancel_.clear(); }
  const CancelFlag& cancel_flag() const { return cancel_; }

  const PackedFilm& packed_film() const { return film_; }
  // All of it at once, for tests: a copy, until it is asked for again.
  const Film& film() const;
  // Which channels of pixels the film is to have, before build(), set_view() or begin_again(); what
  // passes need is among them.
  void keep_channels(ChannelMask channels) {
    film_.kept = pass_film_.kept = channels | channels_of_passes();
  }
  // No pass follows: gives back memory that passes alone need.
  void end_passes();
  size_t film_bytes() const { return film_.bytes() + pass_film_.bytes(); }
  // How far the film may be from the truth; make_error_estimate() brings it up to date.
  const ErrorEstimate& errors() const { return errors_; }
  void make_error_estimate();
  const VisiblePoints& points() const { return current_ ? current_->points : no_points_; }
  const Photons& photons() const { return *photons_; }
  PhotonTracer& photon_tracer() { return *selected().tracer; }
  const StageSeconds& seconds() const { return seconds_; }
  // Of one layer in this render, without its pilot, whose photons only choose radii; rays are all
  // rays.
  PhotonCounts photon_counts(const Layer& layer) const;
  uint64_t rays() const;
  size_t kept_photon_bytes() const;
  // Places where indirect light was wanted, and those where camera paths went on for it.
  uint64_t places() const { return camera_tracer_ ? camera_tracer_->places() : 0; }
  bool paths_bring_all() const { return fallback_ && fallback_->reach() == Fallback::Reach::kAll; }
  uint64_t fallbacks() const { return camera_tracer_ ? camera_tracer_->fallbacks() : 0; }
  uint64_t bad_samples() const {
    return bad_light_ + (camera_tracer_ ? camera_tracer_->bad_samples() : 0);
  }
  std::string kernel_name() const { return current_ ? current_->splatter->kernel_name() : ""; }
  int threads() { return scene.pool().size(); }
  int threads_wanted() { return scene.pool().wanted(); }

 private:
  void finish_pass();
  void focus_on_geometry();
  std::optional<SeenPlaces> focus_on_view();
  PassWork take_work();
  uint64_t paths_of(const Layer& layer) const;
  Layer& selected() const;
  void add_layer(PhotonStream stream, double photons_per_disc, uint64_t paths_per_pass);
  void make_layers();
  void learn(Layer& layer, const KeyFilter& seen, bool stores_all);
  void trace_records(uint32_t pass, CameraTracer::Tiles tiles = CameraTracer::Tiles::kAll);
  bool idle(const Layer& layer) const;
  bool try_paths(uint32_t pass);
  void make_fallback(const KeyFilter& known);
  void forget_fallback();
  void look_for_crowds(uint32_t pass);
  bool photons_pay() const;
  void learn_fallback(uint32_t pass, bool scouts);
  bool trace_more(uint32_t pass, CameraTracer::Tiles tiles);
  KeyFilter keys_seen(const Layer& layer) const;
  // Of photons that are kept: none, as they serve all views.
  const Camera* viewer() const { return options.kept_photon_bytes ? nullptr : camera_.get(); }
  float radius_factor(const Layer& layer) const;
  void add_irradiance(Layer& layer, bool wandered);
  void check_light_groups() const;
  void splat_groups(Layer& layer);
  void swap_sums(Layer& layer, int group);
  void join_groups(Layer& layer);
  void reset_film();
  void begin_pass_film();
  void learn_sky_anew();

  CancelFlag cancel_;
  std::unique_ptr<Lights> lights_;
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<CameraTracer> camera_tracer_;
  std::vector<std::unique_ptr<Layer>> layers_;
  std::optional<Fallback> fallback_;
  bool fallback_learnt_ = false;
  bool view_is_focused_ = false;  // photons start about what this view sees
  Vec3 middle_{};                 // of that
  // Half of it is no further from there, m; infinite where photons serve all views
  float reach_ = INFINITY;
  Layer* current_ = nullptr;
  VisiblePoints no_points_;
  PackedFilm film_, pass_film_;
  mutable Film unpacked_;
  mutable bool is_unpacked_ = false;
  uint64_t bad_light_ = 0;  // records whose light from photons was not finite
  SampleChoice samples_;
  SkyGuide sky_;
  ErrorEstimate errors_;
  const Records* records_ = nullptr;
  Photons given_photons_;
  const Photons* photons_ = &given_photons_;
  const std::vector<int16_t>* photon_groups_ = &no_groups_;  // of those photons, or empty
  const std::vector<int16_t> no_groups_;
  Photons part_;  // of them: one group's
  StageSeconds seconds_;
};

}  // namespace photon_splat
