// Tangents, normal maps and bumps.
#include <utility>

#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

// Where u grows on the triangle, in object coordinates, and on which side of it v does; no
// direction: 0.
Vec3 tangent_of_triangle(const Frame& f, uint32_t uv, float& sign) {
  sign = 1;
  const Mesh& mesh = f.mesh();
  if (mesh.strands) return {};
  const Triangle& t = mesh.triangles[f.point.triangle];
  std::array<float, 4> at[3]{};
  for (int k = 0; k < 3; ++k) {
    const float u = k == 1 ? 1.0f : 0.0f, v = k == 2 ? 1.0f : 0.0f;
    if (uv == kNone) {
      const Vec2 active = f.scene.uv_at(f.point.instance, f.point.triangle, u, v);
      at[k] = {active.x, active.y, 0, 0};
    } else if (const MeshAttribute* attribute = mesh.attribute(uv)) {
      at[k] = attribute->at(t, f.point.triangle, u, v);
    }
  }
  const float u1 = at[1][0] - at[0][0], v1 = at[1][1] - at[0][1], u2 = at[2][0] - at[0][0],
              v2 = at[2][1] - at[0][1];
  const float area = u1 * v2 - u2 * v1;
  const bool shared = f.scene.instances[f.point.instance].shared;
  // A mirrored mesh that stands in world coordinates has its corners in the other order.
  const bool reversed = !shared && determinant(f.object_to_world()) < 0;
  sign = (area < 0) != reversed ? -1.0f : 1.0f;
  const float time = f.point.ray.time;
  const Vec3 first = mesh.position(t[0], time), e1 = mesh.position(t[1], time) - first,
             e2 = mesh.position(t[2], time) - first;
  const Vec3 direction = (e1 * v2 - e2 * v1) * (area < 0 ? -1.0f : 1.0f);
  return shared ? direction : f.world_to_object().vector(direction);
}

// An attribute where the point itself is: what a frame is made of is not shifted for bumps, in
// Cycles either.
bool attribute_here(Frame& f, uint32_t id, std::array<float, 4>& value) {
  const Vec3 shift = std::exchange(f.shift, Vec3{});
  f.knows_uv = false;
  uint32_t components;
  const bool found = f.attribute(id, value, components);
  f.shift = shift;
  f.knows_uv = false;
  return found;
}

// Tangent and sign of the bitangent in object coordinates, the tangent not normalised, as the
// exporter gives them or from the triangle's UVs.
Vec3 tangent_frame(Frame& f, uint32_t tangent, uint32_t uv, float& sign) {
  std::array<float, 4> value{};
  if (!attribute_here(f, tangent, value)) return safe_normalize(tangent_of_triangle(f, uv, sign));
  sign = value[3] < 0 ? -1.0f : 1.0f;
  return {value[0], value[1], value[2]};
}

// The surface's own normal in object coordinates, on its front, not normalised where it is smooth.
Vec3 front_normal_in_object(const Frame& f) {
  const Mesh& mesh = f.mesh();
  if (!mesh.is_smooth()) return f.normal_to_object(f.point.back ? -f.point.ng : f.point.ng);
  Vec3 moved[3];
  const Vec3* n = mesh.normals(f.point.triangle, f.point.ray.time, moved);
  const bool shared = f.scene.instances[f.point.instance].shared;
  const auto own = [&](int k) { return shared ? n[k] : f.normal_to_object(n[k]); };
  return own(0) * (1 - f.point.u - f.point.v) + own(1) * f.point.u + own(2) * f.point.v;
}

Vec3 across(const Frame& f, const Vec3& tangent_in_object) {
  const Vec3 n = f.normal(), t = f.normal_from_object(tangent_in_object);
  return cross(n, safe_normalize(cross(t, n)));
}

}  // namespace

void Frame::corners(Vec3* corner) const {
  scene.corners(point.instance, point.triangle, point.ray.time, corner);
}

const OffsetAxes& Frame::offset_axes() {
  if (knows_axes) return axes;
  const float size = point.ray.footprint > 0 ? point.ray.footprint : 5e-4f * scene.near_radius();
  const Vec3 n = point.ng;
  // Perpendicular to (1, 1, 1) and the normal, which is where Cycles has its first direction.
  Vec3 x{n.z - n.y, n.x - n.z, n.y - n.x};
  if (n.x == n.y && n.x == n.z) x = {n.z - n.y, n.x + n.z, -n.y - n.x};
  x = safe_normalize(x);
  knows_axes = true;
  return axes = {x * size, cross(n, x) * size};
}

