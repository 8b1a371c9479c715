#include "render/photon_map.h"

#include <atomic>

#include "math/random_streams.h"
#include "render/cost_model.h"

namespace photon_splat {
namespace {

constexpr uint64_t kPilotPaths = 65536;
constexpr double kPhotonsPerDisc = 200;
constexpr double kCausticPhotonsPerDisc = 25;
// Squared relative error of what an Epanechnikov kernel makes of one photon in a disc
constexpr float kNoiseOfOne = 4.0f / 3;
// Spacing of the points that paths meet after a gather, over that of points that are seen: a
// pixel's paths meet many
constexpr float kGatheredSpacing = 2;
// h ~ paths^(-1/6): variance and squared bias fall alike (Knaus & Zwicker 2011)
constexpr double kShrinkExponent = -1.0 / 6.0;
// A viewport's picture is splatted once, not averaged over passes: so many times the photons in
// each disc of a render's pass
constexpr double kViewportMore = 2;
// Radii shrink until a viewport has so many photons: more of them make the picture less noisy
// instead of sharper
constexpr double kViewportPhotons = 1 << 17;

double work_of(const PhotonCounts& counts) {
  return static_cast<double>(counts.rays) / cost::kPhotonRays +
         cost::kShadedPhoton * static_cast<double>(counts.shaded) +
         cost::kSplattedPhoton * static_cast<double>(counts.stored);
}

void scale_sums(PointBlocks& blocks, float factor) {
  for (PointBlock& block : blocks)
    for (float* scales : {block.scale, block.narrow_scale})
      for (uint32_t lane = 0; lane < kBlockSize; ++lane) scales[lane] *= factor;
}

}  // namespace

PhotonMap::PhotonMap(const RenderContext& context, const Lights& lights, const Camera* viewer,
                     PhotonStream stream, size_t number)
    : context_(context),
      viewer_(viewer),
      stream_(stream),
      number_(number),
      photons_per_disc_(caustic() ? kCausticPhotonsPerDisc : kPhotonsPerDisc),
      seed_(caustic() ? stream_seed(context.options.seed, RandomStream::kCausticPhotons)
                      : context.options.seed),
      first_pass_paths_(context.options.photons_per_pass),
      lights_(lights),
      tracer_(context.scene, lights, context.options.max_bounces, stream),
      splatter_(std::make_unique<Splatter>(context.options.kernel)) {
  if (context.scene.light_groups) tracer_.keep_light_groups();
}

void PhotonMap::reset_view(int width, int height) {
  adaptive_radius_.reset(width, height, context_.options.part.count);
  first_path_ = 0;
  points_.forget_clear_regions();
  if (!context_.options.keeps_photons()) radii_.reset();
}

void PhotonMap::set_radii_known(std::vector<AdaptiveRadius::Known> known) {
  if (known.size() != adaptive_radius_.factors().size())
    throw std::invalid_argument("radii are known of each pixel or of none");
  adaptive_radius_.go_on(std::move(known), context_.options.part.passes_before);
}

void PhotonMap::begin_part() {
  first_path_ = 0;
  adaptive_radius_.begin_part();
  pilot_ = since(before_, tracer_.counts());
  used_ = reused_ = 0;
}

void PhotonMap::begin_again() {
  set_photons({});
  before_ = tracer_.counts();
  pilot_ = {};
  used_ = reused_ = 0;
  points_ = {};
  splatter_ = std::make_unique<Splatter>(context_.options.kernel);
}

SurfaceFilter PhotonMap::wanted_on(const GatherPoints* gather_points) const {
  SurfaceFilter keys;
  if (context_.options.keeps_photons())
    keys.add_all();
  else
    for (const GatherPoint& r : *gather_points)
      if (!r.caustics_only || caustic()) keys.add(r.key);
  return keys;
}

void PhotonMap::learn(const PilotTask& task) {
  SurfaceFilter stored = task.useful;
  if (task.all_surfaces) stored.add_all();
  const uint64_t paths = std::max<uint64_t>(1, std::min(first_pass_paths_, kPilotPaths));
  tracer_.set_viewer(viewer_);
  // Where photons light what paths meet one bounce on, theirs are one less.
  tracer_.set_max_bounces(
      std::max(0, context_.options.max_bounces - (context_.gathers && !caustic())));
  const auto learn = task.more ? &PhotonTracer::learn_more_emission : &PhotonTracer::learn_emission;
  const Photons* pilot = (tracer_.*learn)(paths, stream_seed(seed_, RandomStream::kEmissionPilot),
                                          task.useful, stored, task.places, context_.cancel);
  if (!pilot)
    pilot = &tracer_.trace(0, paths, static_cast<double>(paths),
                           stream_seed(seed_, RandomStream::kPilot), stored, context_.cancel);
  radii_ = std::make_unique<RadiusMap>(
      context_.scene, *pilot, static_cast<double>(paths),
      RadiusMap::Settings{task.middle, caustic() ? INFINITY : task.reach, caustic()});
  const float dispersion = power_dispersion(*pilot);
  if (caustic()) dispersion_ = dispersion;
  const double share = static_cast<double>(pilot->size()) / dispersion / static_cast<double>(paths);
  effective_photons_ = share * static_cast<double>(first_pass_paths_);
  const auto useful = [&](const Photon& photon) { return task.useful.contains(photon.key); };
  useful_photons_ = static_cast<double>(std::count_if(pilot->begin(), pilot->end(), useful)) /
                    static_cast<double>(paths) * static_cast<double>(first_pass_paths_);
  pilot_ = since(before_, tracer_.counts());
  const RenderOptions& options = context_.options;
  if (caustic() && options.adaptive_samples && !options.keeps_photons())
    context_.sampler.photons(number_).begin_with_share(share);
}

uint64_t PhotonMap::paths_per_pass() const {
  if (!context_.options.adaptive_samples || !first_pass_paths_) return first_pass_paths_;
  return std::max(1ll, std::llround(context_.sampler.photons(number_).count *
                                    static_cast<double>(first_pass_paths_)));
}

float PhotonMap::radius_factor() const {
  const double paths = context_.options.part.paths(number_, first_path_, paths_per_pass());
  return context_.options.radius_scale *
         static_cast<float>(std::pow(
             std::max(1.0, paths / std::max(1.0, double(first_pass_paths_))), kShrinkExponent));
}

void PhotonMap::clear_points() {
  points_ = {};
  splatter_->set_blocks({});
}

void PhotonMap::place_points(const GatherPoints& gather_points, uint32_t pass) {
  const RenderOptions& options = context_.options;
  {
    Timer timer(context_.seconds.camera);
    PointSettings s;
    s.photons_per_disc = photons_per_disc_;
    s.paths_per_pass = static_cast<double>(std::max<uint64_t>(1, first_pass_paths_));
    s.radius_factor = radius_factor();
    s.caustics = caustic();
    s.spacing = options.point_spacing;
    if (context_.gathers || context_.scene.scatters_in_media())
      s.after_gather_spacing = kGatheredSpacing * options.point_spacing;
    s.steady = options.keeps_photons();
    s.occlusion = options.boundary_correction && options.occlusion;
    s.fixed_radius = options.fixed_radius;
    if (options.adaptive_radius) s.pixel_factors = adaptive_radius_.factors().data();
    points_.build(context_.scene, gather_points, *radii_, s, options.part.passes_before + pass,
                  options.part.own(seed_), context_.cancel);
    groups_.reset(points_.blocks(), context_.scene.light_groups);
  }
  if (options.boundary_correction) {
    Timer timer(context_.seconds.boundary);
    points_.correct_boundaries(context_.scene, context_.cancel);
  }
  Timer timer(context_.seconds.splat);
  splatter_->set_blocks(points_.block_bounds());
}

void PhotonMap::trace(uint64_t first, uint64_t count) {
  Timer timer(context_.seconds.photons);
  const uint64_t from = first_path_ + first;
  if (const PhotonCache::Batch* kept = cache_.find(from, count)) {
    batch_ = &kept->photons;
    batch_groups_ = &kept->light_groups;
    reused_ += kept->photons.size();
  } else {
    tracer_.set_viewer(viewer_);
    const size_t most = context_.options.kept_photon_bytes, there = context_.kept_bytes;
    const bool keep = most > there && !cache_.full();
    SurfaceFilter everywhere;
    if (keep) everywhere.add_all();
    batch_ = &tracer_.trace(context_.options.part.paths_done(number_, from), count,
                            static_cast<double>(paths_per_pass()),
                            context_.options.part.own(stream_seed(seed_, RandomStream::kPhotons)),
                            keep ? everywhere : points_.keys(), context_.cancel);
    batch_groups_ = &tracer_.light_groups();
    if (keep) context_.kept_bytes += cache_.add(from, count, *batch_, *batch_groups_, most - there);
  }
  used_ += batch_->size();
  traced_in_pass_ = first + count;
  batch_paths_ = count;
  batch_photons_ = batch_->size();
}

void PhotonMap::set_photons(Photons photons) {
  given_ = std::move(photons);
  batch_ = &given_;
  batch_groups_ = &no_groups_;
}

void PhotonMap::splat() {
  {
    Timer timer(context_.seconds.splat);
    ThreadPool& pool = context_.scene.pool();
    if (!batch_groups_->empty())
      groups_.splat(*splatter_, *batch_, *batch_groups_, points_.blocks(), points_.ways(), pool,
                    context_.cancel);
    else
      splatter_->splat(*batch_, points_.blocks(), points_.ways(), pool, context_.cancel);
  }
  find_masses();
}

void PhotonMap::find_masses() {
  if (!context_.options.boundary_correction) return;
  Timer timer(context_.seconds.boundary);
  LightBeside beside{light_beside_, gather_points_, 1};
  if (traced_in_pass_)
    beside.more =
        static_cast<float>(static_cast<double>(paths_per_pass()) / double(traced_in_pass_));
  points_.find_masses(context_.scene, beside, context_.cancel);
}

void PhotonMap::see_light(const GatherPoints& gather_points, const PackedFilm& pass) {
  light_beside_.clear();
  traced_in_pass_ = 0;
  // Wide discs of other photons are corrected by much more, and chance would flicker in a viewport
  if (!caustic() || context_.options.keeps_photons() || !context_.options.boundary_correction)
    return;
  Timer timer(context_.seconds.boundary);
  gather_points_ = &gather_points;
  light_beside_.resize(pass.size());
  context_.scene.pool().for_each(pass.tiles(), context_.cancel, [&](size_t t, int) {
    PackedFilm::Sums sums;
    pass.see(t, sums);
    pass.each(t, [&](size_t i, size_t place) {
      const float samples = sums.samples[place];
      light_beside_[i] = samples > 0 ? std::max(sums.luminance[place] / samples, 0.0f) : 0;
    });
  });
}

const Splatter& PhotonMap::find_pairs(size_t first, size_t count) {
  if (first > batch_->size() || count > batch_->size() - first)
    throw std::out_of_range("there are not so many photons");
  Timer timer(context_.seconds.splat);
  splatter_->find_pairs(batch_->data() + first, count, points_.blocks().size(),
                        context_.scene.pool(), context_.cancel);
  return *splatter_;
}

void PhotonMap::end_photons(uint64_t paths) {
  if (!paths) throw std::invalid_argument("a pass has one photon path at the least");
  scale_sums(points_.blocks(), static_cast<float>(static_cast<double>(paths_per_pass()) /
                                                  static_cast<double>(paths)));
}

uint64_t PhotonMap::add_to_film(const GatherPoints& gather_points,
                                const std::vector<size_t>& ranges, bool after_gather,
                                PackedFilm& film) {
  const PointBlocks& blocks = points_.blocks();
  std::vector<float>& noise = context_.sampler.photons(number_).noise;
  if (!after_gather) std::fill(noise.begin(), noise.end(), 0.0f);
  const float of_one = kNoiseOfOne * dispersion_;
  std::atomic<uint64_t> bad{0};
  context_.scene.pool().for_each(ranges.size() - 1, context_.cancel, [&](size_t tile, int) {
    PackedFilm::Tile pixels;
    bool loaded = false;
    for (size_t i = ranges[tile]; i < ranges[tile + 1]; ++i) {
      const GatherPoint& at = gather_points[i];
      const uint32_t point = points_.point_of(i), lane = point % kBlockSize;
      if (point == VisiblePoints::kNone || at.after_gather != after_gather) continue;
      if (!loaded) film.get(tile, pixels);
      loaded = true;
      const PointBlock& block = blocks[point / kBlockSize];
      const Rgb irradiance = Rgb{block.r[lane], block.g[lane], block.b[lane]} * block.scale[lane];
      Pixel& pixel = pixels[film.place_in_tile(at.pixel)];
      const Rgb light = at.throughput * irradiance_on(at, point);
      if (!can_be_added(light)) {
        ++bad;
        continue;
      }
      indirect_of(pixel, at.category) += light;
      for (int g = 0; g < film.light_groups; ++g)
        film.groups_of(at.pixel)[g] +=
            at.throughput * groups_.at(g, point, blocks.size()) * block.scale[lane];
      const float wide = luminance(irradiance);
      if (wide > 0) {
        const float detail =
            luminance(light) * (1 - block.narrow[lane] * block.narrow_scale[lane] / wide);
        pixel.detail += detail;
        if (!after_gather) {
          noise[at.pixel] +=
              std::abs(luminance(light)) * pixel.share() * std::sqrt(of_one / block.count[lane]);
          adaptive_radius_.detail()[at.pixel] += detail * pixel.share();
        }
      }
      // Photons per square metre: the kernel disc holds `count` of them.
      pixel.photon_density += block.count[lane] * block.inverse_h2[lane] / kPi;
    }
    if (loaded) film.put(tile, pixels);
  });
  return bad;
}

void PhotonMap::end_pass() { first_path_ += paths_per_pass(); }

void PhotonMap::adapt_radii() { adaptive_radius_.end_pass(context_.scene.pool()); }

double PhotonMap::work() const {
  // Found again or not, so that pictures do not depend on it.
  if (context_.options.keeps_photons())
    return batch_paths_ ? cost::kSplattedPhoton * static_cast<double>(batch_photons_) *
                              first_pass_paths_ / batch_paths_
                        : 0;
  const PhotonCounts& counts = tracer_.last_counts();
  return counts.traced ? work_of(counts) * static_cast<double>(paths_per_pass()) /
                             static_cast<double>(counts.traced)
                       : 0;
}

double PhotonMap::pilot_work_per_pass() const {
  const PhotonCounts& pilot = tracer_.last_counts();
  return work_of(pilot) * static_cast<double>(first_pass_paths_) /
         static_cast<double>(std::max<uint64_t>(1, pilot.traced));
}

PhotonMapStatistics PhotonMap::statistics() const {
  const PhotonCounts all = since(before_, tracer_.counts());
  PhotonMapStatistics out;
  out.stream = stream_;
  out.photons = {all.traced - pilot_.traced, all.stored - pilot_.stored, all.rays, all.shaded};
  out.pilot = pilot_;
  out.guided = tracer_.guided();
  out.used = used_;
  out.reused = reused_;
  out.discs = points_.counts();
  return out;
}

void PhotonMap::trace_viewport_photons(uint64_t paths, size_t most_bytes) {
  if (!viewport_photons_) {
    viewport_photons_.emplace(context_.scene, lights_, context_.options.max_bounces, stream_,
                              stream_seed(seed_, RandomStream::kViewportPhotons));
    viewport_splatter_.emplace(context_.options.kernel);
  }
  viewport_photons_->trace(paths, most_bytes, context_.cancel);
}

void PhotonMap::place_viewport_points(const GatherPoints& gather_points) {
  const ViewportPhotons& there = *viewport_photons_;
  const RenderOptions& options = context_.options;
  PointSettings s;
  s.photons_per_disc = kViewportMore * photons_per_disc_;
  const double paths = static_cast<double>(there.paths()),
               photons = static_cast<double>(there.photons().size());
  s.paths_per_pass = paths * std::min(1.0, kViewportPhotons / std::max(photons, 1.0));
  s.radius_factor = options.radius_scale;
  s.spacing = options.point_spacing;
  s.caustics = caustic();
  s.steady = true;
  s.occlusion = options.boundary_correction && options.occlusion;
  points_.build(context_.scene, gather_points, *there.radii(), s, 0, seed_, context_.cancel);
  groups_.reset(points_.blocks(), context_.scene.light_groups);  // all of the light is the rest
  if (options.boundary_correction) points_.correct_boundaries(context_.scene, context_.cancel);
  viewport_splatter_->set_blocks(points_.block_bounds());
  viewport_splatter_->splat_kept(there.photons(), points_.blocks(), points_.ways(),
                                 context_.scene.pool(), context_.cancel);
  if (options.boundary_correction) points_.find_masses(context_.scene, {}, context_.cancel);
  scale_sums(points_.blocks(), static_cast<float>(1.0 / paths));
}

Rgb PhotonMap::light_at(const GatherPoints& gather_points, size_t i) const {
  const uint32_t point = points_.point_of(i);
  if (point == VisiblePoints::kNone) return {};
  return gather_points[i].throughput * irradiance_on(gather_points[i], point);
}

Rgb PhotonMap::irradiance_on(const GatherPoint& at, uint32_t point) const {
  const uint32_t lane = point % kBlockSize;
  const size_t b = point / kBlockSize;
  const PointBlock& block = points_.blocks()[b];
  Rgb sum{block.r[lane], block.g[lane], block.b[lane]};
  if (at.offset) sum += points_.ways().added(b, lane, decode_offset(at.offset));
  return sum * block.scale[lane];
}

}  // namespace photon_splat
