#include "render/beam_map.h"

#include "math/random_streams.h"

namespace photon_splat {
namespace {

constexpr double kShareOfPaths = 0.125;  // of a photon map's
constexpr uint64_t kFewestPaths = 1 << 10;
constexpr uint64_t kPilotPaths = 32768;
// A ray sees all beams that come within a radius of it on its whole way: fewer do than of photons
// on a surface.
constexpr double kBeamsPerDisc = 2;
// h ~ paths^(-1/5): for a kernel of one dimension variance falls with h and squared bias with h^4
constexpr double kShrinkExponent = -1.0 / 5.0;
// A medium that fills the world is looked at so far, in radii of what is in it
constexpr float kWorldReach = 32;

}  // namespace

BeamMap::BeamMap(const RenderContext& context, const Lights& lights, const Camera& viewer)
    : context_(context),
      viewer_(viewer),
      tracer_(context.scene, lights, context.options.max_bounces, PhotonStream::kCaustic),
      seed_(stream_seed(context.options.seed, RandomStream::kCausticBeams)),
      paths_(std::max(kFewestPaths,
                      static_cast<uint64_t>(
                          kShareOfPaths * static_cast<double>(context.options.photons_per_pass)))) {
  tracer_.leave_beams();
}

void BeamMap::begin_again() {
  passes_ = 0;
  tree_.clear();
  before_ = tracer_.counts();
}

void BeamMap::begin_part() {
  passes_ = 0;
  before_ = tracer_.counts();
}

void BeamMap::learn() {
  Timer timer(context_.seconds.pilot);
  const uint64_t paths = std::min(paths_, kPilotPaths);
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
  s.beams_per_disc = kBeamsPerDisc;
  s.more_beams = static_cast<double>(paths_) / static_cast<double>(paths);
  tree_.learn(tracer_.beams(), s);
  before_ = tracer_.counts();
}

void BeamMap::trace_pass() {
  Timer timer(context_.seconds.photons);
  if (!tree_.learnt()) learn();
  const RenderPart& part = context_.options.part;
  const uint64_t done = part.passes_before + passes_;
  tracer_.trace(done * paths_, paths_, static_cast<double>(paths_),
                part.own(stream_seed(seed_, RandomStream::kPhotons)), {}, context_.cancel);
  const float factor = context_.options.radius_scale *
                       static_cast<float>(std::pow(part.passes(passes_), kShrinkExponent));
  ++passes_;
  tree_.fill(
      tracer_.beams(), *context_.scene.media(),
      part.own(stream_seed(seed_, RandomStream::kPointGrid)) + static_cast<uint32_t>(done) + 1,
      factor, context_.scene.pool(), context_.cancel);
}

}  // namespace photon_splat
