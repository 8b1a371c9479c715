#include "occlusion.h"

#include "kernel_mass.h"
#include "sampling.h"

namespace photon_splat {
namespace {

constexpr int kScouts = 6;    // directions looked along first
constexpr int kDirections = 24;  // in all, where a scout met something
constexpr int kProbes = 3;       // looked at beyond it, per direction
constexpr float kHeight = 0.03f; // of the rays over the surface, in h: what is lower is no obstacle

// The part of a kernel (Epanechnikov) within the share s of its radius.
float mass_within(float s) {
  const float s2 = std::min(1.0f, s * s);
  return s2 * (2 - s2);
}

struct PatchQuery {
  const Scene& scene;
  uint32_t instance, patch;
  Vec3 y, normal;
  float tolerance;
  bool found = false;
};

// Whether the patch comes within the tolerance of y.
bool look_for_patch(RTCPointQueryFunctionArguments* arguments) {
  PatchQuery& q = *static_cast<PatchQuery*>(arguments->userPtr);
  const bool instanced = arguments->context->instStackSize > 0;
  if ((instanced ? arguments->context->instID[0] : arguments->geomID) != q.instance) return false;
  const Instance& placed = q.scene.instances[q.instance];
  const Mesh& mesh = q.scene.meshes[placed.mesh];
  if (mesh.topology.patch[arguments->primID] != q.patch) return false;
  Vec3 corner[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = mesh.positions[mesh.triangles[arguments->primID][i]];
    corner[i] = placed.shared ? placed.to_world.point(p) : p;
  }
  // Does the normal through y pass the triangle, near y? Edges take half a tolerance more, so that no seam shows.
  const Vec3 n = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const float len = length(n);
  if (!(len > 0) || std::abs(dot(q.y - corner[0], n)) > q.tolerance * len) return false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = corner[(i + 1) % 3] - corner[i];
    if (dot(cross(edge, q.y - corner[i]), n) < -1e-4f * q.tolerance * len * length(edge)) return false;
  }
  q.found = true;
  arguments->query->radius = 0;
  return true;
}

bool on_patch(const Scene& scene, uint32_t instance, uint32_t patch, const Vec3& y, const Vec3& normal, float tolerance) {
  PatchQuery q{scene, instance, patch, y, normal, tolerance};
  RTCPointQuery query{y.x, y.y, y.z, 0, tolerance};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene.embree(), &query, &context, look_for_patch, &q);
  return q.found;
}

}  // namespace

DiscOcclusion disc_occlusion(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key, const Vec3& x,
                             const Vec3& normal, float h, uint32_t seed) {
  DiscOcclusion out{0, 0, h};
  const Topology& topology = scene.meshes[scene.instances[instance].mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  if (!topology.planar[patch]) return out;  // rays along the tangent plane tell little of a bent surface
  const Basis basis(normal);
  const float turn = to_unit_float(hash32(seed));
  const Vec3 origin = x + normal * std::max(kHeight * h, ray_epsilon(x, h));
  const auto direction_of = [&](int i) {
    const float angle = 2 * kPi * (static_cast<float>(i) + turn) / kDirections;
    return basis.to_world({std::cos(angle), std::sin(angle), 0});
  };
  const auto met = [&](int i, float& distance) {
    Surface hit;
    if (!scene.intersect(origin, direction_of(i), 0, h, false, hit) || hit.key == key) return false;
    distance = hit.distance;
    return true;
  };
  float distance[kDirections];
  bool blocked[kDirections] = {}, any = false;
  for (int i = 0; i < kDirections; i += kDirections / kScouts) any |= blocked[i] = met(i, distance[i]);
  if (!any) return out;
  for (int i = 0; i < kDirections; ++i) {
    if (i % (kDirections / kScouts)) blocked[i] = met(i, distance[i]);
    if (!blocked[i]) continue;
    const float first = distance[i] / h;
    for (int k = 0; k < kProbes; ++k) {
      const float inner = first + (1 - first) * static_cast<float>(k) / kProbes, outer = first + (1 - first) * static_cast<float>(k + 1) / kProbes;
      const Vec3 y = x + direction_of(i) * (h * 0.5f * (inner + outer));
      if (!on_patch(scene, instance, patch, y, normal, 0.25f * kHeight * h)) continue;
      Surface above;
      if (scene.intersect(y + normal * (kHeight * h), normal, 0, INFINITY, false, above) && above.back && above.key != key) {
        out.hidden += (mass_within(outer) - mass_within(inner)) / kDirections;
        out.narrow_hidden += (mass_within(outer / kNarrow) - mass_within(inner / kNarrow)) / kDirections;
      } else {
        out.clear = std::min(out.clear, distance[i]);
      }
    }
  }
  return out;
}

}  // namespace photon_splat
