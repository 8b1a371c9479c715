// What shaders know of the curve or point that they are on.
#include "shading/frame.h"
#include "textures/hashes.h"

namespace photon_splat::nodes {
namespace {

// Random number of a curve or point by its index, as in Cycles.
float random_of_strand(uint32_t number) {
  return static_cast<float>(lookup3(number, 0u)) * (1.0f / 4294967295.0f);
}

Affine to_world(const Frame& f) {
  if (f.pose) return f.pose->to_world;
  return f.scene.instances[f.point.instance].to_world;
}

}  // namespace

Vec3 strand_tangent(const Frame& f) {
  const Strands* strands = f.strands();
  if (!strands || !strands->are_curves()) return {};
  return to_world(f).vector(strands->tangent(f.point.triangle, f.point.u, f.point.ray.time));
}

// Elsewhere than on curves along the edges of the triangle, as in Cycles.
HairFrame hair_frame(const Frame& f, const Vec3& tangent) {
  HairFrame out;
  const Strands* strands = f.strands();
  out.tangent = tangent;
  if (!(length2(tangent) > 0)) out.tangent = strand_tangent(f);
  if (!(length2(out.tangent) > 0) && f.is_on_surface() && !strands) {
    Vec3 corner[3];
    f.corners(corner);
    out.tangent = corner[1] - corner[0];
  }
  out.tangent = safe_normalize(out.tangent);
  const Vec3 across = cross(out.tangent, f.point.wo);
  if (strands && strands->shape() == StrandShape::kRibbon)
    out.across = f.point.v;
  else if (length2(across) > 1e-12f)
    out.across = dot(f.point.ng, normalize(across));
  out.rounded = strands && strands->are_curves() && !(length2(tangent) > 0);
  return out;
}

// Hair of particles has no direction of its own: the object's Z axis, as in Cycles (measured).
Vec3 strand_axis(const Frame& f, const Vec3& in_object, const Vec3& tangent) {
  const Strands* strands = f.strands();
  if (!strands || !strands->are_curves()) return {};
  const Vec3 world = to_world(f).vector(length2(in_object) > 0 ? in_object : Vec3{0, 0, 1});
  const Vec3 axis = world - tangent * dot(world, tangent);
  return length2(axis) > 0 && is_finite(axis) ? axis : Basis(tangent).tangent;
}

float strand_coverage(const Frame& f) {
  const Strands* strands = f.strands();
  const RayInfo& ray = f.point.ray;
  if (!strands || !strands->are_curves() || ray.kind != RayInfo::kCamera) return 1;
  const float radius = strands->radius(f.point.triangle, f.point.u, ray.time);
  return ray.footprint > 0 && radius > 0 ? 0.5f * ray.footprint / radius : 1;
}

void curves_info(Frame& f, const uint32_t* w) {
  const Strands* strands = f.strands();
  const uint32_t segment = f.point.triangle;
  const bool curve = strands && strands->are_curves();
  const uint32_t number = curve ? strands->strand(segment) : 0;
  f.set(w[0], curve ? 1.0f : 0.0f);
  if (w[1] != kUnused || w[2] != kUnused) {
    const float length = curve ? strands->length(number) : 0;
    f.set(w[1], length > 0 ? strands->length_to(segment, f.point.u) / length : 0);
    f.set(w[2], length);
  }
  f.set(w[3], curve ? 2 * strands->radius(segment, f.point.u, f.point.ray.time) : 0);
  if (w[4] != kUnused) {
    const Vec3 along = curve ? safe_normalize(strand_tangent(f)) : Vec3{};
    f.set(w[4], curve ? safe_normalize(f.point.wo - along * dot(along, f.point.wo)) : Vec3{});
  }
  f.set(w[5], curve ? random_of_strand(number) : 0);
}

void point_info(Frame& f, const uint32_t* w) {
  const Strands* strands = f.strands();
  const bool point = strands && !strands->are_curves();
  Vec3 position{};
  float radius = 0;
  if (point) {
    const StrandKey key = strands->key(f.point.triangle, f.point.ray.time);
    const Affine world = to_world(f);
    position = world.point(key.position) + Vec3{static_cast<float>(f.scene.origin[0]),
                                                static_cast<float>(f.scene.origin[1]),
                                                static_cast<float>(f.scene.origin[2])};
    const float side = key.radius / std::sqrt(3.0f);
    radius = length(world.vector({side, side, side}));
  }
  f.set(w[0], position);
  f.set(w[1], radius);
  f.set(w[2], point ? random_of_strand(f.point.triangle) : 0);
}

}  // namespace photon_splat::nodes
