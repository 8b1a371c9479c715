// What a hit knows: positions, coordinates, attributes, the camera, the ray.
#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

Vec3 origin_of(const Scene& scene) {
  return {static_cast<float>(scene.origin[0]), static_cast<float>(scene.origin[1]),
          static_cast<float>(scene.origin[2])};
}

// The shading normal at the shifted point, on the side that is looked at.
Vec3 shifted_normal(Frame& f) {
  if (!f.is_on_surface() || !f.mesh().is_smooth()) return f.normal();
  const auto [u, v] = f.uv_there();
  if (u == f.point.u && v == f.point.v) return f.normal();
  Vec3 moved[3];
  const Vec3* n = f.mesh().normals(f.point.triangle, f.point.ray.time, moved);
  Vec3 world = n[0] * (1 - u - v) + n[1] * u + n[2] * v;
  const Instance& instance = f.scene.instances[f.point.instance];
  if (instance.shared)
    world = (f.pose ? f.pose->to_local : instance.to_local).transposed_vector(world);
  const float l = length(world);
  if (!(l > 0)) return f.normal();
  return world * ((f.point.back ? -1.0f : 1.0f) / l);
}

Vec3 camera_coordinates(const Frame& f) {
  const Affine& camera = f.scene.view.world_to_camera;
  if (f.is_background()) return camera.vector(f.point.position);
  return camera.point(f.before ? f.position_before : f.point.position + f.shift);
}

Vec3 window_coordinates(const Frame& f) {
  const ShadingView& view = f.scene.view;
  Vec3 p = camera_coordinates(f);
  if (view.panorama.kind != PanoramaKind::kNone) {  // without the lens' shift, as in Cycles
    const Vec2 place = panorama_place(view.panorama, safe_normalize({p.x, p.y, -p.z}));
    return {place.x, place.y, 0};
  }
  if (!view.orthographic) p = p.z != 0 ? p / p.z : Vec3{};
  return {(p.x - view.left) / (view.right - view.left),
          (p.y - view.bottom) / (view.top - view.bottom), 0};
}

Vec3 reflection(const Frame& f) {
  const Vec3 n = f.normal();
  return f.is_background() ? f.point.wo : n * (2 * dot(n, f.point.wo)) - f.point.wo;
}

// Around the Z axis of the generated coordinates.
Vec3 tangent_around_z(Frame& f) {
  const Vec3 g = f.generated(), n = f.normal();
  const Vec3 t = f.normal_from_object({-(g.y - 0.5f), g.x - 0.5f, 0});
  return cross(n, safe_normalize(cross(t, n)));
}

// Fresnel reflectance of unpolarised light; 1 in total reflection
float dielectric_fresnel(float cosine, float eta) {
  const float c = std::abs(cosine);
  float g = eta * eta - 1 + c * c;
  if (!(g > 0)) return 1;
  g = std::sqrt(g);
  const float a = (g - c) / (g + c), b = (c * (g + c) - 1) / (c * (g - c) + 1);
  return 0.5f * a * a * (1 + b * b);
}

Vec3 into_world(const Frame& f, const Vec3& v, TransformType type, TransformSpace from) {
  const Vec3 origin = origin_of(f.scene);
  if (from == TransformSpace::CAMERA) {
    const ShadingView& view = f.scene.view;
    if (type == TransformType::NORMAL)
      return safe_normalize(view.world_to_camera.transposed_vector(v));
    return type == TransformType::POINT ? view.camera_to_world.point(v) + origin
                                        : view.camera_to_world.vector(v);
  }
  if (from == TransformSpace::WORLD || f.is_background()) return v;
  if (type == TransformType::NORMAL) return f.normal_from_object(v);
  const Affine m = f.object_to_world();
  return type == TransformType::POINT ? m.point(v) + origin : m.vector(v);
}

Vec3 out_of_world(const Frame& f, const Vec3& v, TransformType type, TransformSpace to) {
  const Vec3 origin = origin_of(f.scene);
  if (to == TransformSpace::CAMERA) {
    const ShadingView& view = f.scene.view;
    if (type == TransformType::NORMAL)
      return safe_normalize(view.camera_to_world.transposed_vector(v));
    return type == TransformType::POINT ? view.world_to_camera.point(v - origin)
                                        : view.world_to_camera.vector(v);
  }
  if (to == TransformSpace::WORLD || f.is_background()) return v;
  if (type == TransformType::NORMAL) return f.normal_to_object(v);
  const Affine& m = f.world_to_object();
  return type == TransformType::POINT ? m.point(v - origin) : m.vector(v);
}

