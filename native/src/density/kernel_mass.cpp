#include "density/kernel_mass.h"

#include "density/bent_mass.h"
#include "scene/patch_outline.h"

namespace photon_splat {
namespace {

// Planar patches up to here are summed whole, without cancellation
constexpr uint32_t kFewEdges = 48;
// h times curvature up to which the ball's mass is good to 0.3 %
constexpr float kGentle = 0.3f;
constexpr float kRadiusOverCurvature = 0.7f;

bool is_bent(const Instance& placed, const Topology& topology, uint32_t patch, float h) {
  return !topology.planar[patch] && h * topology.patch_curvature[patch] > kGentle * placed.scale;
}

KernelMass positive(const Masses& mass, bool exact) {
  return {std::max(static_cast<float>(mass.wide), kSmallestMass), exact,
          std::max(static_cast<float>(mass.narrow), kSmallestMass)};
}

}  // namespace

float curvature_radius_limit(const Scene& scene, uint32_t instance, uint32_t triangle) {
  const Instance& placed = scene.instances[instance];
  const float curvature = scene.meshes[placed.mesh].topology.curvature_of(triangle);
  return curvature > 0 ? kRadiusOverCurvature * placed.scale / curvature : INFINITY;
}

float patch_width(const Scene& scene, uint32_t instance, uint32_t triangle) {
  const Instance& placed = scene.instances[instance];
  const Topology& topology = scene.meshes[placed.mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  return topology.patch_rim[patch] > 0
             ? 2 * topology.patch_area[patch] / topology.patch_rim[patch] * placed.scale
             : INFINITY;
}

bool has_exact_mass(const Scene& scene, uint32_t instance, uint32_t triangle, float h) {
  const Instance& placed = scene.instances[instance];
  const Topology& topology = scene.meshes[placed.mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  return topology.planar[patch] || is_bent(placed, topology, patch, h);
}

KernelMass kernel_mass(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x,
                       const Vec3& normal, float h) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  const Topology& topology = mesh.topology;
  const uint32_t patch = topology.patch[triangle];
  const uint32_t first = topology.first_edge[patch], count = topology.first_edge[patch + 1] - first;
  const bool planar = topology.planar[patch] != 0;
  if (is_bent(placed, topology, patch, h))
    return positive(bent_mass(scene, instance, triangle, x, normal, h), true);
  if (!count) return {1, planar, 1};

  // The side about which edges run counter-clockwise in world space.
  const auto world_front = [&](const BoundaryEdge& edge) {
    const Vec3 n = placed.shared ? placed.to_local.transposed_vector(edge.normal) : edge.normal;
    const Vec3 front = dot(n, normal) >= 0 ? normal : -normal;
    return placed.mirrored ? -front : front;
  };
  const auto world = [&](const Vec3& p) { return placed.shared ? placed.to_world.point(p) : p; };

  Masses mass;
  EdgeInPlane e;
  if (planar && count <= kFewEdges) {
    EdgeInPlane edges[kFewEdges];
    uint32_t used = 0;
    bool cut = false;
    for (uint32_t i = first; i < first + count; ++i) {
      const BoundaryEdge& edge = topology.edges[i];
      if (!project(x, world_front(edge), h, world(edge.a), world(edge.b), e)) continue;
      edges[used++] = e;
      cut |= comes_within(e, 1);
    }
    if (!cut) return {1, true, 1};
    for (uint32_t i = 0; i < used; ++i) {
      mass.wide += triangle_mass(edges[i]);
      mass.narrow += triangle_mass(rescaled(edges[i], kNarrow));
    }
  } else {
    mass = {1, 1};
    edges_near(scene, instance, patch, x, h, [&](const BoundaryEdge& edge) {
      if (!project(x, world_front(edge), h, world(edge.a), world(edge.b), e)) return;
      mass.wide -= mass_beyond(e);
      mass.narrow -= mass_beyond(rescaled(e, kNarrow));
    });
  }
  return positive(mass, planar);
}

}  // namespace photon_splat
