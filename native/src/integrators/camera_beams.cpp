// Light that photon beams bring into media, as camera rays see it on their way: caustics, L S+ V,
// and in media that are the same everywhere all other light but direct light. What the path finds
// of it by chance further on is left out.
#include "integrators/camera_path.h"
#include "media/beam_tree.h"

namespace photon_splat {
namespace {

constexpr float kLaterLooks = 0.25f;  // of the ways of a path that has scattered in between
// Crossings at which the program of a medium runs that is not the same everywhere
constexpr int kPlaces = 4;
constexpr float kLeastMass = 0.05f;  // of a kernel

// Up to there from the middle of Epanechnikov's kernel, in radii.
float half_mass(float x) { return 0.75f * (x - x * x * x * (1 / 3.0f)); }

}  // namespace

bool CameraTracer::sees_beams(const Path& path) const {
  return (beams_.caustic || beams_.indirect) && path.leaves_gather_points &&
         path.vertex < path.max_bounces;
}

// Whether nothing is left for a path to find that scatters where it is.
bool CameraTracer::beams_bring_all(const Path& path) const {
  return beams_.indirect && sees_beams(path) && scene_.media()->homogeneous(path.media);
}

void CameraTracer::add_beams(Path& path, float far) const {
  if (!sees_beams(path) || is_zero(path.throughput)) return;
  float weight = 1;
  if (path.info.after_diffuse || path.info.kind == RayInfo::kVolume) {
    if (path.random.next() >= kLaterLooks) return;
    weight = 1 / kLaterLooks;
  }
  for (const BeamTree* const tree : {beams_.caustic, beams_.indirect})
    if (tree) add_beams(path, far, *tree, weight);
}

// What a crossing is to be weighted by, as surfaces cut its kernel off: the inverse of what is left
// of that, or nothing where the beam lies behind one.
float CameraTracer::kernel_share(const Path& path, const BeamCrossing& at) const {
  const float apart = length(at.apart);
  const Vec3 x = path.origin + path.direction * at.distance,
             across = apart > 1e-6f ? at.apart / apart : Basis(path.direction).tangent;
  const auto open = [&](const Vec3& direction) {
    Surface hit;
    ++path.tile.rays;
    const bool found =
        scene_.intersect(x, direction, 0, at.radius, false, hit, kAllRays, path.info.time);
    return found ? std::min(hit.distance / at.radius, 1.0f) : 1;
  };
  const float there = open(across);
  if (apart > there) return 0;
  return 1 / std::max(half_mass(there) + half_mass(open(-across)), kLeastMass);
}

void CameraTracer::add_beams(Path& path, float far, const BeamTree& tree, float weight) const {
  const Media& media = *scene_.media();
  const int stack = tree.stack_of(path.media);
  if (stack < 0) return;
  const MediumStack around = media.seen(path.media, ray_mask(path.info));
  const auto medium = media.homogeneous(around);
  if (medium && is_black(medium->scattering)) return;
  GroupLight light{path.groups, path.throughput * weight};
  Rgb sum{};
  float detail = 0;  // luminance that the smaller kernel would take away
  const auto add = [&](const Rgb& radiance, const BeamCrossing& at) {
    sum += radiance;
    if (path.groups) light.add(radiance, at.piece.light_group);
  };
  const auto brought = [](const BeamCrossing& at) {
    return at.piece.power * attenuation(at.piece.extinction, at.along) * at.kernel;
  };
  const auto see = [&](const Rgb& radiance, const BeamCrossing& at) {
    add(radiance, at);
    detail += luminance(path.throughput * radiance) * (1 - at.narrow_kernel / at.kernel);
  };
  if (medium) {
    const Rgb extinction = medium->extinction();
    // One of them, by its strength, tells of all how much surfaces cut off
    std::optional<BeamCrossing> told;
    Rgb of_told{};
    float all = 0, strength_of_told = 0;
    tree.each(stack, path.origin, path.direction, path.near, far, path.random,
              [&](const BeamCrossing& at) {
                float pdf;
                const Rgb own = brought(at) *
                                medium->evaluate(path.direction, -at.piece.direction, &pdf) *
                                attenuation(extinction, at.distance - path.near);
                see(own, at);
                const float strength = max_abs(path.throughput * own);
                all += strength;
                if (!(path.random.next() * all < strength)) return;
                told.emplace(at);
                of_told = own;
                strength_of_told = strength;
              });
    if (told)
      if (const float more = kernel_share(path, *told) - 1; more != 0)
        add(of_told * (more * all / strength_of_told), *told);
  } else {
    struct Seen {
      BeamCrossing at;
      Rgb light;
      float until;  // sum of the strengths so far
    };
    std::vector<Seen> seen;
    float all = 0;
    std::optional<Fading> fading;
    tree.each(stack, path.origin, path.direction, path.near, far, path.random,
              [&](const BeamCrossing& at) {
                if (!fading)
                  fading = media.fading(around, path.origin, path.direction, path.near, far,
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
      const MediumPoint point = media.at(around, x, -path.direction, path.info);
      if (is_black(point.scattering)) continue;
      const float share = kernel_share(path, found->at);
      if (share > 0)
        see(found->light * point.evaluate(path.direction, -found->at.piece.direction, &pdf) *
                (share * all / (kPlaces * max_abs(path.throughput * found->light))),
            found->at);
    }
  }
  if (is_zero(sum)) return;
  const Rgb brings = path.throughput * sum * weight;
  if (path.vertex == 0)
    add_finite(path.pixel.volume_indirect, brings, path.tile.bad_samples);
  else
    add_indirect(path, brings, path.diffuse_part);
  if (path.tries_beams && path.after_medium) see_deep(path, brings);
  if (can_be_added(brings)) path.pixel.detail += detail * weight;
}

}  // namespace photon_splat
