#include "scene.h"

#include <atomic>
#include <new>
#include <set>

#include "sampling.h"

namespace photon_splat {
namespace {

bool report_progress(void* cancel, double) { return !static_cast<const CancelFlag*>(cancel)->is_set(); }

RTCGeometry make_geometry(RTCDevice device, const Mesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // positions has one element more than the mesh: Embree may read 16 bytes at the last vertex.
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.positions.data(), 0,
                             sizeof(Vec3), mesh.positions.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(Triangle), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  return geometry;
}

// Has the memory of what fill_surface() reads of a triangle come while others are worked on.
void fetch_ahead(const Mesh& mesh, uint32_t triangle) {
  if (!mesh.corner_normals.empty()) prefetch(&mesh.corner_normals[3 * static_cast<size_t>(triangle)]);
  if (mesh.topology.planar.size() != 1) prefetch(&mesh.topology.patch[triangle]);
  if (!mesh.slots.empty()) prefetch(&mesh.slots[triangle]);
}

float largest_stretch(const Affine& a) {
  // The Frobenius norm over sqrt(3) is exact for similarities; the longest column covers the rest well enough.
  return std::max({length(a.column(0)), length(a.column(1)), length(a.column(2))});
}

Vec3 transform_exactly(const std::array<double, 12>& m, const Vec3& p) {
  const auto row = [&](int r) {
    return static_cast<float>(m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z + m[4 * r + 3]);
  };
  return {row(0), row(1), row(2)};
}

template <class Change>
void change_all(LargeArray<Vec3>& values, ThreadPool& pool, const CancelFlag& cancel, Change&& change) {
  pool.for_parts(values.size(), 1 << 14, cancel, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) change(values[i]);
  });
}

}  // namespace

Scene::Scene(int threads) : pool_(threads) {
  // A thread count given to Embree limits TBB, and so Blender, while the device lives: given only when asked for.
  const bool restricted = threads > 0 && static_cast<unsigned>(threads) < std::thread::hardware_concurrency();
  const std::string n = std::to_string(pool_.size());
  device_ = rtcNewDevice(restricted ? ("threads=" + n + ",user_threads=" + n).c_str() : nullptr);
  if (!device_) throw std::runtime_error("Embree could not be started");
  packets_ = rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
}

Scene::~Scene() {
  if (top_) rtcReleaseScene(top_);
  for (RTCScene scene : mesh_scenes_)
    if (scene) rtcReleaseScene(scene);
  rtcReleaseDevice(device_);
}

void Scene::add_instance(uint32_t mesh, const std::array<double, 12>& exact, const std::vector<int32_t>& slots) {
  if (mesh >= meshes.size()) throw std::invalid_argument("an instance names a mesh that does not exist");
  Affine to_world;
  for (int i = 0; i < 12; ++i) to_world.m[i] = static_cast<float>(exact[i]);
  Instance instance;
  instance.exact = exact;
  instance.mesh = mesh;
  instance.to_world = to_world;
  instance.to_local = inverse(to_world);
  instance.mirrored = determinant(to_world) < 0;
  instance.scale = largest_stretch(to_world);
  instance.first_material = static_cast<uint32_t>(slot_materials.size());
  instance.slot_count = static_cast<uint32_t>(slots.size());
  instance.seed = hash32(static_cast<uint32_t>(instances.size()) * 2 + 1);
  for (int32_t material : slots) {
    if (material < 0 || static_cast<size_t>(material) >= materials.size())
      throw std::invalid_argument("an instance names a material that does not exist");
    slot_materials.push_back(material);
  }
  if (slots.empty()) throw std::invalid_argument("an instance has no material");
  instances.push_back(instance);
}

void Scene::throw_on_error(const CancelFlag& cancel) const {
  const RTCError error = rtcGetDeviceError(device_);
  cancel.check();
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error(std::string("Embree failed: ") + rtcGetErrorString(error));
}

void Mesh::describe_surface(const CancelFlag& cancel) {
  topology = build_topology(positions, triangles, cancel);
  edge_tree = std::make_unique<EdgeTree>(topology.edges);
  surface_tree = std::make_unique<SurfaceTree>(positions, triangles, topology, cancel);
}