// UV of the point itself and its change along the shift, by least squares in the triangle's plane.
// Cycles has that change reversed where the back is seen, while positions go along the shift: bumps
// by UVs and attributes stand out of the side that the same bumps by coordinates are sunk into.
Vec2 Frame::uv_there() {
  if (knows_uv) return shifted_uv;
  knows_uv = true;
  shifted_uv = {point.u, point.v};
  if (!is_on_surface() || strands() || (shift.x == 0 && shift.y == 0 && shift.z == 0))
    return shifted_uv;
  Vec3 corner[3];
  corners(corner);
  const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
  const float a = dot(e1, e1), b = dot(e1, e2), c = dot(e2, e2), determinant = a * c - b * b;
  if (!(determinant > 0)) return shifted_uv;
  const Vec3 along = point.back ? -shift : shift;
  const float p = dot(e1, along), q = dot(e2, along);
  return shifted_uv = {point.u + (p * c - q * b) / determinant,
                       point.v + (q * a - p * b) / determinant};
}

void tangent_radial(Frame& f, const uint32_t* w) {
  const Vec3 g = f.generated() - Vec3{0.5f, 0.5f, 0.5f};
  Vec3 t;
  switch (f.mode<Axis>(w[1])) {
    case Axis::X: t = {0, -g.z, g.y}; break;
    case Axis::Y: t = {-g.z, 0, g.x}; break;
    case Axis::Z: t = {-g.y, g.x, 0}; break;
  }
  f.set(w[0], across(f, t));
}

void tangent_uv(Frame& f, const uint32_t* w) {
  float sign = 1;
  f.set(w[0], !f.is_on_surface() ? Vec3{} : across(f, tangent_frame(f, w[1], w[2], sign)));
}

void normal_map(Frame& f, const uint32_t* w) {
  const MapSpace space = f.mode<MapSpace>(w[3]);
  const Vec3 shading = f.normal();
  float strength = f.number(w[1]);
  Vec3 c = (f.vector(w[2]) - Vec3{0.5f, 0.5f, 0.5f}) * 2;
  Vec3 n;
  if (!f.is_on_surface()) return f.set(w[0], shading);
  if (space == MapSpace::TANGENT) {
    float sign = 1;
    const Vec3 tangent = tangent_frame(f, w[4], w[5], sign);
    Vec3 own = front_normal_in_object(f);
    std::array<float, 4> original{};
    const bool before = w[7] != kNone && attribute_here(f, w[7], original);
    if (before) own = {original[0], original[1], original[2]};
    if (f.on(w[6])) own = safe_normalize(own);
    if (length2(tangent) == 0) return f.set(w[0], shading);
    // from before displacement: less strength leads to the normal of now
    const float share = before ? 1 : strength;
    c = {c.x * share, c.y * share, mix(1, c.z, clamp_unit(share))};
    n = f.normal_from_object(
        safe_normalize(tangent * c.x + cross(own, tangent) * (sign * c.y) + own * c.z));
    if (!before) strength = 1;
  } else {
    if (space == MapSpace::BLENDER_OBJECT || space == MapSpace::BLENDER_WORLD)
      c = {c.x, -c.y, -c.z};
    n = space == MapSpace::OBJECT || space == MapSpace::BLENDER_OBJECT ? f.normal_from_object(c)
                                                                       : safe_normalize(c);
  }
  if (f.point.back) n = -n;
  if (strength != 1) n = safe_normalize(shading + (n - shading) * std::max(strength, 0.0f));
  f.set(w[0], length2(n) > 0 && is_finite(n) ? n : shading);
}

