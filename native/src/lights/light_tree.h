// A tree over many lights by which one is drawn in about its share of the light at a point (Conty
// Estevez & Kulla 2018, "Importance sampling of many lights with adaptive tree splitting").
#pragma once

#include <optional>
#include <vector>

#include "math/sampling.h"

namespace photon_splat {

class LightTree {
 public:
  // What a light may do at most. Its light leaves within `emission` of directions that lie within
  // `spread` of `axis`.
  struct Item {
    Bounds bounds;
    Vec3 axis{0, 0, 1};
    float spread = kPi, emission = kPi / 2;  // radians
    float energy = 0;                        // about radiant intensity, W/sr
    // Where BSDF rays share its light: see Lights::shares_with_rays
    Bounds reach;
  };

  void build(const std::vector<Item>& items);
  bool empty() const { return nodes_.empty(); }

  struct Choice {
    uint32_t item;
    float probability;
  };
  // One item for the point x with normal n (0: none), drawn by u in [0, 1). nullopt: none can shine
  // there.
  std::optional<Choice> pick(const Vec3& x, const Vec3& n, float u) const;
  // With which pick() would draw it.
  float probability(uint32_t item, const Vec3& x, const Vec3& n) const;
  // About the irradiance of all at x, never 0 where there is light.
  float importance(const Vec3& x, const Vec3& n) const {
    return empty() ? 0 : importance(nodes_[0], x, n);
  }

  // Calls visit(item) for every item whose bounds a ray meets before `far`.
  template <class Visit>
  void along(const Vec3& origin, const Vec3& direction, float far, Visit&& visit) const {
    const Vec3 inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
    descend([&](const Node& node) { return meets(node.bounds, origin, inverse, far); }, visit);
  }
  // True if x lies in some item's reach.
  bool reached(const Vec3& x) const;

 private:
  struct Node {
    Bounds bounds, reach;
    Vec3 axis;
    Vec2 spread;  // cosine and sine
    float cos_emission, energy;
    uint32_t first, second;  // children; a leaf: the item, twice
    uint32_t parent;
    bool leaf;
  };
  static constexpr int kDeepest = 128;  // of the stack: binned splits halve, now and then badly

  uint32_t add(const std::vector<Item>& items, uint32_t* begin, uint32_t* end, uint32_t parent,
               int depth);
  static float importance(const Node& node, const Vec3& x, const Vec3& n);
  static bool meets(const Bounds& b, const Vec3& origin, const Vec3& inverse, float far);

  template <class Enter, class Visit>
  void descend(Enter&& enter, Visit&& visit) const {
    uint32_t stack[kDeepest], height = 0;
    if (!empty()) stack[height++] = 0;
    while (height) {
      const Node& node = nodes_[stack[--height]];
      if (!enter(node)) continue;
      if (node.leaf) {
        visit(node.first);
        continue;
      }
      stack[height++] = node.second;
      stack[height++] = node.first;
    }
  }

  std::vector<Node> nodes_;
  std::vector<uint32_t> leaf_of_item_;
};

}  // namespace photon_splat