void Scene::commit(RTCScene scene, const CancelFlag& cancel, const std::function<void()>& meanwhile) {
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneProgressMonitorFunction(scene, report_progress, const_cast<CancelFlag*>(&cancel));
  pool_.run_on_all([&](int worker) {
    const bool begins = worker == pool_.size() - 1;  // one with Embree, the others with what can be done meanwhile
    if (!begins && meanwhile) meanwhile();
    rtcJoinCommitScene(scene);
    if (begins && meanwhile) meanwhile();
  });
  rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
  throw_on_error(cancel);
}

void Scene::build(const CancelFlag& cancel) {
  std::vector<uint32_t> uses(meshes.size());
  for (const Instance& instance : instances) ++uses[instance.mesh];
  world_to_object.clear();
  for (const Instance& instance : instances) world_to_object.push_back(instance.to_local);
  for (Instance& instance : instances) {
    instance.shared = uses[instance.mesh] > 1;
    if (instance.shared) continue;
    Mesh& mesh = meshes[instance.mesh];
    cancel.check();
    change_all(mesh.positions, pool_, cancel, [&](Vec3& p) { p = transform_exactly(instance.exact, p); });
    change_all(mesh.corner_normals, pool_, cancel, [&](Vec3& n) {
      const Vec3 world = instance.to_local.transposed_vector(n);
      const float len = length(world);
      n = len > 0 ? world / len : n;
    });
    if (instance.mirrored) {  // restore the winding, so that the front stays the front
      for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        if (!mesh.corner_normals.empty()) std::swap(mesh.corner_normals[3 * t + 1], mesh.corner_normals[3 * t + 2]);
        if (!mesh.uv.empty()) std::swap(mesh.uv[3 * t + 1], mesh.uv[3 * t + 2]);
        for (MeshAttribute& attribute : mesh.attributes) attribute.swap_corners(3 * t + 1, 3 * t + 2);
      }
    }
    instance.to_world = instance.to_local = Affine{};
    instance.mirrored = false;
    instance.scale = 1;
  }

  top_ = rtcNewScene(device_);
  mesh_scenes_.assign(meshes.size(), nullptr);
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const Instance& instance = instances[i];
    const Mesh& mesh = meshes[instance.mesh];
    RTCGeometry geometry;
    if (instance.shared) {
      RTCScene& inner = mesh_scenes_[instance.mesh];
      if (!inner) {
        inner = rtcNewScene(device_);
        RTCGeometry triangles = make_geometry(device_, mesh);
        rtcAttachGeometryByID(inner, triangles, 0);
        rtcReleaseGeometry(triangles);
        commit(inner, cancel);
      }
      geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(geometry, inner);
      rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, instance.to_world.m.data());
      rtcCommitGeometry(geometry);
    } else {
      geometry = make_geometry(device_, mesh);
    }
    rtcAttachGeometryByID(top_, geometry, i);
    rtcReleaseGeometry(geometry);
  }
  std::atomic<size_t> next{0};
  const auto describe_surfaces = [&] {
    for (size_t m; (m = next++) < meshes.size();) {
      cancel.check();
      if (uses[m]) meshes[m].describe_surface(cancel);
    }
  };
  commit(top_, cancel, describe_surfaces);
  update_features();
  if (!instances.empty()) {
    RTCBounds b;
    rtcGetSceneBounds(top_, &b);
    if (b.lower_x <= b.upper_x) {
      bounds_.add(Vec3{b.lower_x, b.lower_y, b.lower_z});
      bounds_.add(Vec3{b.upper_x, b.upper_y, b.upper_z});
    }
  }
  throw_on_error(cancel);
}

void Scene::update_features() {
  features_ = 0;
  for (int32_t material : slot_materials) {
    const int program = materials[material].program;
    features_ |= program < 0 ? kProgramGathers | kProgramEmits : programs[program].features;
  }
}

