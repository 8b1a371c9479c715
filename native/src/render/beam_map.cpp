#include "render/beam_map.h"

#include "math/random_streams.h"

namespace photon_splat {
namespace {

constexpr double kShareOfPaths = 0.125;  // of a photon map's
constexpr uint64_t kFewestPaths = 1 << 10, kFewestLongPaths = 64;
constexpr uint64_t kPilotPaths = 32768;
constexpr uint32_t kLooks = 16, kSmoothLooks = 8;  // at so many beams, about, by a ray in a cell
// A ray sees all beams that come within a radius of it on its whole way: fewer do than of photons
// on a surface. Light that diffuse surfaces and media have scattered is smoother than caustics.
constexpr double kBeamsPerDisc = 2, kSmoothBeamsPerDisc = 4;
// h ~ paths^(-1/5): for a kernel of one dimension variance falls with h and squared bias with h^4
constexpr double kShrinkExponent = -1.0 / 5.0;
constexpr double kBeside = 0.1;  // of the variance of other light, that of beams in a cell may be
constexpr int kWays = 8;         // that tell how a medium scatters

// What a metre of a beam sends out into directions, root mean square of all, W/(m sr): of phases p
// that is the root of the mean of p / 4 pi over what they send out.
double strength(const Media& media, const PhotonBeam& beam) {
  const auto medium = media.homogeneous(beam.media);
  if (!medium) return INFINITY;
  double mean = 0;
  for (int i = 0; i < kWays; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / kWays;
    float pdf = 0;
    medium->evaluate(beam.direction, medium->sample(beam.direction, u, {u, 0.5f}), &pdf);
    mean += pdf / kWays;
  }
  return luminance(absolute(beam.power) * medium->scattering) * std::sqrt(mean / (4 * kPi));
}

}  // namespace

BeamMap::BeamMap(const RenderContext& context, const Lights& lights, const Camera& viewer,
                 BeamLight light, PhotonStream stream)
    : context_(context),
      viewer_(viewer),
      tracer_(context.scene, lights, context.options.max_bounces, stream),
      seed_(stream_seed(context.options.seed, light == BeamLight::kCaustic
                                                  ? RandomStream::kCausticBeams
                                                  : RandomStream::kIndirectBeams)),
      smooth_(light == BeamLight::kIndirect),
      most_paths_(
          std::max(kFewestPaths,
                   static_cast<uint64_t>(kShareOfPaths *
                                         static_cast<double>(context.options.photons_per_pass)))),
      paths_(most_paths_) {
  tracer_.leave_beams(light);
}

void BeamMap::begin_again() {
  passes_ = first_path_ = 0;
  tree_.clear();
  before_ = tracer_.counts();
}

void BeamMap::begin_part() {
  passes_ = first_path_ = 0;
  before_ = tracer_.counts();
}

double BeamMap::beams_per_path() {
  if (beams_per_path_) return *beams_per_path_;
  tracer_.trace(0, kFewestPaths, static_cast<double>(kFewestPaths),
                stream_seed(seed_, RandomStream::kEmissionPilot), {}, context_.cancel);
  before_ = tracer_.counts();
  beams_per_path_ = static_cast<double>(tracer_.beams().size()) / static_cast<double>(kFewestPaths);
  return *beams_per_path_;
}

void BeamMap::learn() {
  Timer timer(context_.seconds.pilot);
  // Paths in dense media scatter often: as many beams are wanted as there would be paths
  const double beams = std::max(beams_per_path(), 1.0);
  const auto for_beams = [&](uint64_t most) {
    return std::max(kFewestLongPaths, static_cast<uint64_t>(static_cast<double>(most) / beams));
  };
  paths_ = for_beams(most_paths_);
  const uint64_t paths = std::min(paths_, for_beams(kPilotPaths));
  tracer_.learn_emission(paths, stream_seed(seed_, RandomStream::kEmissionPilot), {}, {}, nullptr,
                         context_.cancel);
  tracer_.trace(0, paths, static_cast<double>(paths), stream_seed(seed_, RandomStream::kPilot), {},
                context_.cancel);
  BeamTree::Settings s;
  const Bounds& bounds = context_.scene.bounds();
  s.middle = bounds.center();
  s.reach = std::max(0.505f * max_component(bounds.upper - bounds.lower), 1e-20f);
  if (context_.scene.world_volume >= 0) s.reach *= kWorldReach;
  s.footprint = [&](const Vec3& x) { return viewer_.footprint_from(x); };
  s.beams_per_disc = smooth_ ? kSmoothBeamsPerDisc : kBeamsPerDisc;
  s.looks = smooth_ ? kSmoothLooks : kLooks;
  s.variance = kBeside * variance_beside_;
  s.strength = [&](const PhotonBeam& beam) { return strength(*context_.scene.media(), beam); };
  s.more_beams = static_cast<double>(paths_) / static_cast<double>(paths);
  tree_.learn(tracer_.beams(), s);
  before_ = tracer_.counts();
}

void BeamMap::trace_pass() {
  Timer timer(context_.seconds.photons);
  if (!tree_.learnt()) learn();
  const RenderOptions& options = context_.options;
  const RenderPart& part = options.part;
  // As many for each camera sample, whose noise a denoiser takes off, in a pass of many
  const double more = options.adaptive_samples ? std::max(1.0, context_.sampler.mean_count()) : 1.0;
  const uint64_t paths = static_cast<uint64_t>(more * static_cast<double>(paths_));
  uint32_t seed = part.own(stream_seed(seed_, RandomStream::kPhotons));
  if (part.generation) seed = hash_combine(seed, part.generation);
  tracer_.trace(first_path_, paths, static_cast<double>(paths), seed, {}, context_.cancel);
  // Parts are taken for equal, as in RenderPart::paths()
  const double before = static_cast<double>(first_path_) / static_cast<double>(paths_),
               units = part.count * (part.passes_before + before) + part.number * more;
  first_path_ += paths;
  ++passes_;
  tree_.fill(tracer_.beams(), *context_.scene.media(),
             part.own(stream_seed(seed_, RandomStream::kPointGrid)) +
                 static_cast<uint32_t>(part.passes_before + passes_),
             options.radius_scale * static_cast<float>(std::pow(units, kShrinkExponent)),
             context_.scene.pool(), context_.cancel);
}

}  // namespace photon_splat
