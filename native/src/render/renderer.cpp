#include "render/renderer.h"

#include "render/cost_model.h"

namespace photon_splat {
namespace {

constexpr uint64_t kFewestPathsPerBatch = 1 << 17, kMostPathsPerBatch = 1 << 20;
// Where photons are kept, and found again by their batch
constexpr uint64_t kKeptPathsPerBatch = 1 << 18;
// Batches of a pass, at least, where another device splats one while the CPU traces the next; and
// paths in a batch, at least
constexpr uint64_t kBatchesElsewhere = 8, kFewestPathsElsewhere = 1 << 14;
// Of a part, before its own ones: radii and samples have been chosen twice or three times by then
constexpr uint32_t kCommonPasses = 4;
constexpr double kMostBeamsPerPath = 4;   // of indirect light
constexpr double kFewestInCommon = 0.25;  // of the photons that such a pass wants

}  // namespace

void Renderer::render_pass(uint32_t pass, const PassLimits& limits, ExternalSplatter* elsewhere) {
  learn_in_common(INFINITY, elsewhere);
  begun_ = true;
  PassClock clock(limits.seconds);
  const double before = seconds_.camera;
  // 1. Camera paths: direct light into the film, gather points where photons are wanted.
  trace_camera(pass, clock);
  clock.see_camera(seconds_.camera - before);
  for (size_t i = 0; i < maps_.size(); ++i) {  // indirect light, then caustics
    select_map(i);
    // 2. Visible points for the gather points, with kernel radii and masses.
    place_points(pass);
    // 3. Photons, batch by batch, each splatted onto the points that it reaches.
    const double seconds = clock.seconds_for_one_of(maps_.size() - i);
    if (!elsewhere || !splat_photons(seconds, limits.paths_per_batch, elsewhere))
      splat_photons(seconds, limits.paths_per_batch, nullptr);
  }
  // 4. The points' irradiance into the film; what the pass has shown chooses the next one.
  resolve();
}

// All photons of a pass in the selected map, or as many as there is time for; false where the
// splatter elsewhere gave up, which leaves the points as they were.
bool Renderer::splat_photons(double seconds, uint64_t paths_per_batch_wanted,
                             ExternalSplatter* elsewhere) {
  PhotonMap& map = this->map();
  const uint64_t wanted = paths_per_pass();
  uint64_t most = paths_per_batch_wanted ? paths_per_batch_wanted : paths_per_batch();
  if (elsewhere)
    most = std::min(
        std::max((wanted + kBatchesElsewhere - 1) / kBatchesElsewhere, kFewestPathsElsewhere),
        most);
  const bool whole = options.keeps_photons();
  const double end = PassClock::now() + seconds;
  if (elsewhere && !elsewhere->begin_pass()) return false;
  uint64_t traced = 0;
  while (traced < wanted) {
    const double began = PassClock::now();
    uint64_t batch =
        batch_that_fits(wanted - traced, most, end - began, map.seconds_per_path, whole);
    if (!batch && traced) break;
    if (!batch) batch = std::min({wanted, most, whole ? most : kFewestPaths});
    map.trace(traced, batch);
    if (!elsewhere)
      map.splat();
    else if (!elsewhere->add_photons())
      return false;
    traced += batch;
    map.seconds_per_path = (PassClock::now() - began) / static_cast<double>(batch);
  }
  if (elsewhere && !elsewhere->finish_pass()) return false;
  if (elsewhere) map.find_masses();
  if (traced < wanted) map.end_photons(traced);
  return true;
}

Renderer::PassSize Renderer::learn_in_common(double seconds, ExternalSplatter* elsewhere) {
  camera_pass_->follow_bumps(!elsewhere);  // which knows nothing of ways
  if (begun_ || options.part.whole()) return {0, 0};
  const double began = PassClock::now();
  const StageSeconds before = seconds_;
  const RenderPart part = options.part;
  PassSize of_one{0, 0};
  options.part = {};
  begun_ = learns_ = true;
  try {
    for (uint32_t pass = 0; pass < kCommonPasses; ++pass) {
      const double share = (seconds - (PassClock::now() - began)) / (kCommonPasses - pass);
      PassSize size = next_pass();
      const double fits = share / (of_one.samples * size.samples + of_one.photons * size.photons);
      if (fits < 1) {
        limit_pass(
            {std::max(1.0, fits * size.samples), std::max(fits, kFewestInCommon) * size.photons});
        size = next_pass();
      }
      const StageSeconds so_far = seconds_;
      render_pass(pass, {}, elsewhere);
      of_one = {(seconds_.camera - so_far.camera) / samples_of_last_pass_,
                (seconds_.with_photons() - so_far.with_photons()) / size.photons};
    }
  } catch (...) {
    options.part = part;
    begun_ = learns_ = false;
    throw;
  }
  options.part = part;
  learns_ = false;
  bad_light_ = 0;
  camera_pass_->begin_part();
  for (const auto& map : maps_) map->begin_part();
  for (BeamMap* const beams : beam_maps())
    if (beams) beams->begin_part();
  const double took = PassClock::now() - began;
  seconds_ = before;
  seconds_.pilot += took;
  seconds_.photons += took;
  return of_one;
}

DataPasses Renderer::data_passes(const DataLabels& labels, DataSettings settings) {
  settings.seed = stream_seed(options.seed, RandomStream::kCamera);
  return trace_data_passes(scene, *camera_, labels, settings, cancel_);
}

RenderContext Renderer::context() {
  return {scene, options, cancel_, sampler_, seconds_, kept_bytes_, gathers_};
}

void Renderer::build() {
  Timer timer(seconds_.acceleration);
  camera_ = std::make_unique<Camera>(camera_settings);
  choose_kernel(options.kernel);  // speaks up before work is done
  check_light_groups();
  scene.build(cancel_);
  make_lights();
  make_camera_pass();
  make_maps();
  reset_film();
}

void Renderer::make_lights() {
  lights_ = std::make_unique<Lights>(scene, lamps);
  focus_on_geometry(scene, *lights_);
}

void Renderer::make_camera_pass() {
  camera_pass_ = std::make_unique<CameraPass>(context(), *lights_, *camera_);
}

void Renderer::make_maps() {
  maps_.clear();
  light_cache_ = LightCache();
  cache_share_ = 1;
  kept_bytes_ = 0;
  const bool caustics = options.caustics && (scene.features() & kProgramSharp);
  const auto add = [&](PhotonStream stream) {
    maps_.push_back(std::make_unique<PhotonMap>(context(), *lights_,
                                                options.keeps_photons() ? nullptr : camera_.get(),
                                                stream, maps_.size()));
  };
  add(caustics ? PhotonStream::kIndirect : PhotonStream::kAll);
  if (caustics) add(PhotonStream::kCaustic);
  current_ = maps_.front().get();
  make_beams();
}

// Photon beams for light in media: caustics where the scene can have some, and the rest of what
// photons bring where media are the same everywhere, hide from no ray (beams do not know by what
// rays they are seen) and nothing moves (a path sees what is there at its own time, and no beam of
// another).
void Renderer::make_beams() {
  caustic_beams_.reset();
  indirect_beams_.reset();
  indirect_beams_wanted_.reset();
  if (!options.photons_per_pass || !scene.scatters_in_media()) return;
  const bool caustics = maps_.size() > 1;
  if (caustics)
    caustic_beams_ = std::make_unique<BeamMap>(context(), *lights_, *camera_, BeamLight::kCaustic,
                                               PhotonStream::kCaustic);
  if (scene.media()->any_homogeneous() && !scene.media()->hides() && !scene.needs_paths() &&
      !scene.moves())
    indirect_beams_ =
        std::make_unique<BeamMap>(context(), *lights_, *camera_, BeamLight::kIndirect,
                                  caustics ? PhotonStream::kIndirect : PhotonStream::kAll);
}

// Asked in the first pass of a view. Paths in dense media scatter so often that few of them make
// all of the beams: their noise would be that of the whole picture.
bool Renderer::wants_indirect_beams() {
  if (!indirect_beams_) return false;
  if (!indirect_beams_wanted_)
    indirect_beams_wanted_ =
        !options.adaptive_indirect || (indirect_beams_->beams_per_path() <= kMostBeamsPerPath &&
                                       camera_pass_->wants_indirect_beams(maps_));
  return *indirect_beams_wanted_;
}

void Renderer::check_light_groups() const {
  const auto check = [&](int16_t group) {
    if (group < kNoLightGroup || group >= scene.light_groups)
      throw std::invalid_argument("a light is of a light group that does not exist");
  };
  for (const LampSettings& lamp : lamps) check(lamp.light_group);
  for (const Instance& instance : scene.instances) check(instance.light_group);
  check(scene.world_light_group);
}

void Renderer::reset_film() {
  film_.reset(camera_settings.region_width, camera_settings.region_height, scene.light_groups);
  bad_light_ = 0;
  begun_ = false;
  gathers_ = options.gathers();
  camera_pass_->reset_view(film_.sum(), maps_);
  indirect_beams_wanted_.reset();
  for (BeamMap* const beams : beam_maps())
    if (beams) beams->begin_again();
  for (const auto& map : maps_) map->reset_view(film_.sum().width, film_.sum().height);
}

PhotonMap& Renderer::map() {
  if (!current_) throw std::logic_error("build() comes before the other stages");
  return *current_;
}

Renderer::PassSize Renderer::next_pass() {
  if (!options.adaptive_samples) return {};
  sampler_.begin_pass(scene.pool());
  return {sampler_.mean_count(), sampler_.photon_count()};
}

void Renderer::limit_pass(const PassSize& most) {
  if (options.adaptive_samples) sampler_.limit(most.samples, most.photons, scene.pool());
}

void Renderer::trace_camera(uint32_t pass, const PassClock& clock) {
  map();
  if (caustic_beams_) {
    if (!caustic_beams_->learnt()) {
      camera_pass_->set_beams({});
      caustic_beams_->set_variance_beside(camera_pass_->variance_beside_beams(maps_));
    }
    caustic_beams_->trace_pass();
  }
  CameraTracer::Beams beams{caustic_beams_ ? &caustic_beams_->tree() : nullptr, nullptr};
  camera_pass_->set_beams(beams);
  if (wants_indirect_beams()) {
    indirect_beams_->trace_pass();
    beams.indirect = &indirect_beams_->tree();
    camera_pass_->set_beams(beams);
  }
  camera_pass_->trace(pass, maps_, film_.begin_pass(), clock);
}

uint64_t Renderer::paths_per_pass() const {
  return current_ && !camera_pass_->path_traced(*current_) ? current_->paths_per_pass() : 0;
}

uint64_t Renderer::paths_per_batch() const {
  if (options.keeps_photons()) return kKeptPathsPerBatch;
  return std::clamp<uint64_t>(cost::kPathsPerPoint * points().size(), kFewestPathsPerBatch,
                              kMostPathsPerBatch);
}

void Renderer::place_points(uint32_t pass) {
  PhotonMap& map = this->map();
  const GatherPoints* gather_points = camera_pass_->gather_points();
  if (!gather_points) throw std::logic_error("trace_camera() comes before place_points()");
  if (camera_pass_->path_traced(map)) return map.clear_points();
  if (!map.learnt()) camera_pass_->teach(map);
  map.place_points(*gather_points, pass);
  map.see_light(*gather_points, film_.pass());
}

void Renderer::resolve() {
  map();
  if (!camera_pass_->gather_points())
    throw std::logic_error("trace_camera() comes before resolve()");
  samples_of_last_pass_ = sampler_.mean_count();
  const bool whole = !sampler_.lacks_pixels(), adaptive = options.adaptive_samples && whole;
  Timer timer(seconds_.splat);
  PackedFilm& pass = film_.pass();
  const GatherPoints& gather_points = *camera_pass_->gather_points();
  const std::vector<size_t>& ranges = camera_pass_->tile_ranges();
  std::vector<PhotonMap*> used;
  for (const auto& map : maps_)
    if (!camera_pass_->path_traced(*map)) used.push_back(map.get());
  for (PhotonMap* map : used) map->join_light_groups();
  // What paths have gathered is the camera's noise: the adaptive sampler sees it with the rest.
  if (camera_pass_->paths_continue())
    for (PhotonMap* map : used) bad_light_ += map->add_to_film(gather_points, ranges, true, pass);
  if (adaptive) sampler_.see_camera(pass, scene.pool());
  for (PhotonMap* map : used) {
    bad_light_ += map->add_to_film(gather_points, ranges, false, pass);
    map->adapt_radii();
  }
  if (adaptive) {
    PassWork work;
    work.samples = camera_pass_->work_of_samples(pass);
    for (size_t i = 0; i < maps_.size(); ++i) sampler_.photons(i).work = 0;
    for (size_t i = 0; i < maps_.size(); ++i) {
      if (camera_pass_->path_traced(*maps_[i])) continue;
      sampler_.photons(i).work = maps_[i]->work();
      if (!options.keeps_photons())
        work.fixed += cost::kPointBoundary * static_cast<double>(maps_[i]->points().size());
    }
    sampler_.end_pass(pass, work, scene.pool());
  } else {
    sampler_.count_pass();
  }
  for (const auto& map : maps_) map->end_pass();
  camera_pass_->look_for_crowds(film_.sum().passes);
  finish_pass(whole);
}

void Renderer::finish_pass(bool whole) {
  if (learns_) return;
  if (whole) {
    Timer timer(seconds_.error);
    film_.errors().add(film_.pass(), scene.pool());
  }
  film_.end_pass(scene.pool());
}

void Renderer::trace_reference(uint32_t sample) {
  map();
  if (!begun_ && !options.part.whole()) camera_pass_->begin_part();
  begun_ = true;
  camera_pass_->trace_reference(sample, film_.begin_pass());
  finish_pass(true);
}

void Renderer::make_error_estimate() {
  map();
  Timer timer(seconds_.error);
  film_.errors().update(scene.pool());
}

void Renderer::end_passes() {
  if (camera_pass_) camera_pass_->forget_gather_points();
  film_.end_passes();
}

std::vector<Lights::InSurface> Renderer::lights_in_surfaces() const {
  return lights_ ? lights_->in_surfaces() : std::vector<Lights::InSurface>{};
}

std::vector<Coincident> Renderer::coincident_surfaces() const {
  return camera_ ? photon_splat::coincident_surfaces(scene, *camera_) : std::vector<Coincident>{};
}

RenderStatistics Renderer::statistics() {
  RenderStatistics out;
  out.seconds = seconds_;
  out.threads = scene.pool().size();
  out.threads_wanted = scene.pool().wanted();
  out.visible_points = points().size();
  out.bad_samples = bad_light_;
  out.error = film_.errors().figures();
  if (!current_) return out;
  out.kernel = current_->kernel_name();
  const CameraTracer& camera = camera_pass_->tracer();
  out.rays = camera.rays();
  for (const auto& map : maps_) {
    out.maps.push_back(map->statistics());
    out.rays += map->rays();
  }
  for (const BeamMap* const beams : beam_maps()) {
    if (!beams) continue;
    out.beams += beams->counts();
    out.rays += beams->counts().rays;
  }
  out.kept_photon_bytes = kept_bytes_;
  out.bad_samples += camera.bad_samples();
  out.places = camera.places();
  out.path_traced = camera.continued();
  out.all_path_traced = camera_pass_->all_path_traced();
  out.gathers_after_all = gathers_ && !options.gathers();
  out.world_path_traced = lights_ && lights_->world_by_paths();
  return out;
}

}  // namespace photon_splat
