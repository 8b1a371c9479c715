#include "geometry/topology.h"

#include <cstring>
#include <numeric>
#include <tuple>

#include "math/sampling.h"

namespace photon_splat {
namespace {

constexpr uint32_t kNone = ~0u;
constexpr uint32_t kCheckEvery = 1 << 16;  // iterations between looks at the cancel flag

void check_now_and_then(uint64_t iteration, const CancelFlag& cancel) {
  if (iteration % kCheckEvery == 0) cancel.check();
}

constexpr float kPlanarCosine = 0.9999995f;  // 0.06 degrees

// Where vertices at the same place have one name: that of the first of them.
class Welded {
 public:
  Welded(std::span<const Vec3> positions, size_t count) : positions_(positions) {
    size_t capacity = 16;
    while (capacity < 2 * count) capacity *= 2;
    table_.assign(capacity, kNone);
  }

  uint32_t operator()(uint32_t vertex) {
    const Vec3 p = positions_[vertex] + Vec3{0, 0, 0};  // turns -0 into +0
    uint32_t bits[3];
    std::memcpy(bits, &p, sizeof bits);
    const uint64_t hash = hash64(bits[0] | uint64_t{bits[1]} << 32) ^ hash64(bits[2]);
    const size_t last = table_.size() - 1;
    for (size_t slot = hash & last;; slot = (slot + 1) & last) {
      uint32_t& known = table_[slot];
      if (known == kNone) return known = vertex;
      const Vec3& q = positions_[known];
      if (q.x == p.x && q.y == p.y && q.z == p.z) return known;
    }
  }

 private:
  std::span<const Vec3> positions_;
  std::vector<uint32_t> table_;
};

uint32_t find_root(std::span<uint32_t> parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// Joins triangles across their edges. An edge joins the same vertices; edges that one triangle
// alone then has are the same that join the same places.
class Joiner {
 public:
  Joiner(std::span<const Vec3> positions, std::span<const Triangle> triangles,
         ScratchMemory& scratch, Topology& out, const CancelFlag& cancel)
      : positions_(positions), triangles_(triangles), out_(out), cancel_(cancel) {
    const size_t count = triangles.size();
    scratch.begin(count * (sizeof(Vec3) + sizeof(float) + 3 * sizeof(uint32_t)) +
                  positions.size() * sizeof(uint32_t));
    normal_ = scratch.take<Vec3>(count);
    area_ = scratch.take<float>(count);
    first_ = scratch.take<uint32_t>(positions.size());
    next_ = scratch.take<uint32_t>(3 * count);
  }

  void measure_triangles() {
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      const Vec3 &a = positions_[triangles_[t][0]], &b = positions_[triangles_[t][1]],
                 &c = positions_[triangles_[t][2]];
      const Vec3 n = cross(b - a, c - a);
      const float len = length(n);
      area_[t] = 0.5f * len;
      normal_[t] = len > 0 ? n / len : Vec3{0, 0, 1};
    }
  }

  void join_edges() {
    out_.patch.resize(triangles_.size());
    std::iota(out_.patch.begin(), out_.patch.end(), 0u);
    list_half_edges();
    std::vector<End> ends;
    std::vector<uint32_t> open;
    for (uint32_t v = 0; v < first_.size(); ++v) {
      check_now_and_then(v, cancel_);
      ends.clear();
      for (uint32_t h = first_[v]; h != kNone; h = next_[h]) {
        const uint32_t a = begin(h), b = end(h);
        ends.push_back({std::max(a, b), h, a < b});
      }
      match(ends, [&](uint32_t half) { open.push_back(half); });
    }
    join_open_edges(open);
  }

  const Vec3& normal(uint32_t triangle) const { return normal_[triangle]; }
  float area(uint32_t triangle) const { return area_[triangle]; }
  Vec3 from(uint32_t half) const { return positions_[begin(half)]; }
  Vec3 to(uint32_t half) const { return positions_[end(half)]; }

  bool closed() const { return single_.empty(); }

  // Calls visit(half-edge) for those where a patch ends. A crease between triangles that are joined
  // some other way round is no end: photons beyond it count.
  template <class Visit>
  void for_boundary(Visit&& visit) const {
    for (const uint32_t half : single_) visit(half);
    for (const auto& [a, b] : creases_)
      if (out_.patch[a / 3] != out_.patch[b / 3]) visit(a), visit(b);
  }

 private:
  struct End {
    uint32_t other, half;
    bool upwards;  // from the smaller vertex to the other one
  };

  // Half-edges are 3 * triangle + corner where they begin.
  uint32_t begin(uint32_t half) const { return triangles_[half / 3][half % 3]; }
  uint32_t end(uint32_t half) const { return triangles_[half / 3][(half + 1) % 3]; }

  // By their smaller vertex.
  void list_half_edges() {
    std::fill(first_.begin(), first_.end(), kNone);
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      check_now_and_then(t, cancel_);
      const Triangle& v = triangles_[t];
      for (uint32_t k = 0; k < 3; ++k) {
        uint32_t& head = first_[std::min(v[k], v[(k + 1) % 3])];
        next_[3 * t + k] = head;
        head = 3 * t + k;
      }
    }
  }

