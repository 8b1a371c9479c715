// Surfaces of media that lie in other surfaces: fog that fills a room up to its walls, a box of
// smoke on a table, boxes of fog side by side. Rays that leave the one start beyond the other.
#include <atomic>
#include <cmath>

#include "math/sampling.h"
#include "media/media.h"
#include "shading/ops.h"

namespace photon_splat {
namespace {

// Of ray_offset(): surfaces are in each other up to there. A ray that starts anew is beyond both.
constexpr float kWithin = 0.5f;
constexpr float kGrazing = 0.02f;           // least cosine for which the way between them is known
constexpr uint32_t kMostSamples = 1 << 18;  // of all media together
constexpr uint32_t kSamples = 4096;         // of an object

}  // namespace

bool Media::is_clear(const Program& program) const {
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
    const auto op = static_cast<nodes::Op>(program.code[at]);
    if (op != nodes::Op::Transparent && op != nodes::Op::End) return false;
  }
  const Vec3 up{0, 0, 1};
  ShadingPoint point;
  point.ng = point.ns = point.wo = up;
  Bsdf bsdf(Transport::kRadiance, up, up, up, false);
  run_program(scene_, program, point, bsdf);
  const Rgb clear = bsdf.transparency();
  return std::min({clear.x, clear.y, clear.z}) >= 1;
}

// Other regions whose surfaces are passed in one step with this one; not those gone through both
// ways.
Media::TouchingList Media::touching(const Surface& s, const Gap& gap, float time) const {
  const float offset = ray_offset(s),
              reach = kWithin * offset / std::max(std::abs(dot(gap.direction, s.ng)), kGrazing),
              near = gap.at - reach, start = std::min(near, 0.0f),
              far = std::min(gap.at + reach, std::nextafter(gap.at + offset, INFINITY));
  const int own = region_of(s.instance, s.triangle);
  const Crossings crossings = scene_.crossings(gap.origin + gap.direction * start, gap.direction,
                                               near - start, far - start, kAllRays, time);
  TouchingList list;
  for (const Crossings::Met& met : crossings) {
    const int region = region_of(met.instance, met.triangle);
    if (region < 0 || region == own) continue;
    const auto same = [&](const Crossings::Met& other) {
      return region_of(other.instance, other.triangle) == region;
    };
    const auto first = std::find_if(crossings.begin(), crossings.end(), same);
    if (&met == first && std::all_of(first, crossings.end(), [&](const Crossings::Met& other) {
          return !same(other) || other.back == met.back;
        }))
      list.met[list.count++] = {region, met.back};
  }
  return list;
}

void Media::look_for_touched(Surface& s, const Vec3& origin, const Vec3& direction, RayMask kinds,
                             float time) const {
  const float reach = kWithin * ray_offset(s) / std::max(std::abs(dot(direction, s.ng)), kGrazing);
  const Crossings crossings = scene_.crossings(
      origin, direction, std::max(s.distance - reach, 0.0f), s.distance + reach, kinds, time);
  const Crossings::Met* nearest = nullptr;
  for (const Crossings::Met& met : crossings)
    if (!scene_.meshes[scene_.instances[met.instance].mesh].strands &&
        !is_clear(met.instance, met.triangle) && (!nearest || met.distance < nearest->distance))
      nearest = &met;
  if (!nearest) return;
  s = scene_.surface_at(nearest->instance, nearest->triangle, nearest->u, nearest->v, nearest->back,
                        time);
  s.distance = nearest->distance;
}

// Looked up at points of their surfaces: what none of them finds is too small to be seen.
void Media::find_touching(ThreadPool& pool, const CancelFlag& cancel) {
  std::vector<uint32_t> with_media;
  for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const Instance& instance = scene_.instances[i];
    const auto first = of_slot_.begin() + instance.first_material;
    if (!scene_.meshes[instance.mesh].strands && !scene_.meshes[instance.mesh].triangles.empty() &&
        std::any_of(first, first + instance.slot_count, [](int16_t region) { return region >= 0; }))
      with_media.push_back(i);
  }
  const uint32_t count = static_cast<uint32_t>(with_media.size());
  const uint32_t samples = std::clamp(kMostSamples / std::max(count, 1u), 4u, kSamples);
  std::atomic<bool> found{false};
  pool.for_each(count, cancel, [&](size_t i, int) {
    if (!found && touches(with_media[i], samples)) found = true;
  });
  touching_ = found;
}

bool Media::touches(uint32_t instance, uint32_t samples) const {
  const Mesh& mesh = scene_.meshes[scene_.instances[instance].mesh];
  const uint32_t triangles = static_cast<uint32_t>(mesh.triangles.size()),
                 step = std::max(triangles / samples, 1u),
                 looks = std::max(samples / triangles, 1u);
  for (uint32_t triangle = 0; triangle < triangles; triangle += step) {
    if (region_of(instance, triangle) < 0) continue;
    for (uint32_t look = 0; look < looks; ++look) {
      Vec2 at = sobol_2d(look, 0, triangle);
      if (at.x + at.y > 1) at = {1 - at.x, 1 - at.y};
      const Surface s = scene_.surface_at(instance, triangle, at.x, at.y, false);
      const float reach = kWithin * ray_offset(s.position, scene_.radius());
      const Crossings crossings = scene_.crossings(s.position + s.ng * reach, -s.ng, 0, 2 * reach,
                                                   kAllRays, kShutterCentre);
      for (const Crossings::Met& met : crossings)
        if (met.instance != instance && !scene_.meshes[scene_.instances[met.instance].mesh].strands)
          return true;
    }
  }
  return false;
}

}  // namespace photon_splat
