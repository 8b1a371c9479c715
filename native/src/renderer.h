// One render, stage by stage: each method is one stage of a pass, timed, and called in this order by the session.
#pragma once

#include <memory>
#include <optional>

#include "error_estimate.h"
#include "photon_store.h"
#include "splatter.h"
#include "visible_points.h"

namespace photon_splat {

struct RenderOptions {
  uint64_t photons_per_pass = 200000;
  int max_bounces = 32;
  float radius_scale = 1;
  float point_spacing = 1.0f / 3.0f;
  bool boundary_correction = true;
  uint32_t seed = 0;
  std::string kernel;  // of the splatter; empty: the fastest
};

struct StageSeconds {
  double acceleration = 0, camera = 0, photons = 0, splat = 0, boundary = 0, error = 0;
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

  // Camera samples of pass `pass`, direct light included, and records of where photons are wanted.
  void trace_camera(uint32_t pass);
  // Visible points for those records; the first call traces the pilot that chooses radii.
  void make_points(uint32_t pass);
  // Photon paths [first, first + count) of pass `pass`. Kept until the next call.
  void trace_photons(uint32_t pass, uint64_t first, uint64_t count);
  // Adds those photons to the points.
  void splat();
  // Instead of splat(), for a splatter elsewhere: which of the photons [first, first + count) each block may catch. That
  // splatter writes its sums into blocks().
  const Splatter& find_pairs(size_t first, size_t count);
  std::vector<PointBlock>& blocks() { return points_.blocks(); }
  // Instead of trace_photons(): photons made elsewhere.
  void set_photons(std::vector<Photon> photons);
  // Adds the pass to the film, the points' irradiance with it. Until then the film is that of the passes before.
  void resolve();
  // One sample per pixel of the unbiased path tracer instead of all of the above.
  void trace_reference(uint32_t sample);

  // For a viewport, after build(); see renderer_view.cpp. Another camera: empties the film, so that passes begin anew.
  void set_view();
  // Other lamps, materials, textures or world on the same geometry: forgets film and photons.
  void relight();
  // Traces `paths` more for the store, up to `most_bytes` of photons.
  void trace_store(uint64_t paths, size_t most_bytes);
  // One camera sample per pixel, lit indirectly by the photons of the store; traces none. The film then holds it alone.
  void draw_store();
  const PhotonStore* store() const { return store_ ? &*store_ : nullptr; }

  void cancel() { cancel_.set(); }
  // Takes cancel() back, when no stage runs.
  void resume() { cancel_.clear(); }
  const CancelFlag& cancel_flag() const { return cancel_; }

  const Film& film() const { return film_; }
  // How far the film may be from the truth; make_error_estimate() brings it up to date.
  const ErrorEstimate& errors() const { return errors_; }
  void make_error_estimate();
  const VisiblePoints& points() const { return points_; }
  const std::vector<Photon>& photons() const { return *photons_; }
  PhotonTracer& photon_tracer() { return *photon_tracer_; }
  const StageSeconds& seconds() const { return seconds_; }
  // Without the pilot, whose photons only choose radii; rays are all rays.
  PhotonCounts photon_counts() const;
  uint64_t pilot_paths() const { return pilot_.traced; }
  bool guided() const { return photon_tracer_ && photon_tracer_->guided(); }
  uint64_t rays() const;
  uint64_t bad_samples() const { return camera_tracer_ ? camera_tracer_->bad_samples() : 0; }
  std::string kernel_name() const { return splatter_ ? splatter_->kernel_name() : ""; }
  int threads() { return scene.pool().size(); }

 private:
  void require_built() const;
  void finish_pass();

  CancelFlag cancel_;
  std::unique_ptr<Lights> lights_;
  std::unique_ptr<Camera> camera_;
  std::unique_ptr<CameraTracer> camera_tracer_;
  std::unique_ptr<PhotonTracer> photon_tracer_;
  std::unique_ptr<RadiusMap> radii_;
  PhotonCounts pilot_;
  std::unique_ptr<Splatter> splatter_;
  VisiblePoints points_;
  std::optional<PhotonStore> store_;
  Film film_, pass_film_;
  ErrorEstimate errors_;
  const std::vector<Record>* records_ = nullptr;
  std::vector<Photon> given_photons_;
  const std::vector<Photon>* photons_ = &given_photons_;
  StageSeconds seconds_;
};

}  // namespace photon_splat
