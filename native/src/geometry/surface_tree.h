// The triangles of bent patches in a tree, with the moments of every branch: a kernel's integral
// over a surface then costs what its rim costs, however finely the surface is tessellated.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/topology.h"
#include "util/large_pages.h"

namespace photon_splat {

// Lengths in mesh coordinates. There are many: normal and spread are kept in 16 bits a number.
struct SurfaceNode {
  static constexpr float kMost = 32767;
  static constexpr uint32_t kIsLeaf = 1u << 31;

  Vec3 centre;   // mean position over the area
  float radius;  // of a ball about `centre` that holds all triangles
  float area;
  uint32_t first;      // of its triangles, in order
  uint32_t next;       // kIsLeaf | number of its triangles, or second child, the first being the
                       // node after this one
  int16_t normals[3];  // mean of the unit normals over the area: the shorter, the more they differ
  uint16_t evenness;   // length of that mean
  int16_t spread[6];   // covariance of positions over the area: xx, yy, zz, xy, xz, yz, in radius^2

  bool is_leaf() const { return next & kIsLeaf; }
  uint32_t count() const { return next & ~kIsLeaf; }  // of a leaf
  float even() const { return evenness / kMost; }
  Vec3 normal() const { return Vec3{normals[0] / kMost, normals[1] / kMost, normals[2] / kMost}; }
  float spread_unit() const { return radius * radius / kMost; }

  void set_normal(const Vec3& mean) {
    for (int i = 0; i < 3; ++i) normals[i] = rounded(mean[i]);
    evenness = static_cast<uint16_t>(rounded(length(mean)));
  }

  // covariance: m^2, within radius^2.
  void set_spread(const double covariance[6]) {
    const double scale = radius > 0 ? 1 / (double(radius) * radius) : 0;
    for (int i = 0; i < 6; ++i) spread[i] = rounded(static_cast<float>(covariance[i] * scale));
  }

  // Variance of v.x over the points x of the node.
  double variance_along(const Vec3& v) const {
    const float along = v.x * (v.x * spread[0] + 2 * (v.y * spread[3] + v.z * spread[4])) +
                        v.y * (v.y * spread[1] + 2 * v.z * spread[5]) + v.z * v.z * spread[2];
    return std::max(along * spread_unit(), 0.0f);
  }

 private:
  static int16_t rounded(float share) {
    return static_cast<int16_t>(std::lrint(std::clamp(share, -1.0f, 1.0f) * kMost));
  }
};

class SurfaceTree {
 public:
  SurfaceTree(std::span<const Vec3> positions, std::span<const Triangle> triangles,
              const Topology& topology, ScratchMemory& scratch, const CancelFlag& cancel);

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
      if (!node.is_leaf()) {
        stack[depth++] = node.next;
        stack[depth++] = index + 1;
      } else {
        for (uint32_t i = node.first; i < node.first + node.count(); ++i) leaf(order_[i]);
      }
    }
  }

  // A triangle below a node, drawn by u of [0, 1) with even chances for equal areas, given
  // area_of(triangle) in any unit.
  template <class AreaOf>
  uint32_t pick(const SurfaceNode& below, float u, AreaOf&& area_of) const {
    const SurfaceNode* node = &below;
    while (!node->is_leaf()) {
      const SurfaceNode &first = node[1], &second = nodes_[node->next];
      const float share = first.area / (first.area + second.area);
      const bool goes_first = u < share || !(second.area > 0);
      u = goes_first ? u / share : (u - share) / (1 - share);
      node = goes_first ? &first : &second;
    }
    float areas[kLeaf], all = 0;
    const uint32_t count = std::min(node->count(), kLeaf);
    for (uint32_t i = 0; i < count; ++i) all += areas[i] = area_of(order_[node->first + i]);
    uint32_t i = 0;
    for (u *= all; i + 1 < count && u >= areas[i]; ++i) u -= areas[i];
    return order_[node->first + i];
  }

 private:
  static constexpr uint32_t kNone = ~0u, kLeaf = 8, kDeepest = 128;
  struct Builder;

  LargeArray<uint32_t> order_;  // triangles of bent patches, sorted by patch
  LargeArray<SurfaceNode> nodes_;
  std::vector<uint32_t> roots_;  // per patch; kNone: planar; empty: all are
};

}  // namespace photon_splat