bool Scene::intersect(const Vec3& origin, const Vec3& direction, float near, float far, bool coherent,
                      Surface& surface) const {
  RTCRayHit hit;
  hit.ray = {origin.x, origin.y, origin.z, near, direction.x, direction.y, direction.z, 0, far, ~0u, 0, 0};
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcIntersect1(top_, &hit, &arguments);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  const bool instanced = hit.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
  const uint32_t instance = instanced ? hit.hit.instID[0] : hit.hit.geomID;
  Vec3 normal{hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z};
  if (instanced) normal = instances[instance].to_local.transposed_vector(normal);
  fill_surface({instance, hit.hit.primID, hit.hit.u, hit.hit.v, hit.ray.tfar, origin + direction * hit.ray.tfar, normalize(normal)},
               direction, surface);
  return true;
}

unsigned Scene::intersect_packet(const Vec3* origins, const Vec3* directions, uint32_t count, Surface* surfaces) const {
  unsigned found = 0;
  if (!packets_) {
    for (uint32_t k = 0; k < count; ++k)
      found |= unsigned(intersect(origins[k], directions[k], 0, INFINITY, false, surfaces[k])) << k;
    return found;
  }
  alignas(64) RTCRayHit8 hit;
  alignas(64) int valid[kPacket];
  for (uint32_t k = 0; k < kPacket; ++k) {
    const uint32_t from = std::min(k, count - 1);
    valid[k] = k < count ? -1 : 0;
    hit.ray.org_x[k] = origins[from].x; hit.ray.org_y[k] = origins[from].y; hit.ray.org_z[k] = origins[from].z;
    hit.ray.dir_x[k] = directions[from].x; hit.ray.dir_y[k] = directions[from].y; hit.ray.dir_z[k] = directions[from].z;
    hit.ray.tnear[k] = 0;
    hit.ray.tfar[k] = INFINITY;
    hit.ray.time[k] = 0;
    hit.ray.mask[k] = ~0u;
    hit.ray.id[k] = hit.ray.flags[k] = 0;
    hit.hit.geomID[k] = hit.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    hit.hit.Ng_x[k] = hit.hit.Ng_y[k] = hit.hit.Ng_z[k] = 1;
  }
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcIntersect8(valid, top_, &hit, &arguments);
  alignas(64) uint32_t instance[kPacket];
  for (uint32_t k = 0; k < count; ++k) {
    if (hit.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
    found |= 1u << k;
    const bool instanced = hit.hit.instID[0][k] != RTC_INVALID_GEOMETRY_ID;
    instance[k] = instanced ? hit.hit.instID[0][k] : hit.hit.geomID[k];
    fetch_ahead(meshes[instances[instance[k]].mesh], hit.hit.primID[k]);
    if (!instanced) continue;
    const Vec3 n = instances[instance[k]].to_local.transposed_vector({hit.hit.Ng_x[k], hit.hit.Ng_y[k], hit.hit.Ng_z[k]});
    hit.hit.Ng_x[k] = n.x, hit.hit.Ng_y[k] = n.y, hit.hit.Ng_z[k] = n.z;
  }
  // All lanes side by side, those that missed as well.
  alignas(64) float x[kPacket], y[kPacket], z[kPacket];
  for (uint32_t k = 0; k < kPacket; ++k) {
    const Vec3 n = normalize({hit.hit.Ng_x[k], hit.hit.Ng_y[k], hit.hit.Ng_z[k]});
    hit.hit.Ng_x[k] = n.x, hit.hit.Ng_y[k] = n.y, hit.hit.Ng_z[k] = n.z;
    x[k] = hit.ray.org_x[k] + hit.ray.dir_x[k] * hit.ray.tfar[k];
    y[k] = hit.ray.org_y[k] + hit.ray.dir_y[k] * hit.ray.tfar[k];
    z[k] = hit.ray.org_z[k] + hit.ray.dir_z[k] * hit.ray.tfar[k];
  }
  for (uint32_t k = 0; k < count; ++k)
    if (found >> k & 1)
      fill_surface({instance[k], hit.hit.primID[k], hit.hit.u[k], hit.hit.v[k], hit.ray.tfar[k], {x[k], y[k], z[k]},
                    {hit.hit.Ng_x[k], hit.hit.Ng_y[k], hit.hit.Ng_z[k]}},
                   directions[k], surfaces[k]);
  return found;
}

bool Scene::occluded(const Vec3& origin, const Vec3& direction, float near, float far) const {
  RTCRay ray{origin.x, origin.y, origin.z, near, direction.x, direction.y, direction.z, 0, far, ~0u, 0, 0};
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcOccluded1(top_, &ray, &arguments);
  return ray.tfar < 0;
}

unsigned Scene::occluded_packet(const Vec3* origins, uint32_t count, const Vec3& direction, float far) const {
  unsigned found = 0;
  if (!packets_) {
    for (uint32_t k = 0; k < count; ++k) found |= unsigned(occluded(origins[k], direction, 0, far)) << k;
    return found;
  }
  alignas(64) RTCRay8 ray;
  alignas(64) int valid[kPacket];
  for (uint32_t k = 0; k < kPacket; ++k) {
    const Vec3& origin = origins[std::min(k, count - 1)];
    valid[k] = k < count ? -1 : 0;
    ray.org_x[k] = origin.x; ray.org_y[k] = origin.y; ray.org_z[k] = origin.z;
    ray.dir_x[k] = direction.x; ray.dir_y[k] = direction.y; ray.dir_z[k] = direction.z;
    ray.tnear[k] = ray.time[k] = 0;
    ray.tfar[k] = far;
    ray.mask[k] = ~0u;
    ray.id[k] = ray.flags[k] = 0;
  }
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded8(valid, top_, &ray, &arguments);
  for (uint32_t k = 0; k < count; ++k) found |= unsigned(ray.tfar[k] < 0) << k;
  return found;
}

bool Scene::anything_within(const Vec3& x, float radius) const {
  bool found = false;
  RTCPointQuery query{x.x, x.y, x.z, 0, radius};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto stop_at_first = [](RTCPointQueryFunctionArguments* arguments) {
    *static_cast<bool*>(arguments->userPtr) = true;
    arguments->query->radius = 0;
    return true;
  };
  rtcPointQuery(top_, &query, &context, stop_at_first, &found);
  return found;
}

void Scene::fill_surface(const RawHit& hit, const Vec3& direction, Surface& s) const {
  s.instance = hit.instance;
  s.triangle = hit.triangle;
  s.u = hit.u;
  s.v = hit.v;
  s.distance = hit.distance;
  s.position = hit.position;
  const Instance& instance = instances[s.instance];
  const Mesh& mesh = meshes[instance.mesh];
  Vec3 ng = hit.normal;
  // Blender keeps a mirrored object's front where the mesh's normals, mirrored with it, point.
  s.back = dot(ng, direction) > 0;
  s.ns = ng;
  if (!mesh.corner_normals.empty()) {
    const Vec3* n = &mesh.corner_normals[3 * static_cast<size_t>(s.triangle)];
    Vec3 ns = n[0] * (1 - s.u - s.v) + n[1] * s.u + n[2] * s.v;
    if (instance.shared) ns = instance.to_local.transposed_vector(ns);
    const float len = length(ns);
    if (len > 0) s.ns = ns / len;
  }
  if (s.back) {
    ng = -ng;
    s.ns = -s.ns;
  }
  s.ng = ng;
  // The look-up is a cache miss in large meshes; a mesh of one patch needs none.
  const uint32_t patch = mesh.topology.planar.size() == 1 ? 0 : mesh.topology.patch[s.triangle];
  // An odd multiplier keeps patches of one instance apart; the seed is random, so that those of others rarely meet.
  s.key = ((instance.seed ^ patch * 0x9e3779b1u) << 1) | (s.back ? 1u : 0u);
  const Material& material = material_of(s.instance, s.triangle);
  s.side = s.back ? &material.back : &material.front;
  s.program = material.program < 0 ? nullptr : &programs[material.program];
}

Surface Scene::surface_at(uint32_t index, uint32_t triangle, float u, float v, bool back) const {
  const Instance& instance = instances[index];
  const Mesh& mesh = meshes[instance.mesh];
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 a = mesh.positions[t[0]], ab = mesh.positions[t[1]] - a, ac = mesh.positions[t[2]] - a;
  const Vec3 normal = cross(ab, ac);
  const Vec3 front = instance.shared ? instance.to_local.transposed_vector(normal) : normal;
  Surface s;
  fill_surface({index, triangle, u, v, 0, instance.to_world.point(a + ab * u + ac * v), normalize(front)},
               normalize(back ? front : -front), s);
  return s;
}

namespace {

ShadingPoint shading_point(const Surface& s, const Vec3& wo, const RayInfo& ray) {
  ShadingPoint p;
  p.position = s.position;
  p.ng = s.ng;
  p.ns = s.ns;
  p.wo = wo;
  p.back = s.back;
  p.instance = s.instance;
  p.triangle = s.triangle;
  p.u = s.u;
  p.v = s.v;
  p.ray = ray;
  p.ray.length = s.distance;
  return p;
}

}  // namespace

void Scene::shade(const Surface& s, const Vec3& wo, const RayInfo& ray, Bsdf& bsdf) const {
  if (s.program) {
    run_program(*this, *s.program, shading_point(s, wo, ray), bsdf);
  } else {
    const Vec3 front_normal = s.back ? -s.ns : s.ns;
    bsdf.add_diffuse(albedo(s), front_normal, 0);
    bsdf.add_emission(textured(s.side->emission, s.side->emission_texture, s));
  }
  bsdf.finish();
}

Rgb Scene::emission_at(const Material& material, uint32_t instance, uint32_t triangle, float u, float v, bool back,
                       const Vec3& wo) const {
  const MaterialSide& side = back ? material.back : material.front;
  if (material.program < 0 && side.emission_texture < 0) return side.emission;
  return emission(surface_at(instance, triangle, u, v, back), wo, {RayInfo::kEmission});
}

Rgb Scene::emission(const Surface& s, const Vec3& wo, const RayInfo& ray) const {
  if (!s.program) return textured(s.side->emission, s.side->emission_texture, s);
  if (!(s.program->features & kProgramEmits)) return {};
  Bsdf bsdf(Transport::kRadiance, wo, s.ng, s.ns, s.back);
  run_program(*this, *s.program, shading_point(s, wo, ray), bsdf);
  return bsdf.emission();
}

Rgb Scene::transmittance(const Vec3& origin, const Vec3& direction, float far, const RayInfo& ray, uint64_t blockers) const {
  if (!occluded(origin, direction, 0, far)) return {1, 1, 1};
  if (!~blockers && !(features_ & kProgramTransparent)) return {};
  Rgb through{1, 1, 1};
  RayInfo info = ray;
  info.kind = RayInfo::kShadow;
  Surface s;
  for (float near = 0; intersect(origin, direction, near, far, false, s); near = past(s)) {
    if (!(blockers & instances[s.instance].group)) continue;
    if (!may_be_transparent(s)) return {};
    Bsdf bsdf(Transport::kRadiance, -direction, s.ng, s.ns, s.back);
    run_program(*this, *s.program, shading_point(s, -direction, info), bsdf);
    through *= bsdf.transparency();
    if (max_component(through) < 1e-6f) return {};
    ++info.transparent_depth;
  }
  return through;
}

const Material& Scene::material_of(uint32_t instance_index, uint32_t triangle) const {
  const Instance& instance = instances[instance_index];
  const Mesh& mesh = meshes[instance.mesh];
  uint32_t slot = mesh.slots.empty() ? 0 : mesh.slots[triangle];
  slot = std::min(slot, instance.slot_count - 1);
  return materials[slot_materials[instance.first_material + slot]];
}

Vec2 Scene::uv_at(uint32_t instance, uint32_t triangle, float u, float v) const {
  const Mesh& mesh = meshes[instances[instance].mesh];
  if (mesh.uv.empty()) return {0, 0};
  const Vec2* uv = &mesh.uv[3 * static_cast<size_t>(triangle)];
  const float w = 1 - u - v;
  return {uv[0].x * w + uv[1].x * u + uv[2].x * v, uv[0].y * w + uv[1].y * u + uv[2].y * v};
}

Rgb Scene::textured(const Rgb& factor, int texture, const Surface& s) const {
  if (texture < 0) return factor;
  return factor * textures[texture].lookup(uv_at(s.instance, s.triangle, s.u, s.v));
}

}  // namespace photon_splat
