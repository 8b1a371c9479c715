// Meshes that emit: their triangles, drawn in proportion to power.
#pragma once

#include <algorithm>
#include <vector>

#include "lights/emission/photon_start.h"
#include "lights/light_sample.h"

namespace photon_splat {

// All that sampling reads of a triangle that emits: one line of the cache.
struct alignas(64) EmissiveTriangle {
  Vec3 corner[3];
  Vec3 normal;        // unit, on the front side
  float pdf;          // of its places, area measure, among all of the emitter
  float front_share;  // of its power
  uint32_t triangle;  // of the mesh
  uint32_t material;  // into Scene::materials
};

// How far off its triangle at x a photon of an emissive mesh starts, m.
float start_offset(const Scene& scene, uint32_t instance, const EmissiveTriangle& t, const Vec3& x);

struct MeshPoint;

// A triangle of an emissive instance at a time: `t` itself where that does not move, else `moved`.
const EmissiveTriangle& triangle_at_time(const Scene& scene, uint32_t instance,
                                         const EmissiveTriangle& t, float time,
                                         EmissiveTriangle& moved);

struct MeshLight {
  std::vector<EmissiveTriangle> triangles;
  std::vector<float> cdf;           // over triangles, by power
  std::vector<uint32_t> cdf_start;  // where to begin looking, for equal steps of the cdf

  size_t step_at(float target) const {
    const float at = target / cdf.back() * static_cast<float>(cdf_start.size());
    return std::min(static_cast<size_t>(at), cdf_start.size() - 1);
  }
  // The triangle whose share of the cdf holds `target`: a look-up and a step or two instead of a
  // search.
  size_t triangle_at(float target) const {
    return triangle_from(cdf_start[step_at(target)], target);
  }
  size_t triangle_from(size_t i, float target) const {
    while (i > 0 && cdf[i - 1] > target) --i;
    while (i + 1 < cdf.size() && cdf[i] <= target) ++i;
    return i;
  }
  // Probability with which the mesh's `triangle` is chosen; 0 where it does not emit.
  float share_of(uint32_t triangle) const {
    // Right where no other stands between them
    size_t i = size_t{triangle} - triangles.front().triangle;
    if (i >= triangles.size() || triangles[i].triangle != triangle)
      i = std::lower_bound(
              triangles.begin(), triangles.end(), triangle,
              [](const EmissiveTriangle& t, uint32_t number) { return t.triangle < number; }) -
          triangles.begin();
    if (i == triangles.size() || triangles[i].triangle != triangle) return 0;
    return (cdf[i] - (i ? cdf[i - 1] : 0)) / cdf.back();
  }
  // In [0, 1], uniform: where in the triangle's share of the cdf `target` lies.
  float side_of(size_t triangle, float target) const {
    const float low = triangle ? cdf[triangle - 1] : 0,
                share = std::max(cdf[triangle] - low, 1e-37f);
    return std::clamp((target - low) / share, 0.0f, 1.0f);
  }
  // At a time, `moved` being the triangle's memory then.
  MeshPoint point_at(const Scene& scene, uint32_t instance, float pick, const Vec2& place,
                     float time, EmissiveTriangle& moved) const;
};

// A place on an emissive mesh, in proportion to the power from there.
struct MeshPoint {
  Vec3 position;
  const EmissiveTriangle* triangle;
  float u, v;
  float side;  // uniform in [0, 1), to choose the side by
};

// Whether a material sends out light of its own.
bool may_emit(const Scene& scene, const Material& material);
// The triangles of an instance that emit; `power` is the sum over them, about, RGB averaged, W/pi.
// pool: or null, for one thread alone.
MeshLight make_mesh_light(const Scene& scene, ThreadPool* pool, uint32_t instance, Bounds& bounds,
                          double& power);
inline Rgb emission_of(const Scene& scene, uint32_t instance, const EmissiveTriangle& t, float u,
                       float v, bool back, const Vec3& wo, float time, uint16_t depth = 1,
                       float length = 0) {
  return scene.emission_at(scene.materials[t.material], instance, t.triangle, u, v, back, wo, time,
                           depth, length);
}
// As of lamps.
bool sample_mesh_light(const Scene& scene, const MeshLight& mesh, uint32_t instance,
                       const Receiver& to, const Vec2& u, LightSample& out);
PhotonStart emit_mesh_light(const Scene& scene, const MeshLight& mesh, uint32_t instance,
                            float pick, const Vec2& place, const Vec2& way, float time);

}  // namespace photon_splat