void offset(Frame& f, const uint32_t* w) {
  const OffsetAxis axis = f.mode<OffsetAxis>(w[0]);
  f.shift = {};
  f.knows_uv = f.before = false;
  if (axis == OffsetAxis::NONE || !f.is_on_surface()) return;
  if (axis >= OffsetAxis::BEFORE) {
    const MeshAttribute* places = f.mesh().attribute(kUndisplacedAttribute);
    f.before = places != nullptr;
    if (places) f.position_before = f.undisplaced(*places, {f.point.u, f.point.v});
  }
  if (axis == OffsetAxis::BEFORE) return;
  const OffsetAxes& axes = f.offset_axes();
  const bool along_x = axis == OffsetAxis::DX || axis == OffsetAxis::BEFORE_DX;
  f.shift = (along_x ? axes.x : axes.y) * f.number(w[1]);
  // Cycles shifts positions as far as on the surface as it is
  f.position_before += f.shift;
}

void vector_displacement(Frame& f, const uint32_t* w) {
  const MapSpace space = f.mode<MapSpace>(w[4]);
  const float midlevel = f.number(w[2]);
  Vec3 d = (f.vector(w[1]) - Vec3{midlevel, midlevel, midlevel}) * f.number(w[3]);
  if (f.is_on_mesh() && space == MapSpace::TANGENT) {
    float sign = 1;
    const Vec3 tangent = tangent_frame(f, w[5], w[6], sign), normal = f.object_normal();
    d = tangent * d.x + normal * d.y + safe_normalize(cross(normal, tangent)) * (sign * d.z);
  }
  f.set(w[0], f.is_on_mesh() && space != MapSpace::WORLD ? f.object_to_world().vector(d) : d);
}

namespace {

// The steps of offset_axes() as they were before displacement.
OffsetAxes axes_before(Frame& f, const MeshAttribute& places) {
  Frame there = f;
  const auto place = [&](const Vec3& shift) {
    there.shift = shift;
    there.knows_uv = false;
    return there.undisplaced(places, there.uv_there());
  };
  const OffsetAxes axes = f.offset_axes();
  const Vec3 p = place({});
  return {place(axes.x) - p, place(axes.y) - p};
}

}  // namespace

// Bump by the height of a displacement that has already moved the surface, as Cycles has it: along
// the undisplaced surface, in the object's coordinates.
void displacement_bump(Frame& f, const uint32_t* w) {
  const Vec3 n = f.vector(w[5]);
  if (!f.is_on_surface()) return f.set(w[0], n);
  const float h = f.number(w[2]), dx = f.number(w[3]) - h, dy = f.number(w[4]) - h;
  const MeshAttribute* places = f.mesh().attribute(kUndisplacedAttribute);
  const OffsetAxes axes = places ? axes_before(f, *places) : f.offset_axes();
  const Vec3 x = f.world_to_object().vector(axes.x), y = f.world_to_object().vector(axes.y);
  const Vec3 own = f.normal_to_object(n), rx = cross(y, own), ry = cross(own, x);
  const float determinant = dot(x, rx);
  const Vec3 gradient = (rx * dx + ry * dy) * (determinant < 0 ? -1.0f : 1.0f);
  const Vec3 result = f.normal_from_object(
      safe_normalize(own * (f.number(w[1]) * std::abs(determinant)) - gradient));
  f.set(w[0], length2(result) > 0 && is_finite(result) ? result : n);
}

void bump(Frame& f, const uint32_t* w) {
  const float strength = std::max(f.number(w[1]), 0.0f), width = f.number(w[3]);
  const float distance = f.on(w[8]) ? -f.number(w[2]) : f.number(w[2]);
  const float h = f.number(w[4]), dx = f.number(w[5]) - h, dy = f.number(w[6]) - h;
  const Vec3 n = f.vector(w[7]);
  if (!f.is_on_surface()) return f.set(w[0], n);
  // Surface gradient (Mikkelsen 2010, "Bump mapping unparametrized surfaces on the GPU").
  const OffsetAxes& axes = f.offset_axes();
  const Vec3 rx = cross(axes.y, n), ry = cross(n, axes.x);
  const float determinant = dot(axes.x, rx);
  const Vec3 gradient = (rx * dx + ry * dy) * (determinant < 0 ? -distance : distance);
  Vec3 result = safe_normalize(n * (width * std::abs(determinant)) - gradient);
  result = length2(result) > 0 && is_finite(result)
               ? safe_normalize(result * strength + n * (1 - strength))
               : n;
  f.set(w[0], is_finite(result) ? result : n);
}

}  // namespace photon_splat::nodes
