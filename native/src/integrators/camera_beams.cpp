// Caustic light that photons bring into media, as camera rays see it on their way: L S+ V. What the
// path finds of it by chance further on is left out.
#include "integrators/camera_path.h"
#include "media/beam_tree.h"

namespace photon_splat {
namespace {

constexpr float kLaterLooks = 0.25f;  // of the ways of a path that has scattered in between
// Crossings at which the program of a medium runs that is not the same everywhere
constexpr int kPlaces = 4;

}  // namespace

bool CameraTracer::sees_beams(const Path& path) const {
  return beams_ && path.leaves_gather_points && path.vertex < path.max_bounces;
}

void CameraTracer::add_beams(Path& path, float far) const {
  if (!sees_beams(path) || is_black(path.throughput)) return;
  const Media& media = *scene_.media();
  const int stack = beams_->stack_of(path.media);
  if (stack < 0) return;
  const auto medium = media.homogeneous(path.media);
  if (medium && is_black(medium->scattering)) return;
  float weight = 1;
  if (path.info.after_diffuse || path.info.kind == RayInfo::kVolume) {
    if (path.random.next() >= kLaterLooks) return;
    weight = 1 / kLaterLooks;
  }
  GroupLight light{path.groups, path.throughput * weight};
  Rgb sum{};
  float detail = 0;  // luminance that the smaller kernel would take away
  const auto add = [&](const Rgb& radiance, const BeamCrossing& at) {
    sum += radiance;
    detail += luminance(path.throughput * radiance) * (1 - at.narrow_kernel / at.kernel);
    if (path.groups) light.add(radiance, at.piece.light_group);
  };
  const auto brought = [](const BeamCrossing& at) {
    return at.piece.power * attenuation(at.piece.extinction, at.along) * at.kernel;
  };
  if (medium) {
    const Rgb extinction = medium->extinction();
    beams_->each(stack, path.origin, path.direction, path.near, far, path.random,
                 [&](const BeamCrossing& at) {
                   float pdf;
                   add(brought(at) * medium->evaluate(path.direction, -at.piece.direction, &pdf) *
                           attenuation(extinction, at.distance - path.near),
                       at);
                 });
  } else {
    struct Seen {
      BeamCrossing at;
      Rgb light;
      float until;  // sum of the strengths so far
    };
    std::vector<Seen> seen;
    float all = 0;
    std::optional<Fading> fading;
    beams_->each(stack, path.origin, path.direction, path.near, far, path.random,
                 [&](const BeamCrossing& at) {
                   if (!fading)
                     fading = media.fading(path.media, path.origin, path.direction, path.near, far,
                                           path.info, path.random);
                   const Rgb own = brought(at) * fading->at(at.distance);
                   const float strength = max_abs(path.throughput * own);
                   if (strength > 0) seen.push_back({at, own, all += strength});
                 });
    const float first = path.random.next();
    for (int i = 0; i < kPlaces && !seen.empty(); ++i) {
      const float target = all * (static_cast<float>(i) + first) * (1.0f / kPlaces);
      const auto found = std::upper_bound(seen.begin(), seen.end() - 1, target,
                                          [](float t, const Seen& s) { return t < s.until; });
      const Vec3 x = path.origin + path.direction * found->at.distance;
      float pdf;
      const MediumPoint point = media.at(path.media, x, -path.direction, path.info);
      if (is_black(point.scattering)) continue;
      add(found->light * point.evaluate(path.direction, -found->at.piece.direction, &pdf) *
              (all / (kPlaces * max_abs(path.throughput * found->light))),
          found->at);
    }
  }
  if (is_black(sum)) return;
  const Rgb brings = path.throughput * sum * weight;
  add_finite(indirect_of(path.pixel, path.vertex == 0 ? LobeCategory::kVolume : path.category),
             brings, path.tile.bad_samples);
  if (can_be_added(brings)) path.pixel.detail += detail * weight;
}

}  // namespace photon_splat
