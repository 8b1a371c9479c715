#include "render/renderer.h"

#include <atomic>
#include <chrono>
#include <tuple>

namespace photon_splat {
namespace {

constexpr uint64_t kPilotPaths = 65536;
constexpr double kPhotonsPerDisc = 200;  // from one pass, before radii shrink
constexpr double kCausticPhotonsPerDisc = 25;
// At most one record of so many lies on a surface that scouts have not seen, or the pilot is traced
// again
constexpr size_t kUnscouted = 16;
// Of a pixel in a pass where photons light what paths meet: theirs is most of the noise
constexpr uint32_t kGatheredSamples = 4;
constexpr uint32_t kPathSamples = 16;  // the same where paths bring all of the indirect light
// Photon in a disc: squared relative error of what an Epanechnikov kernel makes of it
constexpr float kNoiseOfOne = 4.0f / 3;
constexpr size_t kLooksForFocus = 4096;  // places that tell what photons are to start about
constexpr double kServedWell = 0.5;      // share of places
// Of a pass' photons, that the adaptive choice may come down to
constexpr double kLeastOfPhotons = 0.25;
constexpr size_t kLaterLooks = 16;  // one record in so many, in each pass but the first
// Times that of points that are seen: a pixel's paths meet many
constexpr float kGatheredSpacing = 2;
constexpr uint64_t kPathsPerPoint = 4, kFewestPathsPerBatch = 1 << 17, kMostPathsPerBatch = 1 << 20;
// Where photons are kept, and found again by their batch
constexpr uint64_t kKeptPathsPerBatch = 1 << 18;
// h ~ paths^(-1/6): variance and squared bias fall alike (Knaus & Zwicker 2011)
constexpr double kShrinkExponent = -1.0 / 6.0;

class Timer {
 public:
  explicit Timer(double& sum) : sum_(sum) {}
  ~Timer() {
    sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double& sum_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

PhotonCounts since(const PhotonCounts& before, const PhotonCounts& now) {
  return {now.traced - before.traced, now.stored - before.stored, now.rays - before.rays,
          now.shaded - before.shaded};
}

// In camera rays with their shading: see take_work().
double work_of(const PhotonCounts& counts) {
  return static_cast<double>(counts.rays) / 3 + 1.2 * static_cast<double>(counts.shaded) +
         2.0 * static_cast<double>(counts.stored);
}

}  // namespace

void Renderer::add_layer(PhotonStream stream, double photons_per_disc, uint64_t paths_per_pass) {
  const uint32_t seed =
      stream == PhotonStream::kCaustic ? hash_combine(options.seed, 5) : options.seed;
  auto layer =
      std::make_unique<Layer>(Layer{stream, photons_per_disc, seed, paths_per_pass, nullptr});
  // Where photons light what paths meet one bounce on, theirs are one less.
  const int bounces =
      std::max(0, options.max_bounces - (options.final_gather && stream != PhotonStream::kCaustic));
  layer->tracer = std::make_unique<PhotonTracer>(scene, *lights_, bounces, stream);
  layer->index = layers_.size();
  layer->splatter = std::make_unique<Splatter>(options.kernel);
  if (scene.light_groups) layer->tracer->keep_light_groups();
  layers_.push_back(std::move(layer));
}

void Renderer::build() {
  Timer timer(seconds_.acceleration);
  camera_ = std::make_unique<Camera>(camera_settings);
  choose_kernel(options.kernel);  // speaks up before work is done
  check_light_groups();
  scene.build(cancel_);
  lights_ = std::make_unique<Lights>(scene, lamps);
  focus_on_geometry();
  learn_sky_anew();
  camera_tracer_ =
      std::make_unique<CameraTracer>(scene, *lights_, *camera_, hash_combine(options.seed, 2));
  make_layers();
  reset_film();
}

void Renderer::learn_sky_anew() {
  sky_.reset(lights_->environment());
  lights_->set_guide(&sky_);
}

void Renderer::reset_film() {
  film_.reset(camera_settings.region_width, camera_settings.region_height, scene.light_groups);
  bad_light_ = 0;
  is_unpacked_ = false;
  errors_.reset(film_.width, film_.height);
  std::vector<PhotonSet> photons(layers_.size());
  for (const auto& layer : layers_) {
    PhotonSet& set = photons[layer->index];
    // What photons do to paths that end at them passes for the camera's noise.
    if (options.final_gather && layer->stream != PhotonStream::kCaustic) set.fewest = 1;
    if (options.kept_photon_bytes) set.fewest = set.most = 1;
  }
  samples_.reset(film_.width, film_.height, options.final_gather ? kGatheredSamples : 1,
                 std::move(photons));
  for (const auto& layer : layers_) {
    layer->choice.reset(film_.width, film_.height);
    layer->first_path = 0;
    layer->points.forget_clear_regions();
  }
  fallback_.reset();  // of other records
  fallback_learnt_ = view_is_focused_ = false;
  reach_ = INFINITY;
}

void Renderer::begin_pass_film() {
  pass_film_.reset(film_.width, film_.height, film_.light_groups);
}

void Renderer::make_layers() {
  layers_.clear();
  const bool caustics =
      options.caustics && (options.force_caustics || scene.features() & kProgramSharp);
  add_layer(caustics ? PhotonStream::kIndirect : PhotonStream::kAll, kPhotonsPerDisc,
            options.photons_per_pass);
  if (caustics) add_layer(PhotonStream::kCaustic, kCausticPhotonsPerDisc, options.photons_per_pass);
  current_ = layers_.front().get();
}

Layer& Renderer::selected() const {
  if (!current_) throw std::logic_error("build() comes before the other stages");
  return *current_;
}

float Renderer::radius_factor(const Layer& layer) const {
  const double paths = static_cast<double>(layer.first_path + paths_of(layer));
  return options.radius_scale *
         static_cast<float>(std::pow(
             std::max(1.0, paths / std::max(1.0, double(layer.paths_per_pass))), kShrinkExponent));
}

void Renderer::trace_records(uint32_t pass, CameraTracer::Tiles tiles) {
  Timer timer(seconds_.camera);
  camera_tracer_->set_fallback(fallback_ ? &*fallback_ : nullptr, layers_.size() > 1,
                               radius_factor(*layers_.front()));
  begin_pass_film();
  samples_.begin_pass(scene.pool());
  records_ =
      &camera_tracer_->trace(pass, samples_, sky_, options.max_bounces, pass_film_, cancel_, tiles);
}

void Renderer::trace_camera(uint32_t pass) {
  Layer& indirect = (selected(), *layers_.front());
  const bool photons = indirect.paths_per_pass > 0,
             learns = !fallback_learnt_ && options.fallback && photons;
  const bool by_view = learns && !options.kept_photon_bytes;
  if (!fallback_ && options.final_gather && photons) {
    if (options.gather_trial && by_view && try_paths(pass)) return;
    fallback_.emplace(scene, Fallback::Reach::kFirst);
  }
  if (learns && !by_view) {  // the pilot asks for no view
    const KeyFilter all = keys_seen(indirect);
    if (!indirect.radii) learn(indirect, all, false);
    make_fallback(all);
  }
  const bool scouts = by_view && CameraTracer::sends_scouts(film_);
  trace_records(pass, scouts ? CameraTracer::Tiles::kScouts : CameraTracer::Tiles::kAll);
  if (by_view)
    learn_fallback(pass, scouts);
  else if (learns && !camera_tracer_->fallbacks())
    forget_fallback();
  fallback_learnt_ = true;
}

bool Renderer::idle(const Layer& layer) const {
  return paths_bring_all() && layer.stream != PhotonStream::kCaustic;
}

// Before any photon is traced: whether paths had better bring all of the indirect light in this
// view. Then the pass is done.
bool Renderer::try_paths(uint32_t pass) {
  fallback_.emplace(scene, Fallback::Reach::kAll);
  camera_tracer_->keep_trial(true);
  const bool scouts = CameraTracer::sends_scouts(film_);
  trace_records(pass, scouts ? CameraTracer::Tiles::kScouts : CameraTracer::Tiles::kAll);
  camera_tracer_->keep_trial(false);
  double photon_paths = 0;
  for (const auto& layer : layers_) photon_paths += static_cast<double>(layer->paths_per_pass);
  const double camera_paths = static_cast<double>(pass_film_.size()) * kGatheredSamples;
  if (!camera_tracer_->trial().paths_pay(photon_paths / camera_paths)) {
    fallback_.reset();
    return false;
  }
  if (scouts) trace_more(pass, CameraTracer::Tiles::kRest);
  samples_.set_least(kPathSamples);
  fallback_learnt_ = true;
  return true;
}

void Renderer::make_fallback(const KeyFilter& known) {
  const Layer& indirect = *layers_.front();
  if (!fallback_) fallback_.emplace(scene, Fallback::Reach::kBadlyServed);
  fallback_->learn(*indirect.radii, known, indirect.photons_per_disc,
                   static_cast<double>(indirect.paths_per_pass));
}

// Records of the first pass are all looked at, later ones now and then.
void Renderer::look_for_crowds(uint32_t pass) {
  if (!fallback_ || !records_ || idle(*layers_.front())) return;
  const size_t step = fallback_learnt_ ? kLaterLooks : 1, first = pass % step;
  if (records_->size() <= first) return;
  fallback_->look_for_crowds(
      (records_->size() - first - 1) / step + 1, scene.pool(), cancel_, [&](size_t i) {
        const Record& r = (*records_)[first + i * step];
        return Fallback::Place{r.position, r.ng, r.key, r.instance, r.triangle};
      });
}

// Nothing in view needs it.
void Renderer::forget_fallback() {
  fallback_.reset();
  if (options.final_gather) fallback_.emplace(scene, Fallback::Reach::kFirst);
}

// What the first pass lacks once the fallback has been learnt; whether anything falls back.
bool Renderer::trace_more(uint32_t pass, CameraTracer::Tiles tiles) {
  Timer timer(seconds_.camera);
  camera_tracer_->set_fallback(&*fallback_, layers_.size() > 1, radius_factor(*layers_.front()));
  records_ =
      &camera_tracer_->trace(pass, samples_, sky_, options.max_bounces, pass_film_, cancel_, tiles);
  return camera_tracer_->last_fallbacks() > 0;
}

// Needs records of places that have not fallen back: of scouts, or of all, which it replaces. What
// paths meet that go on from there, or what scouts have not met, is learnt of as well, if there is
// enough of it.
void Renderer::learn_fallback(uint32_t pass, bool scouts) {
  Layer& indirect = *layers_.front();
  KeyFilter known = keys_seen(indirect);
  learn(indirect, known, scouts);
  make_fallback(known);
  look_for_crowds(pass);
  bool any;
  if (scouts) {
    any = trace_more(pass, CameraTracer::Tiles::kRest);
  } else {
    Timer pilot(seconds_.pilot);
    any = trace_more(pass, CameraTracer::Tiles::kAgain);
  }
  const auto unknown = [&](const Record& r) {
    return !known.contains(r.key) && !(scouts && r.caustics_only);
  };
  const size_t most = scouts ? records_->size() / kUnscouted : 0;
  if (!any && !scouts) return forget_fallback();
  if (static_cast<size_t>(std::count_if(records_->begin(), records_->end(), unknown)) > most) {
    const KeyFilter seen = keys_seen(indirect);
    if (scouts)
      known.add(seen);
    else
      known = seen;
    learn(indirect, known, false);
    make_fallback(known);
    if (scouts) {
      Timer pilot(seconds_.pilot);
      any |= trace_more(pass, CameraTracer::Tiles::kAgain);
    }
  }
  if (!any) return forget_fallback();
  if (photons_pay()) return;
  fallback_.emplace(scene, Fallback::Reach::kAll);
  trace_more(pass, CameraTracer::Tiles::kAgain);
}

// Places that photons serve, a share s, have little noise; those of paths have all of it. Without
// photons, of work P beside the camera's C, there is time for (C + P)/C as many paths, and noise is
// of all places instead of 1 - s: photons pay if P (1 - s) < C s. P: of the smallest pass that
// there may be. Where they serve half of the places they stay all the same, for whoever renders a
// number of passes.
bool Renderer::photons_pay() const {
  if (fallback_->reach() != Fallback::Reach::kBadlyServed || options.kept_photon_bytes) return true;
  const Layer& indirect = *layers_.front();
  const PhotonCounts pilot = indirect.tracer->last_counts();
  const double wanted = static_cast<double>(std::count_if(
      records_->begin(), records_->end(), [](const Record& r) { return !r.caustics_only; }));
  const double served =
      wanted / std::max(1.0, wanted + static_cast<double>(camera_tracer_->fallbacks()));
  const double photons = kLeastOfPhotons * work_of(pilot) *
                         static_cast<double>(indirect.paths_per_pass) /
                         static_cast<double>(std::max<uint64_t>(1, pilot.traced));
  const double camera = static_cast<double>(camera_tracer_->last_rays() + records_->size());
  return served >= kServedWell || photons * (1 - served) < camera * served;
}

// The surfaces that photons of a layer are wanted on.
KeyFilter Renderer::keys_seen(const Layer& layer) const {
  KeyFilter keys;
  if (options.kept_photon_bytes)
    keys.add_all();
  else
    for (const Record& r : *records_)
      if (!r.caustics_only || layer.stream == PhotonStream::kCaustic) keys.add(r.key);
  return keys;
}

// A pilot teaches where useful photons start and how dense they land, on surfaces that are seen or
// on all.
void Renderer::learn(Layer& layer, const KeyFilter& seen, bool stores_all) {
  Timer timer(seconds_.photons), pilot_timer(seconds_.pilot);
  const std::optional<SeenPlaces> places = focus_on_view();
  KeyFilter stored = seen;
  if (stores_all) stored.add_all();
  const uint64_t paths = std::max<uint64_t>(1, std::min(layer.paths_per_pass, kPilotPaths));
  layer.tracer->set_viewer(viewer());
  const Photons* pilot = layer.tracer->learn_emission(paths, hash_combine(layer.seed, 4), seen,
                                                      stored, places ? &*places : nullptr, cancel_);
  if (!pilot)
    pilot = &layer.tracer->trace(0, paths, static_cast<double>(paths), hash_combine(layer.seed, 3),
                                 stored, cancel_);
  const bool caustic = layer.stream == PhotonStream::kCaustic;
  layer.radii = std::make_unique<RadiusMap>(
      scene, *pilot, static_cast<double>(paths),
      RadiusMap::Settings{middle_, caustic ? INFINITY : reach_, caustic});
  if (caustic) layer.dispersion = power_dispersion(*pilot);
  layer.pilot = since(layer.before, layer.tracer->counts());
}

namespace {

// The middle of points, each coordinate's median, and the distance that half of them are within.
std::pair<Vec3, float> middle_of(const std::vector<Vec3>& points) {
  std::vector<float> values(points.size());
  const auto median = [&](auto&& value) {
    std::transform(points.begin(), points.end(), values.begin(), value);
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  };
  const Vec3 middle{median([](const Vec3& p) { return p.x; }),
                    median([](const Vec3& p) { return p.y; }),
                    median([](const Vec3& p) { return p.z; })};
  return {middle, median([&](const Vec3& p) { return length(p - middle); })};
}

}  // namespace

// For photons that serve every view: what is modelled in detail is what will be looked at.
void Renderer::focus_on_geometry() {
  size_t count = 0;
  for (const Instance& instance : scene.instances)
    count += scene.meshes[instance.mesh].triangles.size();
  if (!count) return;
  const size_t step = 1 + count / kLooksForFocus;
  std::vector<Vec3> points;
  size_t next = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (; next < mesh.triangles.size(); next += step) {
      const Triangle& t = mesh.triangles[next];
      points.push_back(instance.to_world.point(
          (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) * (1 / 3.0f)));
    }
    next -= mesh.triangles.size();
  }
  const auto [middle, reach] = middle_of(points);
  lights_->focus(middle, reach);
}

// Once for a view. Returns where it looks, unless photons serve all views or it sees most of the
// scene.
std::optional<SeenPlaces> Renderer::focus_on_view() {
  if (options.kept_photon_bytes || !records_ || records_->empty()) return {};
  const size_t step = 1 + records_->size() / kLooksForFocus;
  std::vector<Vec3> points;
  for (size_t i = 0; i < records_->size(); i += step) points.push_back((*records_)[i].position);
  if (!view_is_focused_) {
    std::tie(middle_, reach_) = middle_of(points);
    lights_->focus(middle_, reach_);
    view_is_focused_ = true;
  }
  if (!lights_->focused()) return {};
  SeenPlaces places(middle_, reach_);
  for (const Record& r : *records_) places.add(r.key, r.position);
  return places;
}

void Renderer::make_points(uint32_t pass) {
  if (!records_) throw std::logic_error("trace_camera() comes before make_points()");
  Layer& layer = selected();
  if (idle(layer)) {
    layer.points = {};
    layer.splatter->set_blocks({});
    return;
  }
  if (!layer.radii) learn(layer, keys_seen(layer), false);
  {
    Timer timer(seconds_.camera);
    PointSettings s;
    s.photons_per_disc = layer.photons_per_disc;
    s.paths_per_pass = static_cast<double>(std::max<uint64_t>(1, layer.paths_per_pass));
    s.radius_factor = radius_factor(layer);
    s.caustics = layer.stream == PhotonStream::kCaustic;
    s.spacing = options.point_spacing;
    s.occlusion = options.boundary_correction && options.occlusion;
    if (options.final_gather) s.wandered_spacing = kGatheredSpacing * options.point_spacing;
    s.steady = options.kept_photon_bytes > 0;
    s.fixed_radius = options.fixed_radius;
    if (options.adaptive_radius) s.pixel_factors = layer.choice.factors().data();
    layer.points.build(scene, *records_, *layer.radii, s, pass, layer.seed, cancel_);
    layer.group_sums.assign(layer.points.blocks().size() * scene.light_groups, GroupSums{});
  }
  if (options.boundary_correction) {
    Timer timer(seconds_.boundary);
    layer.points.correct_boundaries(scene, cancel_);
  }
  Timer timer(seconds_.splat);
  layer.splatter->set_blocks(layer.points.block_bounds());
}

void Renderer::trace_photons(uint64_t first, uint64_t count) {
  Layer& layer = selected();
  Timer timer(seconds_.photons);
  const uint64_t from = layer.first_path + first;
  if (const PhotonSlices::Slice* kept = layer.kept.find(from, count)) {
    photons_ = &kept->photons;
    photon_groups_ = &kept->light_groups;
    layer.reused += kept->photons.size();
  } else {
    layer.tracer->set_viewer(viewer());
    const bool keep = options.kept_photon_bytes > kept_photon_bytes() && !layer.kept.full();
    KeyFilter everywhere;
    if (keep) everywhere.add_all();
    photons_ = &layer.tracer->trace(from, count, static_cast<double>(paths_of(layer)),
                                    hash_combine(layer.seed, 1),
                                    keep ? everywhere : layer.points.keys(), cancel_);
    photon_groups_ = &layer.tracer->light_groups();
    if (keep)
      layer.kept.add(from, count, *photons_, *photon_groups_,
                     options.kept_photon_bytes - kept_photon_bytes());
  }
  layer.used += photons_->size();
  layer.last_paths = count;
  layer.last_used = photons_->size();
}

void Renderer::splat() {
  Layer& layer = selected();
  Timer timer(seconds_.splat);
  if (!photon_groups_->empty())
    splat_groups(layer);
  else
    layer.splatter->splat(*photons_, layer.points.blocks(), scene.pool(), cancel_);
}

void Renderer::end_photons(uint64_t paths) {
  Layer& layer = selected();
  if (!paths) throw std::invalid_argument("a pass has one photon path at the least");
  const float more =
      static_cast<float>(static_cast<double>(paths_of(layer)) / static_cast<double>(paths));
  for (PointBlock& block : layer.points.blocks())
    for (float* scales : {block.scale, block.narrow_scale})
      for (uint32_t lane = 0; lane < kBlockSize; ++lane) scales[lane] *= more;
}

const Film& Renderer::film() const {
  if (!is_unpacked_) film_.unpack(unpacked_);
  is_unpacked_ = true;
  return unpacked_;
}

void Renderer::end_passes() {
  records_ = nullptr;
  if (camera_tracer_) camera_tracer_->forget_records();
  pass_film_.release();
}

const Splatter& Renderer::find_pairs(size_t first, size_t count) {
  Layer& layer = selected();
  if (first > photons_->size() || count > photons_->size() - first)
    throw std::out_of_range("there are not so many photons");
  Timer timer(seconds_.splat);
  layer.splatter->find_pairs(photons_->data() + first, count, layer.points.blocks().size(),
                             scene.pool(), cancel_);
  return *layer.splatter;
}

void Renderer::set_photons(Photons photons) {
  selected();
  given_photons_ = std::move(photons);
  photons_ = &given_photons_;
  photon_groups_ = &no_groups_;
}

void Renderer::resolve() {
  selected();
  const bool adaptive = options.adaptive_samples;
  Timer timer(seconds_.splat);
  if (scene.light_groups)
    for (const auto& layer : layers_)
      if (!idle(*layer)) join_groups(*layer);
  if (fallback_)
    for (const auto& layer : layers_)
      if (!idle(*layer)) add_irradiance(*layer, true);
  if (adaptive) samples_.see_camera(pass_film_, scene.pool());
  for (const auto& layer : layers_) {
    if (idle(*layer)) continue;
    add_irradiance(*layer, false);
    layer->choice.end_pass(scene.pool());
  }
  if (adaptive) samples_.end_pass(pass_film_, take_work(), scene.pool());
  for (const auto& layer : layers_) layer->first_path += paths_of(*layer);
  look_for_crowds(film_.passes);
  finish_pass();
}

// Of records that camera paths have left behind a fallback, whose noise is the camera's; or of all
// others.
void Renderer::add_irradiance(Layer& layer, bool wandered) {
  const Records& records = *records_;
  const PointBlocks& blocks = layer.points.blocks();
  const std::vector<size_t>& ranges = camera_tracer_->tile_ranges();
  std::vector<float>& noise = samples_.photons(layer.index).noise;
  if (!wandered) std::fill(noise.begin(), noise.end(), 0.0f);
  const float of_one = kNoiseOfOne * layer.dispersion;
  std::atomic<uint64_t> bad{0};
  scene.pool().for_each(ranges.size() - 1, cancel_, [&](size_t tile, int) {
    PackedFilm::Tile pixels;
    bool loaded = false;
    for (size_t i = ranges[tile]; i < ranges[tile + 1]; ++i) {
      const uint32_t point = layer.points.point_of_record(i), lane = point % kBlockSize;
      if (point == VisiblePoints::kNone || records[i].wandered != wandered) continue;
      if (!loaded) pass_film_.get(tile, pixels);
      loaded = true;
      const PointBlock& block = blocks[point / kBlockSize];
      const Rgb irradiance = Rgb{block.r[lane], block.g[lane], block.b[lane]} * block.scale[lane];
      Pixel& pixel = pixels[pass_film_.place_in_tile(records[i].pixel)];
      const Rgb light = records[i].throughput * irradiance;
      if (!can_be_added(light)) {
        ++bad;
        continue;
      }
      indirect_of(pixel, records[i].part) += light;
      for (int g = 0; g < pass_film_.light_groups; ++g) {
        const GroupSums& sums = layer.group_sums[g * blocks.size() + point / kBlockSize];
        pass_film_.groups_of(records[i].pixel)[g] += records[i].throughput *
                                                     Rgb{sums.r[lane], sums.g[lane], sums.b[lane]} *
                                                     block.scale[lane];
      }
      const float wide = luminance(irradiance);
      if (wide > 0) {
        const float detail =
            luminance(light) * (1 - block.narrow[lane] * block.narrow_scale[lane] / wide);
        pixel.detail += detail;
        if (!wandered)
          noise[records[i].pixel] +=
              luminance(light) * pixel.share() * std::sqrt(of_one / block.count[lane]);
        if (!wandered) layer.choice.detail()[records[i].pixel] += detail * pixel.share();
      }
      // Photons per square metre: the kernel disc holds `count` of them.
      pixel.photon_density += block.count[lane] * block.inverse_h2[lane] / kPi;
    }
    if (loaded) pass_film_.put(tile, pixels);
  });
  bad_light_ += bad;
}

// Of the last pass, in camera rays with their shading: a photon's ray is about a third of one, a
// material's program that it runs one, a photon splatted two, a record that finds its point one, a
// point's boundary eight.
PassWork Renderer::take_work() {
  PassWork work;
  double samples = 0;
  for (size_t t = 0; t < pass_film_.tiles(); ++t) {
    PackedFilm::Sums sums;
    pass_film_.see(t, sums);
    pass_film_.each(t, [&](size_t, size_t place) { samples += sums.samples[place]; });
  }
  const double camera = static_cast<double>(camera_tracer_->last_rays()) +
                        static_cast<double>(records_ ? records_->size() : 0);
  work.samples = camera / std::max(samples, 1.0) * static_cast<double>(pass_film_.size());
  for (const auto& layer : layers_) {
    double& photons = samples_.photons(layer->index).work = 0;
    if (idle(*layer)) continue;
    if (options.kept_photon_bytes) {  // found again or not, so that pictures do not depend on it
      if (layer->last_paths)
        photons =
            2.0 * static_cast<double>(layer->last_used) * layer->paths_per_pass / layer->last_paths;
      continue;
    }
    const PhotonCounts counts = layer->tracer->last_counts();
    if (counts.traced)
      photons = work_of(counts) * static_cast<double>(paths_of(*layer)) /
                static_cast<double>(counts.traced);
    work.fixed += 8.0 * static_cast<double>(layer->points.size());
  }
  return work;
}

// One at the least where there are any: a pass without them would lack their light.
uint64_t Renderer::paths_of(const Layer& layer) const {
  if (!options.adaptive_samples || !layer.paths_per_pass) return layer.paths_per_pass;
  return std::max(1ll, std::llround(samples_.photons(layer.index).count *
                                    static_cast<double>(layer.paths_per_pass)));
}

Renderer::PassSize Renderer::next_pass() {
  if (!options.adaptive_samples) return {};
  samples_.begin_pass(scene.pool());
  return {samples_.mean_count(), samples_.photon_count()};
}

void Renderer::limit_pass(const PassSize& most) {
  if (options.adaptive_samples) samples_.limit(most.samples, most.photons, scene.pool());
}

void Renderer::finish_pass() {
  {
    Timer timer(seconds_.error);
    errors_.add(pass_film_, scene.pool());
  }
  add_pass(film_, pass_film_, scene.pool());
  is_unpacked_ = false;
}

void Renderer::make_error_estimate() {
  selected();
  Timer timer(seconds_.error);
  errors_.update(scene.pool());
}

void Renderer::trace_reference(uint32_t sample) {
  selected();
  Timer timer(seconds_.camera);
  begin_pass_film();
  camera_tracer_->trace_reference(sample, options.max_bounces, pass_film_, cancel_);
  finish_pass();
}

PhotonCounts Renderer::photon_counts(const Layer& layer) const {
  const PhotonCounts all = since(layer.before, layer.tracer->counts());
  return {all.traced - layer.pilot.traced, all.stored - layer.pilot.stored, all.rays, all.shaded};
}

uint64_t Renderer::rays() const {
  uint64_t sum = camera_tracer_ ? camera_tracer_->rays() : 0;
  for (const auto& layer : layers_) sum += layer->tracer->counts().rays - layer->before.rays;
  return sum;
}

uint64_t Renderer::paths_per_batch() const {
  if (options.kept_photon_bytes) return kKeptPathsPerBatch;
  return std::clamp<uint64_t>(kPathsPerPoint * points().size(), kFewestPathsPerBatch,
                              kMostPathsPerBatch);
}

size_t Renderer::kept_photon_bytes() const {
  size_t sum = 0;
  for (const auto& layer : layers_) sum += layer->kept.bytes();
  return sum;
}

}  // namespace photon_splat
