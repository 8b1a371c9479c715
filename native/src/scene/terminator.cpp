// Where shadow rays start on coarse meshes whose normals are smooth: off the surface that the
// normals promise, or the mesh's own triangles draw a jagged terminator. The smooth surface over a
// triangle is taken as a parabola (van Overveld and Wyvill 1997, "Phong normal interpolation
// revisited"), the way there fades in as in Cycles (Shading > Geometry Offset).
#include "scene/scene.h"

namespace photon_splat {
namespace {

// How far, along the interpolated normal, the smooth surface lies beyond the triangle.
// weights: barycentric, of the vertices; side: 1 on the normals' side, -1 on the other.
float lift_of(const Vec3* vertices, const Vec3* normals, const float* weights, float side) {
  const Vec3 p = vertices[0] * weights[0] + vertices[1] * weights[1] + vertices[2] * weights[2];
  float parabola = 0, lowest = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3, last = (i + 2) % 3;
    parabola +=
        dot(normals[next] - normals[i], vertices[next] - vertices[i]) * weights[i] * weights[next];
    // The plane at this vertex, moved out until the whole triangle lies below it
    const Vec3 n = normals[i] * side;
    const float rise = std::max(
        {dot(vertices[next] - vertices[i], n), dot(vertices[last] - vertices[i], n), 0.0f});
    lowest = std::min(lowest, std::max(dot(vertices[i] - p, n) + rise, 0.0f));
  }
  return side * std::max(lowest, 0.5f * side * parabola);
}

constexpr float kStraight = 0.9995f;  // cosine between the normals of a fine mesh

}  // namespace

bool Scene::bent(const Surface& s) const {
  return dot(s.ng, s.ns) < kStraight && instances[s.instance].terminator_offset > 0;
}

Vec3 Scene::shadow_ray_origin(const Surface& s, const Vec3& to_light, float time) const {
  const Lookup& lookup = lookups_[s.instance];
  const Instance& instance = instances[s.instance];
  const float cutoff = instance.terminator_offset;
  if (!lookup.normals_mask || !(cutoff > 0)) return s.position;
  const float smooth = dot(s.ns, to_light), smooth_side = smooth < 0 ? -1.0f : 1.0f;
  const float cosine = smooth_side * dot(s.ng, to_light);
  const float near =
      std::abs(smooth) < cutoff ? 2 - (cosine + std::abs(smooth)) / cutoff : 1 - cosine / cutoff;
  if (!(near > 0)) return s.position;
  const Mesh& mesh = meshes[instance.mesh];
  const Triangle& t = mesh.triangles[s.triangle];
  const bool moving = moves(s.instance);
  const auto vertex = [&](int i) {
    return moving ? mesh.position(t[i], time) : mesh.positions[t[i]];
  };
  const Vec3 vertices[3] = {vertex(0), vertex(1), vertex(2)};
  Vec3 made[3];
  const Vec3* const normals =
      moving ? mesh.normals(s.triangle, time, made) : lookup.normals_of(s.triangle, made);
  const float weights[3] = {1 - s.u - s.v, s.u, s.v};
  Vec3 normal = normals[0] * weights[0] + normals[1] * weights[1] + normals[2] * weights[2];
  if (lookup.shared)
    normal = (moving ? pose_at(s.instance, time).to_world : instance.to_world).vector(normal);
  // As in Cycles by the triangle's own side, which normals far off it may be on the other side of
  const float side = dot(normal, s.ng) * smooth_side > 0 ? 1.0f : -1.0f;
  return s.position + normal * (lift_of(vertices, normals, weights, side) * std::min(near, 1.0f));
}

}  // namespace photon_splat
