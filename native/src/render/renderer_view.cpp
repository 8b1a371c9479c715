// Another camera without another build: for renders of the same scene, and for a viewport, whose
// pictures come from a store.
#include "render/renderer.h"
#include "shading/sees_view.h"

namespace photon_splat {
namespace {

// A view from the store is splatted once, not averaged over passes: so many times the photons in
// each disc of a render's pass.
constexpr double kStoreMore = 2;
// Radii shrink until the store has so many photons: more of them make the picture less noisy
// instead of sharper.
constexpr double kStorePhotons = 1 << 17;

}  // namespace

void Renderer::set_view() {
  selected();
  *camera_ = Camera(camera_settings);
  learn_sky_anew();
  reset_film();
  records_ = nullptr;
  if (!options.kept_photon_bytes)
    for (const auto& layer : layers_) layer->radii.reset();  // of what the last view saw
}

void Renderer::relight() {
  selected();
  check_light_groups();
  scene.update_features();
  lights_ = std::make_unique<Lights>(scene, lamps);
  focus_on_geometry();
  camera_tracer_ =
      std::make_unique<CameraTracer>(scene, *lights_, *camera_, hash_combine(options.seed, 2));
  set_photons({});
  make_layers();
  set_view();
}

void Renderer::begin_again() {
  selected();
  seconds_ = {};
  set_photons({});
  if (std::any_of(scene.programs.begin(), scene.programs.end(), sees_view)) return relight();
  learn_sky_anew();
  camera_tracer_ =
      std::make_unique<CameraTracer>(scene, *lights_, *camera_, hash_combine(options.seed, 2));
  for (const auto& layer : layers_) {
    layer->before = layer->tracer->counts();
    layer->pilot = {};
    layer->used = layer->reused = 0;
    layer->points = {};
    layer->splatter = std::make_unique<Splatter>(options.kernel);
  }
  current_ = layers_.front().get();
  set_view();
}

void Renderer::trace_store(uint64_t paths, size_t most_bytes) {
  selected();
  for (const auto& layer : layers_) {
    if (!layer->store)
      layer->store.emplace(scene, *lights_, options.max_bounces, layer->stream,
                           hash_combine(layer->seed, 5));
    layer->store->trace(paths, most_bytes / layers_.size(), cancel_);
  }
}

void Renderer::draw_store() {
  for (const auto& layer : layers_)
    if (!layer->store || !layer->store->radii())
      throw std::logic_error("trace_store() comes before draw_store()");
  set_view();
  trace_records(0);
  for (const auto& layer : layers_) {
    const PhotonStore& store = *layer->store;
    PointSettings s;
    s.photons_per_disc = kStoreMore * layer->photons_per_disc;
    const double paths = static_cast<double>(store.paths()),
                 photons = static_cast<double>(store.photons().size());
    s.paths_per_pass = paths * std::min(1.0, kStorePhotons / std::max(photons, 1.0));
    s.radius_factor = options.radius_scale;
    s.spacing = options.point_spacing;
    s.occlusion = options.boundary_correction && options.occlusion;
    s.caustics = layer->stream == PhotonStream::kCaustic;
    s.steady = true;
    layer->points.build(scene, *records_, *store.radii(), s, 0, layer->seed, cancel_);
    // All of the light is the rest
    layer->group_sums.assign(layer->points.blocks().size() * scene.light_groups, GroupSums{});
    if (options.boundary_correction) layer->points.correct_boundaries(scene, cancel_);
    layer->splatter->set_blocks(layer->points.block_bounds());
    layer->splatter->splat(store.photons(), layer->points.blocks(), scene.pool(), cancel_);
    const float share = static_cast<float>(1.0 / paths);
    for (PointBlock& block : layer->points.blocks())
      for (float* scales : {block.scale, block.narrow_scale})
        for (uint32_t lane = 0; lane < kBlockSize; ++lane) scales[lane] *= share;
  }
  resolve();
  records_ = nullptr;
}

}  // namespace photon_splat
