// What a viewport asks of the renderer: another camera without another build, and pictures from photons that are kept.
#include "renderer.h"

namespace photon_splat {
namespace {

// A view from the store is splatted once, not averaged over passes: more photons in each disc than a pass of a render has.
constexpr double kStorePhotonsPerDisc = 200;
// Radii shrink until the store has so many photons: more of them make the picture less noisy instead of sharper.
constexpr double kStorePhotons = 1 << 17;

}  // namespace

void Renderer::set_view() {
  require_built();
  *camera_ = Camera(camera_settings);
  film_.reset(camera_settings.region_width, camera_settings.region_height);
  pass_film_.reset(film_.width, film_.height);
  errors_.reset(film_.width, film_.height);
  records_ = nullptr;
  radii_.reset();
}

void Renderer::relight() {
  require_built();
  lights_ = std::make_unique<Lights>(scene, lamps);
  camera_tracer_ = std::make_unique<CameraTracer>(scene, *lights_, *camera_, hash_combine(options.seed, 2));
  photon_tracer_ = std::make_unique<PhotonTracer>(scene, *lights_, options.max_bounces);
  store_.reset();
  photons_ = &given_photons_;
  set_view();
}

void Renderer::trace_store(uint64_t paths, size_t most_bytes) {
  require_built();
  if (!store_) store_.emplace(scene, *lights_, options.max_bounces, hash_combine(options.seed, 5));
  store_->trace(paths, most_bytes, cancel_);
}

void Renderer::draw_store() {
  require_built();
  if (!store_ || !store_->radii()) throw std::logic_error("trace_store() comes before draw_store()");
  set_view();
  trace_camera(0);
  PointSettings s;
  s.photons_per_disc = kStorePhotonsPerDisc;
  const double paths = static_cast<double>(store_->paths()), photons = static_cast<double>(store_->photons().size());
  s.paths_per_pass = paths * std::min(1.0, kStorePhotons / std::max(photons, 1.0));
  s.radius_factor = options.radius_scale;
  s.spacing = options.point_spacing;
  s.steady = true;
  points_.build(scene, *records_, *store_->radii(), s, 0, options.seed, cancel_);
  if (options.boundary_correction) points_.correct_boundaries(scene, cancel_);
  splatter_->set_blocks(points_.block_bounds());
  splatter_->splat(store_->photons(), points_.blocks(), scene.pool(), cancel_);
  const float share = static_cast<float>(1.0 / static_cast<double>(store_->paths()));
  for (PointBlock& block : points_.blocks())
    for (float* scales : {block.scale, block.narrow_scale})
      for (uint32_t lane = 0; lane < kBlockSize; ++lane) scales[lane] *= share;
  resolve();
  records_ = nullptr;
}

}  // namespace photon_splat
