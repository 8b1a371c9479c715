#include "scene/coincident.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "math/sampling.h"

namespace photon_splat {
namespace {

constexpr int kLooks = 64;        // camera rays along each side of the picture
constexpr int kSteps = 8;         // surfaces that a camera ray may pass through
constexpr float kBeside = 0.25f;  // share of light that comes from a surface beside the one in view
constexpr float kRounding = 2e-7f;  // of a coordinate: further apart, surfaces are two
constexpr float kEdge = 1e-3f;      // least barycentric coordinate that is within a triangle
constexpr float kParallel = 0.99f;  // least cosine of their normals

}  // namespace

std::optional<uint32_t> Scene::coincides(const Surface& s) const {
  const float reach = ray_epsilon(s.position, s.distance);
  const Vec3 start = s.position + s.ng * reach, way = -s.ng;
  const Crossings crossings =
      this->crossings(start, way, 0, 2 * reach, ray_bit(RayInfo::kShadow), kShutterCentre);
  const auto own = std::find_if(crossings.begin(), crossings.end(), [&](const Crossings::Met& m) {
    return m.instance == s.instance && m.triangle == s.triangle;
  });
  // Where it meets its neighbours both are met.
  if (own == crossings.end() || std::min({own->u, own->v, 1 - own->u - own->v}) < kEdge) return {};
  for (auto m = crossings.begin(); m != crossings.end(); ++m) {
    if (m == own || meshes[instances[m->instance].mesh].strands) continue;
    if (!(std::abs(m->distance - own->distance) <= kRounding * max_abs(s.position))) continue;
    const Surface other = surface_at(m->instance, m->triangle, m->u, m->v, false);
    if (std::abs(dot(other.ng, s.ng)) >= kParallel && !may_be_transparent(other))
      return m->instance;
  }
  return {};
}

namespace {

// Calls met() for the surfaces on a ray's way that are not transparent, straight through glass, up
// to the first one that sends no light on; true where there is that one, which is left in `s`.
template <class Met>
bool look(const Scene& scene, const Vec3& origin, const Vec3& direction, float near, float far,
          RayInfo::Kind kind, Surface& s, Met&& met) {
  for (int step = 0; step < kSteps; ++step, near = past(s)) {
    if (!scene.intersect(origin, direction, near, far, kind == RayInfo::kCamera, s,
                         ray_bit(kind)) ||
        s.on_strand())
      return false;
    if (scene.may_be_transparent(s)) continue;
    met(s);
    if (!(s.program && s.program->features & kProgramTransmits)) return true;
  }
  return false;
}

}  // namespace

std::vector<Coincident> coincident_surfaces(const Scene& scene, const Camera& camera) {
  if (scene.bounds().empty()) return {};
  const CameraSettings& frame = camera.settings();
  std::map<std::pair<uint32_t, uint32_t>, float> found;
  const auto noting = [&](float weight) {
    return [&, weight](const Surface& s) {
      if (const auto other = scene.coincides(s)) found[{s.instance, *other}] += weight;
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
                        seen, noting(1)))
        continue;
      const Vec3 way = Basis(seen.ng).to_world(sample_cosine_hemisphere(sobol_2d(index, 0, 0)));
      look(scene, leave(seen, way), way, 0, INFINITY, RayInfo::kDiffuse, beside, noting(kBeside));
    }
  std::vector<Coincident> out;
  for (const auto& [pair, weight] : found)
    out.push_back({pair.first, pair.second, weight / (kLooks * kLooks)});
  std::stable_sort(out.begin(), out.end(),
                   [](const Coincident& a, const Coincident& b) { return a.share > b.share; });
  return out;
}

}  // namespace photon_splat