void set_attribute(Frame& f, const uint32_t* w, const std::array<float, 4>& a,
                   uint32_t components) {
  // As in Cycles: a number is grey, two components are u and v, the number of a colour is the mean
  // of RGB.
  const Vec3 v = components == 1 ? Vec3{a[0], a[0], a[0]} : Vec3{a[0], a[1], a[2]};
  f.set(w[0], v);
  f.set(w[1], components <= 2 ? a[0] : average(v));
  f.set(w[2], components == 4 ? a[3] : 1.0f);
}

}  // namespace

std::optional<Pose> Frame::pose_now() const {
  if (!is_on_mesh() || !scene.moves(point.instance) || scene.instances[point.instance].motion < 0)
    return std::nullopt;
  return scene.pose_at(point.instance, point.ray.time);
}

const Affine& Frame::world_to_object() const {
  static const Affine identity;
  if (point.lamp) return point.lamp->to_local;
  if (pose) return pose->to_local;
  return point.instance < scene.world_to_object.size() ? scene.world_to_object[point.instance]
                                                       : identity;
}

Affine Frame::object_to_world() const {
  if (point.lamp) return point.lamp->to_world;
  if (pose) return pose->to_world;
  Affine m;
  if (!is_on_mesh()) return m;  // the world's medium
  const auto& exact = scene.instances[point.instance].exact;
  for (size_t i = 0; i < 12; ++i) m.m[i] = static_cast<float>(exact[i]);
  return m;
}

Vec3 Frame::place() const {
  if (!is_on_surface() || strands()) return point.position + shift;
  Vec3 corner[3];
  corners(corner);
  return corner[0] + (corner[1] - corner[0]) * point.u + (corner[2] - corner[0]) * point.v + shift;
}

Vec3 Frame::position() const {
  if (before) return position_before + origin_of(scene);
  return is_background() ? point.position : place() + origin_of(scene);
}

Vec3 Frame::object_position() const {
  if (before) return world_to_object().point(position_before);
  return is_background() ? point.position : world_to_object().point(place());
}

Vec3 Frame::undisplaced(const MeshAttribute& positions, const Vec2& at) const {
  const auto p = positions.at(mesh().triangles[point.triangle], point.triangle, at.x, at.y);
  return object_to_world().point({p[0], p[1], p[2]});
}

Vec3 Frame::normal_to_object(const Vec3& n) const {
  return is_background() ? n : safe_normalize(object_to_world().transposed_vector(n));
}

const Vec3& Frame::object_normal() {
  if (!knows_object_normal) normal_in_object = normal_to_object(normal());
  knows_object_normal = true;
  return normal_in_object;
}

Vec3 Frame::normal_from_object(const Vec3& n) const {
  return is_background() ? n : safe_normalize(world_to_object().transposed_vector(n));
}

bool Frame::attribute(uint32_t id, std::array<float, 4>& value, uint32_t& components) {
  const MeshAttribute* found = id == kNone || !is_on_surface() ? nullptr : mesh().attribute(id);
  if (!found) return false;
  components = found->components;
  if (const Strands* own = strands()) {
    const uint32_t key = own->first_key(point.triangle);
    const bool curves = own->are_curves();
    value = found->at({key, curves ? key + 1 : key, key}, own->strand(point.triangle),
                      curves ? point.u : 0, 0);
    return true;
  }
  const Vec2 at = uv_there();
  value = found->at(mesh().triangles[point.triangle], point.triangle, at.x, at.y);
  return true;
}

Vec3 Frame::generated() {
  if (!is_on_mesh()) return object_position();
  std::array<float, 4> own;
  uint32_t components;
  if (attribute(kGeneratedAttribute, own, components)) return {own[0], own[1], own[2]};
  const GeneratedSpace& space = mesh().generated;
  if (is_on_surface() && mesh().motion.steps()) {  // they do not change with the shape
    Vec3 c[3];
    const Vec2 at = uv_there();
    scene.corners(point.instance, point.triangle, kShutterCentre, c);
    const Vec3 x = c[0] * (1 - at.x - at.y) + c[1] * at.x + c[2] * at.y;
    return scene.world_to_object[point.instance].point(x) * space.scale + space.offset;
  }
  Vec3 at = object_position();
  if (is_on_surface() && point.back && !before)
    at = at - world_to_object().vector(shift) * 2.0f;  // see uv_there()
  return at * space.scale + space.offset;
}

