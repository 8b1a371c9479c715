#include "scene/coincident.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "math/sampling.h"

namespace photon_splat {
namespace {

constexpr int kLooks = 64;        // camera rays along each side of the picture
constexpr int kSteps = 64;        // surfaces that a camera ray may pass through
constexpr float kBeside = 0.25f;  // share of light that comes from a surface beside the one in view
constexpr float kRounding = 2e-7f;  // of a coordinate: further apart, surfaces are two
constexpr float kEdge = 1e-3f;      // least barycentric coordinate that is within a triangle
constexpr float kParallel = 0.99f;  // least cosine of their normals

}  // namespace

std::optional<Coincident> Scene::coincides(const Surface& s, RayMask kinds) const {
  const float reach = ray_epsilon(s.position, s.distance);
  const Vec3 start = s.position + s.ng * reach, way = -s.ng;
  const RayMask shadow = ray_bit(RayInfo::kShadow);
  const Crossings crossings =
      this->crossings(start, way, 0, 2 * reach, kinds | shadow, kShutterCentre);
  const auto own = std::find_if(crossings.begin(), crossings.end(), [&](const Crossings::Met& m) {
    return m.instance == s.instance && m.triangle == s.triangle;
  });
  // Where it meets its neighbours both are met.
  if (own == crossings.end() || std::min({own->u, own->v, 1 - own->u - own->v}) < kEdge) return {};
  for (auto m = crossings.begin(); m != crossings.end(); ++m) {
    if (m == own || meshes[instances[m->instance].mesh].strands) continue;
    if (!(std::abs(m->distance - own->distance) <= kRounding * max_abs(s.position))) continue;
    const Surface other = surface_at(m->instance, m->triangle, m->u, m->v, false);
    const bool passed = may_be_transparent(s), other_passed = may_be_transparent(other);
    if (std::abs(dot(other.ng, s.ng)) < kParallel || (passed && other_passed)) continue;
    const RayMask needed = passed || other_passed ? kinds : shadow;
    if (!(instances[s.instance].seen_by & instances[m->instance].seen_by & needed)) continue;
    if (other_passed) return Coincident{m->instance, s.instance, 0, true};
    return Coincident{s.instance, m->instance, 0, passed};
  }
  return {};
}

namespace {

// Calls met() for the surfaces on a ray's way, straight through glass, up to the first one that
// sends no light on or of which met() is true; true where there is that one, which is left in `s`.
template <class Met>
bool look(const Scene& scene, const Vec3& origin, const Vec3& direction, float near, float far,
          RayInfo::Kind kind, Surface& s, Met&& met) {
  for (int step = 0; step < kSteps; ++step, near = past(s)) {
    if (!scene.intersect(origin, direction, near, far, kind == RayInfo::kCamera, s,
                         ray_bit(kind)) ||
        s.on_strand())
      return false;
    if (met(s) || !(s.program && s.program->features & (kProgramTransmits | kProgramTransparent)))
      return true;
  }
  return false;
}

}  // namespace

std::vector<Coincident> coincident_surfaces(const Scene& scene, const Camera& camera) {
  if (scene.bounds().empty()) return {};
  const CameraSettings& frame = camera.settings();
  std::map<std::tuple<uint32_t, uint32_t, bool>, float> found;
  const auto noting = [&](float weight, RayInfo::Kind kind) {
    return [&, weight, kind](const Surface& s) {
      const auto pair = scene.coincides(s, ray_bit(kind));
      if (pair) found[{pair->instance, pair->other, pair->passed}] += weight;
      return pair && pair->passed;
    };
  };
  for (int j = 0; j < kLooks; ++j)
    for (int i = 0; i < kLooks; ++i) {
      const auto ray =
          camera.ray((2 * i + 1) * frame.region_width / (2 * kLooks),
                     (2 * j + 1) * frame.region_height / (2 * kLooks), {0.5f, 0.5f}, {0.5f, 0.5f});
      const uint32_t index = static_cast<uint32_t>(j * kLooks + i);
      Surface seen, beside;
      if (!ray || !look(scene, ray->origin, ray->direction, ray->near, ray->far, RayInfo::kCamera,
                        seen, noting(1, RayInfo::kCamera)))
        continue;
      const Vec3 way = Basis(seen.ng).to_world(sample_cosine_hemisphere(sobol_2d(index, 0, 0)));
      look(scene, leave(seen, way), way, 0, INFINITY, RayInfo::kDiffuse, beside,
           noting(kBeside, RayInfo::kDiffuse));
    }
  std::vector<Coincident> out;
  for (const auto& [pair, weight] : found)
    out.push_back(
        {std::get<0>(pair), std::get<1>(pair), weight / (kLooks * kLooks), std::get<2>(pair)});
  std::stable_sort(out.begin(), out.end(),
                   [](const Coincident& a, const Coincident& b) { return a.share > b.share; });
  return out;
}

}  // namespace photon_splat
