#include "lights/light_tree.h"

#include <numeric>

namespace photon_splat {
namespace {

constexpr int kBins = 12;
constexpr int kDeepestByCost = 48;  // below it halves by number: the stack is bounded

struct Cone {
  Vec3 axis;
  float spread, emission;
};

// The smallest cone around two (Conty & Kulla, section 4.1), about.
Cone joined(const Cone& a, const Cone& b) {
  const Cone &wide = a.spread >= b.spread ? a : b, &narrow = a.spread >= b.spread ? b : a;
  const float emission = std::max(a.emission, b.emission);
  const float between = std::acos(std::clamp(dot(wide.axis, narrow.axis), -1.0f, 1.0f));
  if (std::min(between + narrow.spread, kPi) <= wide.spread)
    return {wide.axis, wide.spread, emission};
  const float spread = 0.5f * (wide.spread + between + narrow.spread);
  const Vec3 across = narrow.axis - wide.axis * dot(wide.axis, narrow.axis);
  const float length_across = length(across);
  if (spread >= kPi || length_across < 1e-6f) return {wide.axis, kPi, emission};
  const float turn = spread - wide.spread;
  return {normalize(wide.axis * std::cos(turn) + across * (std::sin(turn) / length_across)), spread,
          emission};
}

// Cosine and sine of an angle in [0, pi].
Vec2 angle_of(float cosine) {
  const float c = std::clamp(cosine, -1.0f, 1.0f);
  return {c, std::sqrt(1 - c * c)};
}

// Of an angle less another one, both in [0, pi]; of 0 where that is larger.
Vec2 less(const Vec2& angle, const Vec2& by) {
  if (angle.x >= by.x) return {1, 0};
  return {angle.x * by.x + angle.y * by.y, angle.y * by.x - angle.x * by.y};
}

// A set of lights: how much a random point sees of them, relative to others.
struct Group {
  Bounds bounds;
  Cone cone{};
  float energy = 0;
  size_t count = 0;

  void add(const LightTree::Item& item) {
    const Cone own{item.axis, item.spread, item.emission};
    cone = count++ ? joined(cone, own) : own;
    bounds.add(item.bounds);
    energy += item.energy;
  }
  void add(const Group& g) {
    if (!g.count) return;
    cone = count ? joined(cone, g.cone) : g.cone;
    bounds.add(g.bounds);
    energy += g.energy;
    count += g.count;
  }
  float cost() const {
    const float o = cone.spread, w = std::min(o + cone.emission, kPi);
    const float orientation =
        2 * kPi * (1 - std::cos(o)) +
        0.5f * kPi *
            (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
    const Vec3 e = bounds.upper - bounds.lower;
    return energy * std::max(orientation, 1e-3f) *
           (e.x * e.y + e.y * e.z + e.z * e.x + 1e-6f * dot(e, e));
  }
};

}  // namespace

void LightTree::build(const std::vector<Item>& items) {
  nodes_.clear();
  leaf_of_item_.assign(items.size(), 0);
  if (items.empty()) return;
  std::vector<uint32_t> order(items.size());
  std::iota(order.begin(), order.end(), 0u);
  nodes_.reserve(2 * items.size());
  add(items, order.data(), order.data() + order.size(), 0, 0);
}

uint32_t LightTree::add(const std::vector<Item>& items, uint32_t* begin, uint32_t* end,
                        uint32_t parent, int depth) {
  const uint32_t index = static_cast<uint32_t>(nodes_.size());
  Group all;
  Bounds reach, centers;
  for (const uint32_t* i = begin; i < end; ++i) {
    all.add(items[*i]);
    if (!items[*i].reach.empty()) reach.add(items[*i].reach);
    centers.add(items[*i].bounds.center());
  }
  const Vec2 spread{std::cos(all.cone.spread), std::sin(all.cone.spread)};
  nodes_.push_back({all.bounds, reach, all.cone.axis, spread, std::cos(all.cone.emission),
                    all.energy, *begin, *begin, parent, true});
  if (end - begin == 1) {
    leaf_of_item_[*begin] = index;
    return index;
  }
  uint32_t* middle = begin;
  const Vec3 extent = centers.upper - centers.lower;
  if (depth < kDeepestByCost) {
    float best = INFINITY;
    int best_axis = -1, best_bin = 0;
    const auto bin_of = [&](uint32_t item, int axis) {
      const float t = (items[item].bounds.center()[axis] - centers.lower[axis]) / extent[axis];
      return std::clamp(static_cast<int>(t * kBins), 0, kBins - 1);
    };
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent[axis] > 0)) continue;
      Group bins[kBins], left[kBins];
      for (const uint32_t* i = begin; i < end; ++i) bins[bin_of(*i, axis)].add(items[*i]);
      Group running;
      for (int b = 0; b < kBins; ++b) {
        running.add(bins[b]);
        left[b] = running;
      }
      Group right;
      for (int b = kBins - 1; b > 0; --b) {
        right.add(bins[b]);
        if (!left[b - 1].count || !right.count) continue;
        const float longest = std::max({extent.x, extent.y, extent.z});
        const float cost = (left[b - 1].cost() + right.cost()) * longest / extent[axis];
        if (cost < best) {
          best = cost;
          best_axis = axis;
          best_bin = b;
        }
      }
    }
    if (best_axis >= 0)
      middle = std::partition(begin, end,
                              [&](uint32_t item) { return bin_of(item, best_axis) < best_bin; });
  }
  if (middle == begin || middle == end) middle = begin + (end - begin) / 2;
  const uint32_t first = add(items, begin, middle, index, depth + 1);
  const uint32_t second = add(items, middle, end, index, depth + 1);
  nodes_[index].first = first;
  nodes_[index].second = second;
  nodes_[index].leaf = false;
  return index;
}