Vec3 Frame::uv(uint32_t id) {
  if (point.lamp && id == kNone) return {1 - point.u - point.v, point.u, 0};
  if (!is_on_surface()) return {};
  std::array<float, 4> value{};
  uint32_t components;
  if (id == kNone) {
    const Vec2 at = uv_there(), active = scene.uv_at(point.instance, point.triangle, at.x, at.y);
    return {active.x, active.y, 0};
  }
  attribute(id, value, components);
  return {value[0], value[1], value[2]};
}

void geometry(Frame& f, const uint32_t* w) {
  Vec3 v;
  switch (f.mode<GeometryVector>(w[1])) {
    case GeometryVector::POSITION: v = f.position(); break;
    case GeometryVector::NORMAL: v = f.normal(); break;
    case GeometryVector::TANGENT:
      v = f.strands()    ? safe_normalize(strand_tangent(f))
          : f.point.lamp ? Vec3{}
                         : tangent_around_z(f);
      break;
    case GeometryVector::TRUE_NORMAL: {
      const bool facing = f.strands() && f.strands()->shape() == StrandShape::kRibbon;
      v = f.is_background() || facing ? f.point.wo : f.point.ng;
      break;
    }
    case GeometryVector::INCOMING: v = f.point.wo; break;
    case GeometryVector::PARAMETRIC: {
      const Vec2 at = f.uv_there();
      v = {1 - at.x - at.y, at.x, 0};
      break;
    }
  }
  f.set(w[0], v);
}

void texture_coordinate(Frame& f, const uint32_t* w) {
  Vec3 v;
  switch (f.mode<Coordinates>(w[1])) {
    case Coordinates::GENERATED: v = f.generated(); break;
    case Coordinates::NORMAL: v = f.normal_to_object(shifted_normal(f)); break;
    case Coordinates::OBJECT: v = f.object_position(); break;
    case Coordinates::CAMERA: v = camera_coordinates(f); break;
    case Coordinates::WINDOW: v = window_coordinates(f); break;
    case Coordinates::REFLECTION: v = reflection(f); break;
  }
  f.set(w[0], v);
}

void uv_map(Frame& f, const uint32_t* w) { f.set(w[0], f.uv(w[1])); }

void mesh_attribute(Frame& f, const uint32_t* w) {
  std::array<float, 4> value{};
  uint32_t components = 0;
  f.attribute(w[3], value, components);
  set_attribute(f, w, value, components);
}

void instance_attribute(Frame& f, const uint32_t* w) {
  std::array<float, 4> value{};
  uint32_t components = 0;
  for (const InstanceAttribute& a : f.scene.instance_attributes) {
    if (a.id != w[3] || !f.is_on_mesh() ||
        (f.point.instance + 1ull) * a.components > a.values.size())
      continue;
    components = a.components;
    std::copy_n(&a.values[static_cast<size_t>(f.point.instance) * components], components,
                value.begin());
    break;
  }
  set_attribute(f, w, value, components);
}

// To the last bit, which White Noise tells: in doubles, as the origin has been taken off in them.
void object_location(Frame& f, const uint32_t* w) {
  if (f.is_background()) return f.set(w[0], Vec3{});
  if (f.point.lamp || f.pose || !f.is_on_mesh())
    return f.set(w[0], f.object_to_world().point({}) + origin_of(f.scene));
  const auto& to_world = f.scene.instances[f.point.instance].exact;
  const auto along = [&](int i) {
    return static_cast<float>(to_world[4 * i + 3] + f.scene.origin[i]);
  };
  f.set(w[0], Vec3{along(0), along(1), along(2)});
}

void camera_data(Frame& f, const uint32_t* w) {
  const Vec3 v = camera_coordinates(f);
  f.set(w[0], safe_normalize(v));
  f.set(w[1], v.z);
  f.set(w[2], length(v));
}

