#include "geometry/surface_tree.h"

#include <bit>

#include "math/morton.h"
#include "util/radix_sort.h"

namespace photon_splat {
namespace {

// Integrals over a surface of 1, position, position times its transpose, and normal; doubles, as
// variances are differences.
struct Moments {
  double area = 0, first[3] = {}, second[6] = {}, normal[3] = {};

  void add(const Moments& m) {
    area += m.area;
    for (int i = 0; i < 3; ++i) first[i] += m.first[i], normal[i] += m.normal[i];
    for (int i = 0; i < 6; ++i) second[i] += m.second[i];
  }
};

constexpr int kPlaceBits = 30;     // of place_in()
constexpr size_t kUsedOfLeaf = 5;  // triangles in a leaf, about

// Axes of the entries of a symmetric matrix
constexpr int kPairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

// Among 1,024 cells along the longest axis of the bounds, the same on all axes, for branches to be
// compact.
uint64_t place_in(const Bounds& b, const Vec3& p) {
  const float size = max_component(b.upper - b.lower);
  const auto cell = [&](int axis) {
    const float u = size > 0 ? (p[axis] - b.lower[axis]) / size : 0;
    return static_cast<uint64_t>(std::clamp(u * 1024.0f, 0.0f, 1023.0f));
  };
  return morton(cell(0), cell(1), cell(2));
}

}  // namespace

struct SurfaceTree::Builder {
  std::span<const Vec3> positions;
  std::span<const Triangle> triangles;
  SurfaceTree& tree;
  const CancelFlag& cancel;
  std::span<uint32_t> places;  // Morton codes, sorted within a patch

  Vec3 centroid(uint32_t t) const {
    const Triangle& v = triangles[t];
    return (positions[v[0]] + positions[v[1]] + positions[v[2]]) * (1.0f / 3);
  }

  // Of a leaf, about `origin`. Floats about a corner of its own hold them well: it is small.
  Moments moments(uint32_t first, uint32_t end, const Vec3& origin) const {
    const Vec3 own = positions[triangles[tree.order_[first]][0]];
    float area = 0, mean[3] = {}, second[6] = {}, normal[3] = {};
    for (uint32_t i = first; i < end; ++i) {
      const Triangle& t = triangles[tree.order_[i]];
      const Vec3 a = positions[t[0]] - own, b = positions[t[1]] - own, c = positions[t[2]] - own;
      const Vec3 n = cross(b - a, c - a), sum = a + b + c;
      const float twice = length(n), weight = twice * (1.0f / 24);
      area += 0.5f * twice;
      for (int k = 0; k < 3; ++k) {
        mean[k] += twice * (1.0f / 6) * sum[k];
        normal[k] += 0.5f * n[k];
      }
      for (int k = 0; k < 6; ++k) {
        const auto [p, q] = kPairs[k];
        second[k] += weight * (a[p] * a[q] + b[p] * b[q] + c[p] * c[q] + sum[p] * sum[q]);
      }
    }
    Moments m;
    m.area = area;
    double offset[3];
    for (int k = 0; k < 3; ++k) {
      offset[k] = double(own[k]) - origin[k];
      m.first[k] = mean[k] + area * offset[k];
      m.normal[k] = normal[k];
    }
    for (int k = 0; k < 6; ++k) {
      const auto [p, q] = kPairs[k];
      m.second[k] = second[k] + double(mean[p]) * offset[q] + double(mean[q]) * offset[p] +
                    area * offset[p] * offset[q];
    }
    return m;
  }

  // Where the highest bit in which the places differ turns to 1; the middle where they are all
  // equal.
  uint32_t split(uint32_t first, uint32_t end) const {
    const uint32_t differ = places[first] ^ places[end - 1];
    if (!differ) return (first + end) / 2;
    const uint32_t bit = std::bit_floor(differ);
    return static_cast<uint32_t>(std::partition_point(places.begin() + first, places.begin() + end,
                                                      [&](uint32_t p) { return !(p & bit); }) -
                                 places.begin());
  }

  // Has the triangles of the leaves after the one that ends at `end` come.
  void fetch_ahead(uint32_t end) const {
    const size_t count = tree.order_.size();
    for (size_t i = end; i < std::min<size_t>(end + kLeaf, count); ++i)
      for (uint32_t v : triangles[tree.order_[i]]) prefetch(&positions[v]);
    for (size_t i = end + kLeaf; i < std::min<size_t>(end + 2 * kLeaf, count); ++i)
      prefetch(&triangles[tree.order_[i]]);
  }