float LightTree::importance(const Node& node, const Vec3& x, const Vec3& n) {
  const Vec3 to = node.bounds.center() - x;
  const float radius2 = 0.25f * length2(node.bounds.upper - node.bounds.lower), d2 = length2(to);
  const float falloff = node.energy / std::max({d2, radius2, 1e-30f});
  if (d2 <= radius2) return falloff;
  const Vec3 w = to / std::sqrt(d2);
  // Half of the angle that the bounds fill
  const Vec2 seen{std::sqrt(1 - radius2 / d2), std::sqrt(radius2 / d2)};
  float incoming = 1;  // cosine
  if (length2(n) > 0) {
    incoming = less(angle_of(dot(n, w)), seen).x;
    if (incoming <= 0) return 0;
  }
  const float outgoing = less(less(angle_of(-dot(node.axis, w)), node.spread), seen).x;
  if (outgoing < 1 && outgoing <= node.cos_emission) return 0;
  // Lights need not be Lambertian: what leaves sideways counts for something.
  return falloff * std::max(incoming, 0.05f) * std::max(outgoing, 0.05f);
}

std::optional<LightTree::Choice> LightTree::pick(const Vec3& x, const Vec3& n, float u) const {
  if (empty() || !(importance(nodes_[0], x, n) > 0)) return std::nullopt;
  uint32_t at = 0;
  float probability = 1;
  while (!nodes_[at].leaf) {
    const float first = importance(nodes_[nodes_[at].first], x, n),
                second = importance(nodes_[nodes_[at].second], x, n);
    const float sum = first + second;
    if (!(sum > 0)) return std::nullopt;
    const float share = first / sum;
    const bool left = u < share;
    u = std::clamp(left ? u / share : (u - share) / (1 - share), 0.0f, kBelowOne);
    probability *= left ? share : 1 - share;
    at = left ? nodes_[at].first : nodes_[at].second;
  }
  return Choice{nodes_[at].first, probability};
}

float LightTree::probability(uint32_t item, const Vec3& x, const Vec3& n) const {
  if (!(importance(nodes_[0], x, n) > 0)) return 0;
  float probability = 1;
  for (uint32_t at = leaf_of_item_[item]; at != 0; at = nodes_[at].parent) {
    const Node& parent = nodes_[nodes_[at].parent];
    const float first = importance(nodes_[parent.first], x, n),
                second = importance(nodes_[parent.second], x, n);
    if (!(first + second > 0)) return 0;
    const float share = first / (first + second);
    probability *= at == parent.first ? share : 1 - share;
  }
  return probability;
}

bool LightTree::meets(const Bounds& b, const Vec3& origin, const Vec3& inverse, float far) {
  float from = 0, to = far;
  for (int axis = 0; axis < 3; ++axis) {
    float near_side = (b.lower[axis] - origin[axis]) * inverse[axis],
          far_side = (b.upper[axis] - origin[axis]) * inverse[axis];
    if (near_side > far_side) std::swap(near_side, far_side);
    if (near_side > from) from = near_side;  // a NaN (a ray within a slab's plane) changes nothing
    if (far_side < to) to = far_side;
  }
  return from <= to * (1 + 1e-5f) + 1e-30f;
}

bool LightTree::reached(const Vec3& x) const {
  bool found = false;
  descend(
      [&](const Node& node) {
        const Bounds& b = node.reach;
        return !found && !b.empty() && x.x >= b.lower.x && x.y >= b.lower.y && x.z >= b.lower.z &&
               x.x <= b.upper.x && x.y <= b.upper.y && x.z <= b.upper.z;
      },
      [&](uint32_t) { found = true; });
  return found;
}

}  // namespace photon_splat