  // Joins the two half-edges of an edge, where they go opposite ways: two that go the same way are
  // of a triangle and its double, not of neighbours, or of one that is turned over. alone(half): of
  // edges that have one. ends: of one vertex.
  template <class Alone>
  void match(std::vector<End>& ends, Alone&& alone) {
    constexpr size_t kFew = 16;
    if (ends.size() > kFew) {
      std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) {
        return std::tuple(a.other, a.half) < std::tuple(b.other, b.half);
      });
    } else {
      for (size_t i = 1; i < ends.size(); ++i)
        for (size_t k = i; k > 0 && ends[k].other < ends[k - 1].other; --k)
          std::swap(ends[k], ends[k - 1]);
    }
    for (size_t begin = 0, end; begin < ends.size(); begin = end) {
      for (end = begin + 1; end < ends.size() && ends[end].other == ends[begin].other;) ++end;
      if (end - begin == 1)
        alone(ends[begin].half);
      else if (end - begin == 2 && ends[begin].upwards != ends[begin + 1].upwards)
        join(ends[begin].half, ends[begin + 1].half);
      else
        for (size_t i = begin; i < end; ++i) single_.push_back(ends[i].half);
    }
  }

  void join(uint32_t a, uint32_t b) {
    const uint32_t t = a / 3, other = b / 3;
    if (!(dot(normal_[t], normal_[other]) > Topology::kCreaseCosine)) {
      creases_.push_back({a, b});
      return;
    }
    const std::span<uint32_t> parent = out_.patch;
    const uint32_t i = find_root(parent, t), k = find_root(parent, other);
    parent[std::max(i, k)] = std::min(i, k);
    constexpr float kLeast = 1e-4f;
    const float turn2 = length2(cross(normal_[t], normal_[other])), edge = length(to(a) - from(a));
    // Mean height over the edge
    const float across = edge > 0 ? (area_[t] + area_[other]) / edge : 0.0f;
    if (!(turn2 > kLeast * kLeast && across > 0)) return;
    if (out_.curvature.empty()) out_.curvature.assign(triangles_.size(), 0.0f);
    for (const uint32_t side : {t, other})
      out_.curvature[side] = std::max(out_.curvature[side], std::sqrt(turn2) / across);
  }

  void join_open_edges(const std::vector<uint32_t>& open) {
    struct Open {
      uint32_t first;
      End end;
    };
    Welded welded(positions_, 2 * open.size());
    std::vector<Open> sorted;
    sorted.reserve(open.size());
    for (const uint32_t half : open) {
      check_now_and_then(sorted.size(), cancel_);
      const uint32_t a = welded(begin(half)), b = welded(end(half));
      sorted.push_back({std::min(a, b), {std::max(a, b), half, a < b}});
    }
    cancel_.check();
    std::sort(sorted.begin(), sorted.end(), [](const Open& a, const Open& b) {
      return std::tuple(a.first, a.end.half) < std::tuple(b.first, b.end.half);
    });
    std::vector<End> ends;
    for (size_t i = 0; i < sorted.size();) {
      check_now_and_then(i, cancel_);
      ends.clear();
      for (const uint32_t first = sorted[i].first; i < sorted.size() && sorted[i].first == first;)
        ends.push_back(sorted[i++].end);
      match(ends, [&](uint32_t half) { single_.push_back(half); });
    }
  }

  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  Topology& out_;
  const CancelFlag& cancel_;
  std::span<Vec3> normal_;
  std::span<float> area_;
  std::span<uint32_t> first_, next_;
  std::vector<uint32_t> single_;  // half-edges without a partner
  std::vector<std::pair<uint32_t, uint32_t>> creases_;
};

