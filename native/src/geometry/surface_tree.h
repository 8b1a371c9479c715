// The triangles of bent patches in a tree, with the moments of every branch: a kernel's integral
// over a surface then costs what its rim costs, however finely the surface is tessellated.
#pragma once

#include "geometry/topology.h"
#include "util/large_pages.h"

namespace photon_splat {

// Lengths in mesh coordinates.
struct SurfaceNode {
  Vec3 centre;   // mean position over the area
  float radius;  // of a ball about `centre` that holds all triangles
  Vec3 normal;   // mean of the unit normals over the area: the shorter, the more they differ
  float even;    // length of that mean
  float area;
  float spread[6];  // covariance of positions over the area, m^2: xx, yy, zz, xy, xz, yz
  uint32_t first;   // of its triangles, in order()
  uint32_t count;
  uint32_t right;  // second child, the first being the next node; 0: a leaf

  // Variance of v.x over the points x of the node.
  double variance_along(const Vec3& v) const {
    const float along = v.x * (v.x * spread[0] + 2 * (v.y * spread[3] + v.z * spread[4])) +
                        v.y * (v.y * spread[1] + 2 * v.z * spread[5]) + v.z * v.z * spread[2];
    return std::max(along, 0.0f);
  }
};

class SurfaceTree {
 public:
  SurfaceTree(std::span<const Vec3> positions, std::span<const Triangle> triangles,
              const Topology& topology, const CancelFlag& cancel);

  // Descends from a bent patch' root: enter(node) says whether to look at its children;
  // leaf(triangle) is called below leaves that were entered.
  template <class Enter, class Leaf>
  void visit(uint32_t patch, Enter&& enter, Leaf&& leaf) const {
    if (roots_.empty() || roots_[patch] == kNone) return;
    uint32_t stack[kDeepest], depth = 0;
    stack[depth++] = roots_[patch];
    while (depth) {
      const uint32_t index = stack[--depth];
      const SurfaceNode& node = nodes_[index];
      if (!enter(node)) continue;
      if (node.right) {
        stack[depth++] = node.right;
        stack[depth++] = index + 1;
      } else {
        for (uint32_t i = node.first; i < node.first + node.count; ++i) leaf(order_[i]);
      }
    }
  }

 private:
  static constexpr uint32_t kNone = ~0u, kLeaf = 8, kDeepest = 128;
  struct Builder;

  std::vector<uint32_t> order_;  // triangles of bent patches, sorted by patch
  LargeArray<SurfaceNode> nodes_;
  std::vector<uint32_t> roots_;  // per patch; kNone: planar; empty: all are
};

}  // namespace photon_splat