  Moments build(uint32_t first, uint32_t end, const Vec3& origin) {
    const uint32_t index = static_cast<uint32_t>(tree.nodes_.size());
    tree.nodes_.emplace_back();
    Moments m;
    uint32_t right = 0;
    float radius = 0;
    if (end - first <= kLeaf) {
      fetch_ahead(end);
      m = moments(first, end, origin);
    } else {
      cancel.check();
      const uint32_t middle = split(first, end);
      m = build(first, middle, origin);
      right = static_cast<uint32_t>(tree.nodes_.size());
      m.add(build(middle, end, origin));
    }
    SurfaceNode node;
    const double scale = m.area > 0 ? 1 / m.area : 0;
    const double mean[3] = {m.first[0] * scale, m.first[1] * scale, m.first[2] * scale};
    const Vec3 offset{static_cast<float>(mean[0]), static_cast<float>(mean[1]),
                      static_cast<float>(mean[2])};
    node.centre = m.area > 0 ? origin + offset : centroid(tree.order_[first]);
    node.set_normal({static_cast<float>(m.normal[0] * scale),
                     static_cast<float>(m.normal[1] * scale),
                     static_cast<float>(m.normal[2] * scale)});
    node.area = static_cast<float>(m.area);
    if (right) {
      for (const SurfaceNode* child : {&tree.nodes_[index + 1], &tree.nodes_[right]})
        radius = std::max(radius, length(child->centre - node.centre) + child->radius);
    } else {
      for (uint32_t i = first; i < end; ++i)
        for (uint32_t v : triangles[tree.order_[i]])
          radius = std::max(radius, length2(positions[v] - node.centre));
      radius = std::sqrt(radius);
    }
    node.radius = radius;
    double covariance[6];
    for (int i = 0; i < 6; ++i)
      covariance[i] = m.second[i] * scale - mean[kPairs[i][0]] * mean[kPairs[i][1]];
    node.set_spread(covariance);
    node.first = first;
    node.next = right ? right : SurfaceNode::kIsLeaf | (end - first);
    tree.nodes_[index] = node;
    return m;
  }
};

SurfaceTree::SurfaceTree(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                         const Topology& topology, ScratchMemory& scratch,
                         const CancelFlag& cancel) {
  const size_t patches = topology.planar.size();
  std::vector<Bounds> bounds(patches);
  Builder builder{positions, triangles, *this, cancel, {}};
  size_t count = 0;
  for (uint32_t t = 0; t < triangles.size(); ++t)
    if (const uint32_t p = topology.patch[t]; !topology.planar[p]) {
      bounds[p].add(builder.centroid(t));
      ++count;
    }
  if (!count) return;
  const int key_bits = kPlaceBits + std::bit_width(patches - 1),
            triangle_bits = std::bit_width(triangles.size() - 1);
  const auto for_bent = [&](auto&& visit) {  // visit(key, triangle)
    for (uint32_t t = 0; t < triangles.size(); ++t)
      if (const uint32_t p = topology.patch[t]; !topology.planar[p])
        visit(uint64_t{p} << kPlaceBits | place_in(bounds[p], builder.centroid(t)), t);
  };
  order_.resize(count);
  const auto sort = [&]<class Keyed>(Keyed, auto&& keyed, int first_bit, auto&& key_of,
                                     auto&& triangle_of) {
    scratch.begin(count * (2 * sizeof(Keyed) + sizeof(uint32_t)));
    builder.places = scratch.take<uint32_t>(count);
    const std::span<Keyed> all = scratch.take<Keyed>(count), other = scratch.take<Keyed>(count);
    size_t n = 0;
    for_bent([&](uint64_t key, uint32_t t) { all[n++] = keyed(key, t); });
    cancel.check();
    const auto sorted = radix_sort(all, other, first_bit, first_bit + key_bits, nullptr, key_of);
    for (size_t i = 0; i < count; ++i) {
      const uint64_t key = key_of(sorted[i]) >> first_bit;
      builder.places[i] = static_cast<uint32_t>(key & ((uint64_t{1} << kPlaceBits) - 1));
      order_[i] = triangle_of(sorted[i]);
    }
  };
  if (key_bits + triangle_bits <= 64) {  // both in one number
    const uint64_t mask = (uint64_t{1} << triangle_bits) - 1;
    sort(
        uint64_t{}, [&](uint64_t key, uint32_t t) { return key << triangle_bits | t; },
        triangle_bits, [](uint64_t both) { return both; },
        [&](uint64_t both) { return static_cast<uint32_t>(both & mask); });
  } else {
    struct Placed {
      uint64_t key;
      uint32_t triangle;
    };
    sort(
        Placed{}, [](uint64_t key, uint32_t t) { return Placed{key, t}; }, 0,
        [](const Placed& one) { return one.key; }, [](const Placed& one) { return one.triangle; });
  }
  cancel.check();
  nodes_.reserve(2 * count / kUsedOfLeaf);
  roots_.assign(patches, kNone);
  for (uint32_t first = 0, end; first < count; first = end) {
    const uint32_t patch = topology.patch[order_[first]];
    end = static_cast<uint32_t>(
        std::partition_point(order_.begin() + first, order_.end(),
                             [&](uint32_t t) { return topology.patch[t] == patch; }) -
        order_.begin());
    roots_[patch] = static_cast<uint32_t>(nodes_.size());
    builder.build(first, end, bounds[patch].center());
  }
}

}  // namespace photon_splat
