// What pilots teach: where photons that end on visible surfaces start.
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

}  // namespace

bool PhotonTracer::Usefulness::counts(const Photon& photon) const {
  return (!filter || filter->contains(photon.key)) &&
         (!places || places->contains(photon.key, photon.position));
}

float PhotonTracer::use_of(const Photon& photon, const PhotonStart& start, double total) const {
  if (stream_ != PhotonStream::kCaustic) {
    const float share = average(start.power) / static_cast<float>(lights_.total_power());
    return std::isfinite(share) ? share * share : 0;
  }
  const float own = luminance(start.power) * static_cast<float>(1 / total),
              share = own > 0 ? luminance(photon.power) / own : 0;
  return std::isfinite(share) ? share * share : 0;
}

// Use of a beam: the square of the power that a medium scatters of its path.
float PhotonTracer::use_of(const PhotonBeam& beam, const PhotonStart& start, double total) const {
  const float own = luminance(start.power) * static_cast<float>(1 / total);
  float share = own > 0 ? luminance(beam.power) / own : 0;
  if (const auto medium = scene_.media()->homogeneous(beam.media))
    share *= -std::expm1(-average(medium->scattering) * beam.length);
  return std::isfinite(share) ? share * share : 0;
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
  const Photons& photons =
      trace(0, paths, static_cast<double>(paths), seed, stored, cancel, &useful);
  const double share = useful_share(useful.of_path);
  if (share > kUsefulShare || share == 0) return &photons;
  EmissionGuide guide = emitter_.make_guide();
  teach(guide, nullptr, 0, seed, useful.of_path);
  guide_ = std::move(guide);
  // Where few were of use, those of further pilots tell more
  for (uint64_t first = paths; first <= kPilotsMore * paths; first += paths) {
    trace(first, paths, static_cast<double>(paths), seed, stored, cancel, &useful);
    teach(*guide_, &*guide_, first, seed, useful.of_path);
  }
  return nullptr;
}

}  // namespace photon_splat