void light_path(Frame& f, const uint32_t* w) {
  using enum PathValue;
  const RayInfo& ray = f.point.ray;
  const auto is = [&](auto... kinds) { return ((ray.kind == kinds) || ...) ? 1.0f : 0.0f; };
  float value = 0;
  switch (f.mode<PathValue>(w[1])) {
    case IS_CAMERA_RAY: value = is(RayInfo::kCamera); break;
    case IS_SHADOW_RAY: value = is(RayInfo::kShadow); break;
    case IS_DIFFUSE_RAY: value = is(RayInfo::kDiffuse); break;
    case IS_GLOSSY_RAY: value = is(RayInfo::kGlossy, RayInfo::kTransmission); break;
    case IS_SINGULAR_RAY: value = ray.singular ? 1.0f : 0.0f; break;
    case IS_REFLECTION_RAY:
      value = ray.through ? 0.0f : is(RayInfo::kDiffuse, RayInfo::kGlossy);
      break;
    case IS_TRANSMISSION_RAY: value = ray.through ? 1.0f : is(RayInfo::kTransmission); break;
    case IS_VOLUME_SCATTER_RAY: value = is(RayInfo::kVolume); break;
    case RAY_LENGTH: value = ray.length; break;
    case RAY_DEPTH: value = ray.depth; break;
    case DIFFUSE_DEPTH: value = ray.diffuse_depth; break;
    case GLOSSY_DEPTH: value = ray.glossy_depth; break;
    case TRANSPARENT_DEPTH: value = ray.transparent_depth; break;
    case TRANSMISSION_DEPTH: value = ray.transmission_depth; break;
  }
  f.set(w[0], value);
}

void light_falloff(Frame& f, const uint32_t* w) {
  float strength = f.number(w[1]);
  const float smooth = f.number(w[2]), l = f.point.ray.length, l2 = l * l;
  if (std::isfinite(l2)) {  // from far away there is no falloff
    if (f.mode<FalloffType>(w[3]) == FalloffType::LINEAR) strength *= l;
    if (f.mode<FalloffType>(w[3]) == FalloffType::CONSTANT) strength *= l2;
    if (smooth > 0) strength *= l2 / (smooth + l2);
  }
  f.set(w[0], strength);
}

void wireframe(Frame& f, const uint32_t* w) {
  if (!f.is_on_surface() || f.strands()) return f.set(w[0], 0.0f);
  Vec3 corner[3];
  f.corners(corner);
  float width = 0.5f * f.number(w[1]);
  if (f.on(w[2])) {
    // A pixel's width as it is seen: of two directions across the surface, one is foreshortened.
    const OffsetAxes& axes = f.offset_axes();
    const auto seen = [&](const Vec3& d) { return length(d - f.point.wo * dot(d, f.point.wo)); };
    width *= 0.5f * (seen(axes.x) + seen(axes.y));
  }
  const Vec3 p = f.point.position + f.shift;
  bool near = false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = corner[(i + 1) % 3] - corner[i];
    near |= length2(cross(edge, p - corner[i])) < length2(edge) * width * width;
  }
  f.set(w[0], near ? 1.0f : 0.0f);
}

void fresnel(Frame& f, const uint32_t* w) {
  const float ior = std::max(f.number(w[1]), 1e-5f);
  f.set(w[0], dielectric_fresnel(dot(f.point.wo, f.vector(w[2])), f.point.back ? 1 / ior : ior));
}

void layer_weight(Frame& f, const uint32_t* w) {
  const float blend = f.number(w[2]), cosine = dot(f.point.wo, f.vector(w[3]));
  if (w[0] != kUnused) {
    const float inverse = std::max(1 - blend, 1e-5f);
    f.set(w[0], dielectric_fresnel(cosine, f.point.back ? inverse : 1 / inverse));
  }
  if (w[1] == kUnused) return;
  float facing = std::abs(cosine);
  if (blend != 0.5f) {
    const float b = std::clamp(blend, 0.0f, 1 - 1e-5f);
    facing = std::pow(facing, b < 0.5f ? 2 * b : 0.5f / (1 - b));
  }
  f.set(w[1], 1 - facing);
}

void vector_transform(Frame& f, const uint32_t* w) {
  const TransformType type = f.mode<TransformType>(w[2]);
  const TransformSpace from = f.mode<TransformSpace>(w[3]), to = f.mode<TransformSpace>(w[4]);
  const Vec3 v = f.vector(w[1]);
  f.set(w[0], from == to ? v : out_of_world(f, into_world(f, v, type, from), type, to));
}

}  // namespace photon_splat::nodes
