#include "geometry/topology.h"

#include <cstring>
#include <numeric>

#include "math/sampling.h"
#include "util/large_pages.h"

namespace photon_splat {
namespace {

constexpr uint32_t kNone = ~0u;
constexpr uint32_t kCheckEvery = 1 << 16;  // iterations between looks at the cancel flag

void check_now_and_then(uint64_t iteration, const CancelFlag& cancel) {
  if (iteration % kCheckEvery == 0) cancel.check();
}

constexpr float kPlanarCosine = 0.9999995f;  // 0.06 degrees

// Gives vertices at the same position the same number.
std::vector<uint32_t> weld(std::span<const Vec3> positions, const CancelFlag& cancel) {
  const size_t count = positions.size();
  size_t capacity = 16;
  while (capacity < 2 * count) capacity *= 2;
  std::vector<uint32_t> table(capacity, kNone), welded(count);
  constexpr uint32_t kAhead = 64;  // whose places in the table come while others are looked at
  uint64_t slots[kAhead];
  for (uint32_t first = 0; first < count; first += kAhead) {
    check_now_and_then(first, cancel);
    const uint32_t end = static_cast<uint32_t>(std::min<size_t>(first + kAhead, count));
    for (uint32_t i = first; i < end; ++i) {
      const Vec3 p = positions[i] + Vec3{0, 0, 0};  // turns -0 into +0
      uint32_t bits[3];
      std::memcpy(bits, &p, sizeof bits);
      const uint64_t hash = hash64(bits[0] | uint64_t{bits[1]} << 32) ^ hash64(bits[2]);
      slots[i - first] = hash & (capacity - 1);
      prefetch(&table[slots[i - first]]);
    }
    for (uint32_t i = first; i < end; ++i) {
      const Vec3& p = positions[i];
      uint64_t slot = slots[i - first];
      for (; table[slot] != kNone; slot = (slot + 1) & (capacity - 1)) {
        const Vec3& q = positions[table[slot]];
        if (q.x == p.x && q.y == p.y && q.z == p.z) break;
      }
      if (table[slot] == kNone) table[slot] = i;
      welded[i] = table[slot];
    }
  }
  return welded;
}

// partner[half] is the one other half-edge (3 * triangle + corner) on the same edge, or kNone where
// there is none or more than one. It goes the other way: two that go the same way are of a triangle
// and its double, not of neighbours, or of one that is turned over.
LargeArray<uint32_t> find_partners(const std::vector<uint32_t>& welded,
                                   std::span<const Triangle> triangles, const CancelFlag& cancel) {
  // Lists of the half-edges by their smaller vertex, in the memory of their partners
  std::vector<uint32_t> first(welded.size(), kNone);
  LargeArray<uint32_t> partner(3 * triangles.size());
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    check_now_and_then(t, cancel);
    const Triangle& corners = triangles[t];
    const uint32_t v[3] = {welded[corners[0]], welded[corners[1]], welded[corners[2]]};
    for (uint32_t k = 0; k < 3; ++k) {
      uint32_t& head = first[std::min(v[k], v[(k + 1) % 3])];
      partner[3 * t + k] = head;
      head = 3 * t + k;
    }
  }
  struct End {
    uint32_t other, id;
    bool upwards;  // from the smaller vertex to the other one
  };
  std::vector<End> ends;
  for (uint32_t v = 0; v < first.size(); ++v) {
    check_now_and_then(v, cancel);
    ends.clear();
    for (uint32_t h = first[v]; h != kNone; h = partner[h]) {
      const uint32_t a = welded[triangles[h / 3][h % 3]], b = welded[triangles[h / 3][(h + 1) % 3]];
      ends.push_back({std::max(a, b), h, a < b});
    }
    for (const End& end : ends) partner[end.id] = kNone;
    std::sort(ends.begin(), ends.end(),
              [](const End& a, const End& b) { return a.other < b.other; });
    for (size_t begin = 0, end; begin < ends.size(); begin = end) {
      for (end = begin + 1; end < ends.size() && ends[end].other == ends[begin].other;) ++end;
      if (end - begin != 2 || ends[begin].upwards == ends[begin + 1].upwards) continue;
      partner[ends[begin].id] = ends[begin + 1].id;
      partner[ends[begin + 1].id] = ends[begin].id;
    }
  }
  return partner;
}

uint32_t find_root(std::vector<uint32_t>& parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

Topology build_topology(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                        const CancelFlag& cancel) {
  const uint32_t count = static_cast<uint32_t>(triangles.size());
  const LargeArray<uint32_t> partner = find_partners(weld(positions, cancel), triangles, cancel);
  LargeArray<Vec3> normal(count);
  std::vector<float> area(count);
  for (uint32_t t = 0; t < count; ++t) {
    const Vec3 &a = positions[triangles[t][0]], &b = positions[triangles[t][1]],
               &c = positions[triangles[t][2]];
    const Vec3 n = cross(b - a, c - a);
    const float len = length(n);
    area[t] = 0.5f * len;
    normal[t] = len > 0 ? n / len : Vec3{0, 0, 1};
  }

  // Of the two half-edges of an edge the first alone, as there are many.
  const auto joins = [&](uint32_t half) {
    const uint32_t other = partner[half];
    return other != kNone && other > half &&
           dot(normal[half / 3], normal[other / 3]) > Topology::kCreaseCosine;
  };
  Topology out;
  std::vector<uint32_t>& parent = out.patch;
  parent.resize(count);
  std::iota(parent.begin(), parent.end(), 0u);
  for (uint32_t h = 0; h < 3 * count; ++h) {
    check_now_and_then(h, cancel);
    if (joins(h)) {
      const uint32_t a = find_root(parent, h / 3), b = find_root(parent, partner[h] / 3);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }

  // A triangle comes after its parent, and both hold the number of their patch in the end.
  for (uint32_t t = 0; t < count; ++t) parent[t] = parent[parent[t]];
  std::vector<uint32_t> root;  // of each patch, its first triangle
  for (uint32_t t = 0; t < count; ++t) {
    if (parent[t] == t) {
      parent[t] = static_cast<uint32_t>(root.size());
      root.push_back(t);
    } else {
      parent[t] = parent[parent[t]];
    }
  }
  const size_t patches = root.size();

  out.planar.assign(patches, 1);
  bool all_planar = true;
  for (uint32_t t = 0; t < count; ++t)
    if (dot(normal[t], normal[root[out.patch[t]]]) < kPlanarCosine) {
      out.planar[out.patch[t]] = 0;
      all_planar = false;
    }
  if (!all_planar) {
    out.curvature.assign(count, 0.0f);
    for (uint32_t h = 0; h < 3 * count; ++h) {
      if (!joins(h)) continue;
      const uint32_t t = h / 3, other = partner[h] / 3;
      const float turn = length(cross(normal[t], normal[other]));
      const float edge =
          length(positions[triangles[t][(h + 1) % 3]] - positions[triangles[t][h % 3]]);
      // Mean height over the edge
      const float across = edge > 0 ? (area[t] + area[other]) / edge : 0.0f;
      if (turn > 1e-4f && across > 0)
        for (const uint32_t side : {t, other})
          out.curvature[side] = std::max(out.curvature[side], turn / across);
    }
  }

  out.patch_curvature.assign(patches, 0.0f);
  for (uint32_t t = 0; t < count && !all_planar; ++t)
    out.patch_curvature[out.patch[t]] =
        std::max(out.patch_curvature[out.patch[t]], out.curvature[t]);

  out.patch_area.assign(patches, 0.0f);
  for (uint32_t t = 0; t < count; ++t) out.patch_area[out.patch[t]] += area[t];

  // A crease between triangles that are joined some other way round is no end: photons beyond it
  // count.
  const auto is_boundary = [&](uint32_t half) {
    return partner[half] == kNone || out.patch[half / 3] != out.patch[partner[half] / 3];
  };
  out.first_edge.assign(patches + 1, 0);
  for (uint32_t h = 0; h < 3 * count; ++h)
    if (is_boundary(h)) ++out.first_edge[out.patch[h / 3] + 1];
  std::partial_sum(out.first_edge.begin(), out.first_edge.end(), out.first_edge.begin());
  out.edges.resize(out.first_edge.back());
  out.patch_rim.assign(patches, 0.0f);
  std::vector<uint32_t> next(out.first_edge.begin(), out.first_edge.end() - 1);
  for (uint32_t h = 0; h < 3 * count; ++h) {
    check_now_and_then(h, cancel);
    if (!is_boundary(h)) continue;
    const Triangle& t = triangles[h / 3];
    const uint32_t patch = out.patch[h / 3];
    const BoundaryEdge& edge = out.edges[next[patch]++] = {
        positions[t[h % 3]], positions[t[(h + 1) % 3]], normal[h / 3], patch};
    out.patch_rim[patch] += length(edge.b - edge.a);
  }
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
