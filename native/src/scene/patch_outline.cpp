#include "scene/patch_outline.h"

namespace photon_splat {
namespace {

// Number of a patch's edges up to which all are looked at, without the tree
constexpr uint32_t kFewEdges = 48;

float cross2(float ax, float ay, float bx, float by) { return ax * by - ay * bx; }

}  // namespace

void PatchOutline::add(const BoundaryEdge& edge) {
  const Instance& placed = scene_.instances[instance_];
  const auto in_plane = [&](const Vec3& p, float* out) {
    const Vec3 from = (placed.shared ? placed.to_world.point(p) : p) - x_;
    out[0] = dot(from, basis_.tangent);
    out[1] = dot(from, basis_.bitangent);
  };
  Edge e;
  in_plane(edge.a, e.a);
  in_plane(edge.b, e.b);
  const float along[2] = {e.b[0] - e.a[0], e.b[1] - e.a[1]}, square = sqr(along[0]) + sqr(along[1]);
  const float share =
      square > 0 ? std::clamp(-(e.a[0] * along[0] + e.a[1] * along[1]) / square, 0.0f, 1.0f) : 0;
  if (sqr(e.a[0] + share * along[0]) + sqr(e.a[1] + share * along[1]) <= sqr(reach_))
    edges_.push_back(e);
}

void PatchOutline::find_edges() {
  found_ = true;
  const Topology& topology = scene_.meshes[scene_.instances[instance_].mesh].topology;
  const uint32_t first = topology.first_edge[patch_], end = topology.first_edge[patch_ + 1];
  if (end - first <= kFewEdges)
    for (uint32_t i = first; i < end; ++i) add(topology.edges[i]);
  else
    edges_near(scene_, instance_, patch_, x_, reach_, [&](const BoundaryEdge& edge) { add(edge); });
}

bool PatchOutline::holds(float a, float b) {
  if (!found_) find_edges();
  bool on = true;
  for (const Edge& e : edges_) {
    // An end on the line itself counts as left of it, so that two edges which meet there are
    // crossed once or not at all.
    const float left_a = cross2(a, b, e.a[0], e.a[1]), left_b = cross2(a, b, e.b[0], e.b[1]);
    if ((left_a < 0) == (left_b < 0)) continue;
    // Where the line meets the edge, as a share of the way: cross(e.a, along) / cross(way, along).
    const float along = left_b - left_a, share = cross2(e.a[0], e.a[1], e.b[0], e.b[1]);
    on ^= along > 0 ? share >= 0 && share <= along : share <= 0 && share >= along;
  }
  return on;
}

}  // namespace photon_splat
