#include "render/camera_pass.h"

#include "math/random_streams.h"
#include "render/cost_model.h"

namespace photon_splat {
namespace {

// At most one gather point of so many lies on a surface that scouts have not seen, or the pilot is
// traced again
constexpr size_t kUnscouted = 16;
// Samples of a pixel in a pass where photons light what paths meet: theirs is most of the noise
constexpr uint32_t kGatheredSamples = 4;
// Photons of equal power in such a pass: its mean is uncertain by one over their root. Four times
// as many were no better in gi_demo and interior.
constexpr double kGatheredPhotons = 20000;
constexpr uint64_t kPixelsPerLook = 64;  // of which one tells how much samples vary beside beams
constexpr uint32_t kTrialSamples = 4;    // of a pixel, to tell their variance
constexpr uint32_t kPathSamples = 8;  // of a pixel in a pass where paths bring all indirect light
constexpr double kMeanOfShort = 2;    // samples of a pixel where passes are to be short
constexpr double kBeamsShare = 0.8;   // of the variance
constexpr double kServedWell = 0.5;   // share of places
// Kernel discs of photons in a first pass, below which paths gather. Of twelve scenes the one with
// 30 to 38 was wrong by blotches in half of its short renders; the next has 58 and gains nothing.
constexpr double kFewDiscs = 45;
constexpr size_t kLaterLooks = 16;  // one gather point in so many, in each pass but the first

bool wants_lobe_colors(const PackedFilm& film) {
  return (film.kept & channels_of(&Pixel::glossy_color, &Pixel::transmission_color)).any();
}

}  // namespace

CameraPass::CameraPass(const RenderContext& context, Lights& lights, const Camera& camera)
    : context_(context), lights_(lights), tracer_(context.scene, lights, camera, common_seed()) {
  guide_.reset(lights.environment());
  lights.set_guide(&guide_);
}

uint32_t CameraPass::common_seed() const {
  return stream_seed(context_.options.seed, RandomStream::kCamera);
}

void CameraPass::begin_part() {
  tracer_.set_seed(context_.options.part.own(common_seed()));
  context_.sampler.begin_part();
}

void CameraPass::reset_view(const PackedFilm& film, const PhotonMaps& maps) {
  const RenderOptions& options = context_.options;
  guide_.reset(lights_.environment());
  std::vector<PhotonSet> photons(maps.size());
  if (options.keeps_photons())
    for (PhotonSet& set : photons) set.fewest = set.most = 1;
  context_.sampler.reset(film.width, film.height, 1, std::move(photons));
  if (context_.gathers) sample_for_gathers(maps);
  strategy_.reset();
  chosen_ = false;
  tracer_.set_seed(common_seed());
  follow_bumps(true);
  focus_ = {};
  gather_points_ = nullptr;
}

void CameraPass::sample_for_gathers(const PhotonMaps& maps) {
  AdaptiveSampler& sampler = context_.sampler;
  // What photons do to paths that end at them passes for the camera's noise.
  for (size_t i = 0; i < maps.size(); ++i)
    if (!maps[i]->caustic()) sampler.photons(i).fewest = 1;
  if (context_.options.short_passes)
    sampler.set_most_mean(kMeanOfShort);
  else
    sampler.set_least(kGatheredSamples);
}

void CameraPass::trace_gather_points(uint32_t pass, const PhotonMaps& maps, PackedFilm& film,
                                     CameraTracer::Tiles tiles) {
  Timer timer(context_.seconds.camera);
  tracer_.set_strategy(strategy_ ? &*strategy_ : nullptr, maps.size() > 1,
                       maps.front()->radius_factor());
  tracer_.look_around(context_.options.ambient_distance);
  tracer_.note_lobe_colors(wants_lobe_colors(film));
  film.reset(film.width, film.height, film.light_groups);
  context_.sampler.begin_pass(context_.scene.pool());
  gather_points_ = &tracer_.trace(pass, context_.sampler, guide_, context_.options.max_bounces,
                                  film, context_.cancel, tiles);
}

void CameraPass::trace(uint32_t pass, const PhotonMaps& maps, PackedFilm& film,
                       const PassClock& clock) {
  const RenderOptions& options = context_.options;
  PhotonMap& indirect = *maps.front();
  const bool photons = indirect.first_pass_paths() > 0,
             learns =
                 !chosen_ && options.adaptive_indirect && photons && !context_.scene.needs_paths();
  const bool by_view = learns && !options.keeps_photons();
  const bool follows = photons && options.adaptive_indirect;
  tracer_.follow_motion(follows && context_.scene.moves());
  tracer_.follow_translucence(follows && context_.scene.translucence_differs());
  // Photons bring caustics alone then.
  if (!strategy_ && context_.scene.needs_paths())
    strategy_.emplace(context_.scene, IndirectStrategy::Kind::kPathTraced);
  if (!strategy_ && options.tries_paths() && by_view && try_paths(pass, maps, film, clock)) return;
  if (!strategy_ && context_.gathers && photons)
    strategy_.emplace(context_.scene, IndirectStrategy::Kind::kFinalGather);
  if (learns && !by_view) {  // the pilot asks for no view
    const SurfaceFilter all = indirect.wanted_on(gather_points_);
    if (!indirect.learnt()) teach(indirect, all, false);
    make_strategy(indirect, all);
  }
  const bool scouts = by_view && CameraTracer::sends_scouts(film);
  trace_gather_points(pass, maps, film,
                      scouts ? CameraTracer::Tiles::kScouts : CameraTracer::Tiles::kAll);
  if (by_view)
    choose(pass, scouts, maps, film);
  else if (learns && !tracer_.continued())
    forget_strategy();
  chosen_ = true;
}

double CameraPass::variance_beside_beams(const PhotonMaps& maps) {
  return try_media(maps, kPixelsPerLook).variance;
}

// Beams' noise is common to many pixels, as that of all photons: a denoiser takes off what paths
// have instead. So beams have to take off nearly all there is.
bool CameraPass::wants_indirect_beams(const PhotonMaps& maps) {
  return try_media(maps, 1).share > kBeamsShare;
}

CameraTracer::MediaTrial CameraPass::try_media(const PhotonMaps& maps, uint64_t each) {
  Timer timer(context_.seconds.photons), pilot_timer(context_.seconds.pilot);
  const RenderOptions& options = context_.options;
  std::optional<IndirectStrategy> gathers;
  if (context_.gathers) gathers.emplace(context_.scene, IndirectStrategy::Kind::kFinalGather);
  tracer_.set_strategy(gathers ? &*gathers : nullptr, maps.size() > 1, 1);
  const CameraTracer::MediaTrial trial =
      tracer_.try_media(stream_seed(options.seed, RandomStream::kBeamTrial), options.max_bounces,
                        each, context_.cancel);
  tracer_.set_strategy(strategy_ ? &*strategy_ : nullptr, maps.size() > 1, 1);
  return trial;
}

// Before any photon is traced: whether paths had better bring all of the indirect light in this
// view. Then the pass is done.
bool CameraPass::try_paths(uint32_t pass, const PhotonMaps& maps, PackedFilm& film,
                           const PassClock& clock) {
  const bool gathers = context_.gathers;
  const double camera_before = context_.seconds.camera;
  strategy_.emplace(context_.scene, IndirectStrategy::Kind::kPathTraced);
  tracer_.keep_trial(gathers ? CameraTracer::Trial::kGather : CameraTracer::Trial::kDensity);
  const bool scouts = CameraTracer::sends_scouts(film) || !gathers;
  if (!gathers) context_.sampler.begin_with(kTrialSamples);
  trace_gather_points(pass, maps, film,
                      scouts ? CameraTracer::Tiles::kScouts : CameraTracer::Tiles::kAll);
  tracer_.keep_trial(CameraTracer::Trial::kNone);
  double photon_paths = 0;
  for (const auto& map : maps) photon_paths += static_cast<double>(map->first_pass_paths());
  const double camera_paths = static_cast<double>(film.size()) * kGatheredSamples;
  const bool pays = gathers ? tracer_.trial().paths_pay(photon_paths / camera_paths)
                            : tracer_.trial().paths_beat_density();
  const double tried = context_.seconds.camera - camera_before;
  if (!pays) {
    take_for_pilot(tried);
    strategy_.reset();
    return false;
  }
  if (scouts) trace_rest(pass, gathers ? PassClock(INFINITY) : clock, tried, maps, film);
  context_.sampler.set_least(gathers && !context_.options.short_passes ? kPathSamples : 1);
  chosen_ = true;
  return true;
}

// What the camera has done does not count, and the first pass begins anew.
void CameraPass::take_for_pilot(double seconds) {
  context_.seconds.camera -= seconds;
  context_.seconds.photons += seconds;  // as other pilots
  context_.seconds.pilot += seconds;
  context_.sampler.begin_with(1);
}

// What scouts have left, in time if it can be: with fewer samples, but one at the least. Among
// pixels of one sample the scouts' tiles would show. `scouted`: the seconds that they took.
void CameraPass::trace_rest(uint32_t pass, const PassClock& clock, double scouted,
                            const PhotonMaps& maps, PackedFilm& film) {
  double done = 0;
  for (size_t t = 0; t < film.tiles(); ++t)
    if (CameraTracer::scouts(film, t)) film.each(t, [&](size_t, size_t) { ++done; });
  const double wanted = scouted * (static_cast<double>(film.size()) - done) / done;  // seconds
  if (wanted > clock.left() + clock.slack()) {
    const auto samples = static_cast<uint32_t>(kTrialSamples * clock.left() / wanted);
    if (samples < 2) {
      take_for_pilot(scouted);
      return trace_gather_points(pass, maps, film, CameraTracer::Tiles::kAll);
    }
    for (size_t t = 0; t < film.tiles(); ++t)
      if (!CameraTracer::scouts(film, t))
        film.each(t, [&](size_t i, size_t) { context_.sampler.begin_with(i, samples); });
  }
  trace_more(pass, CameraTracer::Tiles::kRest, maps, film);
}

void CameraPass::make_strategy(const PhotonMap& indirect, const SurfaceFilter& known) {
  if (!strategy_) strategy_.emplace(context_.scene, IndirectStrategy::Kind::kPhotonDensity);
  strategy_->learn(indirect.radii(), known, indirect.photons_per_disc(),
                   static_cast<double>(indirect.first_pass_paths()));
}

// Nothing in view needs it, except paths that gather: they may come too close to a disc.
void CameraPass::forget_strategy() {
  if (!context_.gathers) strategy_.reset();
}

// Gather points of the first pass are all looked at, later ones now and then.
void CameraPass::look_for_crowds(uint32_t pass) {
  if (!strategy_ || !gather_points_ || all_path_traced()) return;
  const size_t step = chosen_ ? kLaterLooks : 1, first = pass % step;
  if (gather_points_->size() <= first) return;
  strategy_->look_for_crowds((gather_points_->size() - first - 1) / step + 1, context_.scene.pool(),
                             context_.cancel, [&](size_t i) {
                               const GatherPoint& r = (*gather_points_)[first + i * step];
                               return IndirectStrategy::Place{r.position, r.ng, r.key, r.instance,
                                                              r.triangle};
                             });
}

// What the first pass lacks once the strategy has been learnt; whether any path goes on.
bool CameraPass::trace_more(uint32_t pass, CameraTracer::Tiles tiles, const PhotonMaps& maps,
                            PackedFilm& film) {
  Timer timer(context_.seconds.camera);
  tracer_.set_strategy(&*strategy_, maps.size() > 1, maps.front()->radius_factor());
  gather_points_ = &tracer_.trace(pass, context_.sampler, guide_, context_.options.max_bounces,
                                  film, context_.cancel, tiles);
  return tracer_.last_continued() > 0;
}

// Needs gather points of places where paths have not gone on: of scouts, or of all, which it
// replaces. What paths meet that go on from there, or what scouts have not met, is learnt of as
// well, if there is enough of it.
void CameraPass::choose(uint32_t pass, bool scouts, const PhotonMaps& maps, PackedFilm& film) {
  PhotonMap& indirect = *maps.front();
  SurfaceFilter known = indirect.wanted_on(gather_points_);
  teach(indirect, known, scouts, indirect.learnt());
  if (photons_are_few(indirect)) {
    context_.gathers = true;
    sample_for_gathers(maps);
    strategy_.emplace(context_.scene, IndirectStrategy::Kind::kFinalGather);
    return trace(pass, maps, film);
  }
  make_strategy(indirect, known);
  look_for_crowds(pass);
  bool any;
  if (scouts) {
    any = trace_more(pass, CameraTracer::Tiles::kRest, maps, film);
  } else {
    Timer pilot(context_.seconds.pilot);
    any = trace_more(pass, CameraTracer::Tiles::kAgain, maps, film);
  }
  const auto unknown = [&](const GatherPoint& r) {
    return !known.contains(r.key) && !(scouts && r.caustics_only);
  };
  const size_t most = scouts ? gather_points_->size() / kUnscouted : 0;
  if (!any && !scouts) return forget_strategy();
  if (static_cast<size_t>(std::count_if(gather_points_->begin(), gather_points_->end(), unknown)) >
      most) {
    const SurfaceFilter seen = indirect.wanted_on(gather_points_);
    if (scouts)
      known.add(seen);
    else
      known = seen;
    teach(indirect, known, false, true);
    make_strategy(indirect, known);
    if (scouts) {
      Timer pilot(context_.seconds.pilot);
      any |= trace_more(pass, CameraTracer::Tiles::kAgain, maps, film);
    }
  }
  want_photons(indirect);
  if (!any) return forget_strategy();
  if (photons_pay(indirect)) return;
  strategy_.emplace(context_.scene, IndirectStrategy::Kind::kPathTraced);
  trace_more(pass, CameraTracer::Tiles::kAgain, maps, film);
}

// So few kernel discs of photons cover all that is seen that their noise is blotches, some as wide
// as a seventh of the picture, which no pixel's variance shows. Paths that gather have less of it,
// and about twice the noise of pixels.
bool CameraPass::photons_are_few(const PhotonMap& indirect) const {
  return context_.options.indirect_light == IndirectLight::kAny && !context_.gathers &&
         indirect.useful_photons() < kFewDiscs * indirect.photons_per_disc();
}

// Paths that gather see photons of the whole scene at once. These photons' noise is common to many
// pixels: no pixel's variance shows it, and no denoiser takes it off.
void CameraPass::want_photons(const PhotonMap& indirect) {
  if (!context_.gathers) return;
  context_.sampler.photons(0).wanted =
      kGatheredPhotons / std::max(indirect.effective_photons(), 1.0);
}

// Places that photons serve, a share s, have little noise; those of paths have all of it. Without
// photons, of work P beside the camera's C, there is time for (C + P)/C as many paths, and noise is
// of all places instead of 1 - s: photons pay if P (1 - s) < C s. P: of the smallest pass that
// there may be. Where they serve half of the places they stay all the same, for whoever renders a
// number of passes.
bool CameraPass::photons_pay(const PhotonMap& indirect) const {
  if (strategy_->kind() != IndirectStrategy::Kind::kPhotonDensity ||
      context_.options.keeps_photons())
    return true;
  const double wanted =
      static_cast<double>(std::count_if(gather_points_->begin(), gather_points_->end(),
                                        [](const GatherPoint& r) { return !r.caustics_only; }));
  const double served = wanted / std::max(1.0, wanted + static_cast<double>(tracer_.continued()));
  const double photons = cost::kLeastOfPhotons * indirect.pilot_work_per_pass();
  const double camera = static_cast<double>(tracer_.last_rays() + gather_points_->size());
  return served >= kServedWell || photons * (1 - served) < camera * served;
}

void CameraPass::teach(PhotonMap& map) { teach(map, map.wanted_on(gather_points_), false); }

void CameraPass::teach(PhotonMap& map, const SurfaceFilter& seen, bool all_surfaces, bool more) {
  Timer timer(context_.seconds.photons), pilot_timer(context_.seconds.pilot);
  std::optional<SeenPlaces> places;
  if (!context_.options.keeps_photons() && gather_points_)
    places = focus_.look(*gather_points_, lights_);
  map.learn(
      {seen, all_surfaces, places ? &*places : nullptr, more, focus_.middle(), focus_.reach()});
}

void CameraPass::trace_reference(uint32_t sample, PackedFilm& film) {
  Timer timer(context_.seconds.camera);
  film.reset(film.width, film.height, film.light_groups);
  tracer_.look_around(context_.options.ambient_distance);
  tracer_.note_lobe_colors(wants_lobe_colors(film));
  tracer_.trace_reference(context_.options.part.passes_before + sample,
                          context_.options.max_bounces, film, context_.cancel);
}

void CameraPass::trace_from_cache(const CameraTracer::CacheUse& use, const PhotonMaps& maps,
                                  PackedFilm& film) {
  Timer timer(context_.seconds.camera);
  tracer_.set_strategy(nullptr, maps.size() > 1, 1);
  tracer_.look_around(0);
  tracer_.note_lobe_colors(false);
  tracer_.follow_motion(false);
  tracer_.follow_translucence(false);
  tracer_.set_beams({});
  film.reset(film.width, film.height, film.light_groups);
  gather_points_ =
      &tracer_.trace_from_cache(use, context_.options.max_bounces, film, context_.cancel);
}

void CameraPass::forget_gather_points() {
  gather_points_ = nullptr;
  tracer_.forget_gather_points();
}

double CameraPass::work_of_samples(const PackedFilm& film) const {
  double samples = 0;
  for (size_t t = 0; t < film.tiles(); ++t) {
    PackedFilm::Sums sums;
    film.see(t, sums);
    film.each(t, [&](size_t, size_t place) { samples += sums.samples[place]; });
  }
  const double camera = static_cast<double>(tracer_.last_rays()) +
                        static_cast<double>(gather_points_ ? gather_points_->size() : 0);
  return camera / std::max(samples, 1.0) * static_cast<double>(film.size());
}

}  // namespace photon_splat
