// Which places in the plane around a point are on its planar patch.
#pragma once

#include "scene/scene.h"

namespace photon_splat {

// Calls visit(edge) for the edges of a patch whose bounds come within `reach` of x, found by the
// mesh's tree.
template <class Visit>
void edges_near(const Scene& scene, uint32_t instance, uint32_t patch, const Vec3& x, float reach,
                Visit&& visit) {
  const Instance& placed = scene.instances[instance];
  const Vec3 local = placed.shared ? placed.to_local.point(x) : x;
  const float stretch =
      placed.shared
          ? std::max({length(placed.to_local.column(0)), length(placed.to_local.column(1)),
                      length(placed.to_local.column(2))})
          : 1.0f;
  scene.meshes[placed.mesh].edge_tree->near(local, reach * stretch, patch, visit);
}

// The outline of the patch of x, as far as `reach` around it. Whether a place is inside is told by
// how often the way to it crosses the patch's edges, which are looked up at the first question.
class PatchOutline {
 public:
  // `basis`: its normal is that of the patch. All arguments have to outlive this.
  PatchOutline(const Scene& scene, uint32_t instance, uint32_t patch, const Vec3& x,
               const Basis& basis, float reach)
      : scene_(scene), x_(x), basis_(basis), reach_(reach), instance_(instance), patch_(patch) {}

  // Whether x + tangent * a + bitangent * b is on the patch; no further from x than the reach.
  bool holds(float a, float b);

 private:
  struct Edge {
    float a[2], b[2];
  };
  void find_edges();
  void add(const BoundaryEdge& edge);

  const Scene& scene_;
  const Vec3& x_;
  const Basis& basis_;
  float reach_;
  uint32_t instance_, patch_;
  bool found_ = false;
  std::vector<Edge> edges_;  // from x, in the basis
};

}  // namespace photon_splat
