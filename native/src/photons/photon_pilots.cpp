// What pilots teach: where photons that end on visible surfaces start.
#include <algorithm>

#include "math/random_streams.h"
#include "photons/caustic_targets.h"
#include "photons/photon_tracer.h"
#include "photons/seen_places.h"

namespace photon_splat {
namespace {

// Share of useful paths from which on emission stays unguided
constexpr double kUsefulShare = 0.3;
constexpr uint64_t kPilotsMore = 3;  // after the first, for emission that is guided
// Share of useful caustic paths below which targets are cut finer
constexpr double kFewArrive = 0.003;
// Over those of one that is the first to know where paths in media are worth to go on
constexpr uint64_t kPilotOverFirst = 8;

}  // namespace

bool PhotonTracer::Usefulness::counts(const Photon& photon) const {
  return (!filter || filter->contains(photon.key)) &&
         (!places || places->contains(photon.key, photon.position));
}

float PhotonTracer::use_of(const Photon& photon, const PhotonStart& start, double total) const {
  if (stream_ != PhotonStream::kCaustic) {
    // Photons weigh what their path does, unless that was heavy and has been sent here
    const float power = homing_.heavy(max_component(start.power))
                            ? average(photon.power) * static_cast<float>(total)
                            : average(start.power);
    const float share = power / static_cast<float>(lights_.total_power());
    return std::isfinite(share) ? share * share : 0;
  }
  const float own = luminance(start.power) * static_cast<float>(1 / total),
              share = own > 0 ? luminance(photon.power) / own : 0;
  return std::isfinite(share) ? share * share : 0;
}

// Of a beam: what a medium scatters of it.
float PhotonTracer::power_of_use(const PhotonBeam& beam) const {
  const float power = luminance(beam.power);
  const auto medium = scene_.media()->homogeneous(beam.media);
  return medium ? power * -std::expm1(-average(medium->scattering) * beam.length) : power;
}

// Use of a beam: its square, of the path's own.
float PhotonTracer::use_of(const PhotonBeam& beam, const PhotonStart& start, double total) const {
  const float own = luminance(start.power) * static_cast<float>(1 / total);
  const float share = own > 0 ? power_of_use(beam) / own : 0;
  return std::isfinite(share) ? share * share : 0;
}

// What paths are worth that scatter in media, of the pilot traced last.
void PhotonTracer::learn_worth() {
  if (!(join_.brought() > 0) || join_.stops().empty()) return;
  if (!worth_) worth_.emplace(scene_.near_center(), kWorldReach * scene_.near_radius());
  worth_->learn(join_.stops(), join_.brought() / static_cast<double>(last_counts_.traced), total_);
}

// Of paths that leave photons those that do; of those that leave beams, which are long or short,
// how many as useful as each other would do as well.
double PhotonTracer::useful_share(std::span<const float> use) const {
  double sum = 0, squares = 0;
  for (const float u : use) {
    sum += beams_ == BeamLight::kNone ? u > 0 : std::sqrt(static_cast<double>(u));
    squares += beams_ == BeamLight::kNone ? u > 0 : u;
  }
  return squares > 0 ? sum * sum / (squares * static_cast<double>(use.size())) : 0;
}

double PhotonTracer::aim(std::vector<EmissionTargets::Sphere> spheres, uint64_t paths,
                         uint32_t seed, const SurfaceFilter& visible, const SeenPlaces* places,
                         const CancelFlag& cancel) {
  targets_ = emitter_.aim_at(std::move(spheres));
  Usefulness useful{nullptr, places, {}};
  trace(0, paths, static_cast<double>(paths), seed, visible, cancel, &useful);
  for (uint64_t i = 0; i < paths; ++i) emitter_.learn(*targets_, i, seed, useful.of_path[i]);
  targets_->finish();
  return useful_share(useful.of_path);
}

// How heavy photons usually are where they are of use.
void PhotonTracer::learn_usual(const Photons& photons, const Usefulness& useful) {
  if (!useful.places) return;
  std::vector<float> powers;
  for (const Photon& photon : photons)
    if (const float power = max_component(photon.power);
        power > 0 && std::isfinite(power) && useful.counts(photon))
      powers.push_back(power);
  if (powers.empty()) return;
  const auto middle = powers.begin() + powers.size() / 2;
  std::nth_element(powers.begin(), middle, powers.end());
  homing_ = Homing(lights_.discs().seen_center(), lights_.discs().seen_radius(),
                   *middle * static_cast<float>(total_));
}

// Of paths from `first` on, which `drawn_by` has chosen.
void PhotonTracer::teach(EmissionGuide& guide, const EmissionGuide* drawn_by, uint64_t first,
                         uint32_t seed, std::span<const float> useful) const {
  EmissionPrimary primaries[kStartsAtOnce];
  for (size_t begin = 0; begin < useful.size(); begin += kStartsAtOnce) {
    const uint32_t count =
        static_cast<uint32_t>(std::min<size_t>(kStartsAtOnce, useful.size() - begin));
    emitter_.primaries(first + begin, count, seed, drawn_by, primaries);
    for (uint32_t k = 0; k < count; ++k) guide.learn(primaries[k], useful[begin + k]);
  }
  guide.finish();
}

const Photons* PhotonTracer::learn_emission(uint64_t paths, uint32_t seed,
                                            const SurfaceFilter& visible,
                                            const SurfaceFilter& stored, const SeenPlaces* places,
                                            const CancelFlag& cancel) {
  guide_.reset();
  targets_.reset();
  worth_.reset();
  homing_ = {};
  if (lights_.total_power() <= 0 || max_bounces_ < 1) return nullptr;
  if (stream_ == PhotonStream::kCaustic) {
    const double share = aim(caustic_targets(scene_), paths, seed, visible, places, cancel);
    if (share >= kFewArrive) return nullptr;
    EmissionTargets coarse = std::move(*targets_);
    const EmissionDiscs& discs = lights_.discs();
    const double fine = aim(fine_caustic_targets(scene_, discs.seen_center(), discs.seen_radius()),
                            paths, seed, visible, places, cancel);
    if (fine < share) targets_ = std::move(coarse);
    return nullptr;
  }
  Usefulness useful{&visible, places, {}};
  if (scatters_in_media()) {
    const uint64_t few = std::max<uint64_t>(1, paths / kPilotOverFirst);
    trace(0, few, static_cast<double>(few), stream_seed(seed, RandomStream::kPilot), stored, cancel,
          &useful);
    learn_worth();
  }
  const Photons& photons =
      trace(0, paths, static_cast<double>(paths), seed, stored, cancel, &useful);
  learn_worth();
  learn_usual(photons, useful);
  const double share = useful_share(useful.of_path);
  if (share > kUsefulShare || share == 0) return &photons;
  EmissionGuide guide = emitter_.make_guide();
  teach(guide, nullptr, 0, seed, useful.of_path);
  guide_ = std::move(guide);
  // Where few were of use, those of further pilots tell more
  for (uint64_t i = 1; i <= kPilotsMore; ++i)
    teach_guided(i * paths, paths, seed, stored, useful, cancel);
  return nullptr;
}

const Photons* PhotonTracer::learn_more_emission(uint64_t paths, uint32_t seed,
                                                 const SurfaceFilter& visible,
                                                 const SurfaceFilter& stored,
                                                 const SeenPlaces* places,
                                                 const CancelFlag& cancel) {
  if (!guide_) return learn_emission(paths, seed, visible, stored, places, cancel);
  Usefulness useful{&visible, places, {}};
  return &teach_guided((kPilotsMore + 1) * paths, paths, seed, stored, useful, cancel);
}

// Traces a pilot that the guide has drawn, and teaches that by it.
const Photons& PhotonTracer::teach_guided(uint64_t first, uint64_t paths, uint32_t seed,
                                          const SurfaceFilter& stored, Usefulness& useful,
                                          const CancelFlag& cancel) {
  const Photons& photons =
      trace(first, paths, static_cast<double>(paths), seed, stored, cancel, &useful);
  learn_worth();
  learn_usual(photons, useful);
  teach(*guide_, &*guide_, first, seed, useful.of_path);
  return photons;
}

}  // namespace photon_splat
