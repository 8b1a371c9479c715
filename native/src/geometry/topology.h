// Surface patches: what counts as one surface for density estimation, and where it ends.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"
#include "util/large_pages.h"
#include "util/parallel.h"
#include "util/scratch_memory.h"

namespace photon_splat {

using Triangle = std::array<uint32_t, 3>;

// An edge where a patch ends, counter-clockwise around the patch; `normal` is that of its triangle.
struct BoundaryEdge {
  Vec3 a, b, normal;
  uint32_t patch;
};

// Triangles joined across edges whose dihedral angle is below the crease angle make a patch.
// Vertices at the same position count as one, whatever their index; an edge shared by three or more
// triangles ends a patch.
struct Topology {
  static constexpr float kCreaseCosine = 0.9063f;  // 25 degrees

  LargeArray<uint32_t> patch;   // per triangle
  std::vector<uint8_t> planar;  // per patch
  // 1/m in mesh coordinates per triangle; empty when all patches are planar
  LargeArray<float> curvature;
  std::vector<float> patch_curvature;        // the largest of each patch
  std::vector<float> patch_area, patch_rim;  // m^2; length of its boundary, m: in mesh coordinates
  std::vector<BoundaryEdge> edges;           // sorted by patch
  std::vector<uint32_t> first_edge;          // per patch, and one past the end
  bool closed = false;                       // every edge has two sides, and they face one way

  float curvature_of(uint32_t triangle) const {
    return curvature.empty() ? 0.0f : curvature[triangle];
  }
};

// Throws Cancelled.
Topology build_topology(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                        ScratchMemory& scratch, const CancelFlag& cancel = {});

// Finds the boundary edges near a point; a median-split tree over their bounds.
class EdgeTree {
 public:
  explicit EdgeTree(const std::vector<BoundaryEdge>& edges);

  // Calls visit(edge) for every edge of `patch` whose bounds come within `radius` of `x`.
  template <class Visit>
  void near(const Vec3& x, float radius, uint32_t patch, Visit&& visit) const {
    if (!nodes_.empty()) descend(0, x, radius * radius, patch, visit);
  }

 private:
  struct Node {
    Bounds bounds;
    uint32_t first, count, right;  // count = 0: inner node, left child is the next one
  };

  uint32_t build(uint32_t first, uint32_t count);

  template <class Visit>
  void descend(uint32_t index, const Vec3& x, float radius2, uint32_t patch, Visit& visit) const {
    const Node& node = nodes_[index];
    const Vec3 gap = max(max(node.bounds.lower - x, x - node.bounds.upper), Vec3{});
    if (length2(gap) > radius2) return;
    if (node.count) {
      for (uint32_t i = node.first; i < node.first + node.count; ++i)
        if (edges_[order_[i]].patch == patch) visit(edges_[order_[i]]);
      return;
    }
    descend(index + 1, x, radius2, patch, visit);
    descend(node.right, x, radius2, patch, visit);
  }

  const std::vector<BoundaryEdge>& edges_;
  std::vector<uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace photon_splat