// Numbers the sets of triangles; returns the first triangle of each.
std::vector<uint32_t> number_patches(std::span<uint32_t> parent) {
  // A triangle comes after its parent, and both hold the number of their patch in the end.
  for (uint32_t& p : parent) p = parent[p];
  std::vector<uint32_t> root;
  for (uint32_t t = 0; t < parent.size(); ++t) {
    if (parent[t] == t) {
      parent[t] = static_cast<uint32_t>(root.size());
      root.push_back(t);
    } else {
      parent[t] = parent[parent[t]];
    }
  }
  return root;
}

}  // namespace

Topology build_topology(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                        ScratchMemory& scratch, const CancelFlag& cancel) {
  Topology out;
  Joiner joiner(positions, triangles, scratch, out, cancel);
  joiner.measure_triangles();
  joiner.join_edges();
  out.closed = joiner.closed();
  const std::vector<uint32_t> root = number_patches(out.patch);
  const size_t patches = root.size();

  out.planar.assign(patches, 1);
  out.patch_curvature.assign(patches, 0.0f);
  // Doubles: a large patch may have millions of small ones
  std::vector<double> area(patches), rim(patches);
  bool all_planar = true;
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    const uint32_t patch = out.patch[t];
    area[patch] += joiner.area(t);
    if (dot(joiner.normal(t), joiner.normal(root[patch])) < kPlanarCosine) {
      out.planar[patch] = 0;
      all_planar = false;
    }
  }
  if (all_planar) out.curvature = {};
  for (uint32_t t = 0; t < out.curvature.size(); ++t) {
    float& most = out.patch_curvature[out.patch[t]];
    most = std::max(most, out.curvature[t]);
  }

  out.first_edge.assign(patches + 1, 0);
  joiner.for_boundary([&](uint32_t half) { ++out.first_edge[out.patch[half / 3] + 1]; });
  std::partial_sum(out.first_edge.begin(), out.first_edge.end(), out.first_edge.begin());
  out.edges.resize(out.first_edge.back());
  std::vector<uint32_t> next(out.first_edge.begin(), out.first_edge.end() - 1);
  joiner.for_boundary([&](uint32_t half) {
    const uint32_t patch = out.patch[half / 3];
    const BoundaryEdge& edge = out.edges[next[patch]++] = {joiner.from(half), joiner.to(half),
                                                           joiner.normal(half / 3), patch};
    rim[patch] += length(edge.b - edge.a);
  });
  out.patch_area.assign(area.begin(), area.end());
  out.patch_rim.assign(rim.begin(), rim.end());
  return out;
}

EdgeTree::EdgeTree(const std::vector<BoundaryEdge>& edges) : edges_(edges), order_(edges.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!edges.empty()) build(0, static_cast<uint32_t>(edges.size()));
}

uint32_t EdgeTree::build(uint32_t first, uint32_t count) {
  Bounds bounds;
  for (uint32_t i = first; i < first + count; ++i) {
    bounds.add(edges_[order_[i]].a);
    bounds.add(edges_[order_[i]].b);
  }
  const uint32_t index = static_cast<uint32_t>(nodes_.size());
  nodes_.push_back({bounds, first, count, 0});
  if (count <= 4) return index;
  const Vec3 size = bounds.upper - bounds.lower;
  const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  const uint32_t half = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + half,
                   order_.begin() + first + count, [&](uint32_t i, uint32_t j) {
                     const float a = edges_[i].a[axis] + edges_[i].b[axis],
                                 b = edges_[j].a[axis] + edges_[j].b[axis];
                     return a < b || (a == b && i < j);
                   });
  nodes_[index].count = 0;
  build(first, half);
  nodes_[index].right = build(first + half, count - half);
  return index;
}

}  // namespace photon_splat
