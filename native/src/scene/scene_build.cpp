// Makes a scene ready for rays: geometry for Embree, where it stands, what it asks for.
#include "scene/scene.h"

#include <atomic>
#include <new>

#include "math/sampling.h"
#include "media/media.h"

namespace photon_splat {
namespace {

constexpr float kBentShare = 0.25f;  // of a slot's area: more is coarse

bool report_progress(void* cancel, double) {
  return !static_cast<const CancelFlag*>(cancel)->is_set();
}

RTCGeometry triangles_of(RTCDevice device, const Mesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const MeshMotion& motion = mesh.motion;
  const size_t steps = std::max<size_t>(motion.steps(), 1);
  if (steps > 1) rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps));
  for (size_t i = 0; i < steps; ++i) {
    const auto& positions = i == motion.middle() ? mesh.positions : motion.positions[i];
    // These have one element more than the mesh: Embree may read 16 bytes at the last vertex.
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(i),
                               RTC_FORMAT_FLOAT3, positions.data(), 0, sizeof(Vec3),
                               mesh.positions.size() - 1);
  }
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             mesh.triangles.data(), 0, sizeof(Triangle), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  return geometry;
}

void set_transforms(RTCGeometry geometry, const TransformMotion& motion) {
  rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(motion.steps().size()));
  for (unsigned i = 0; i < motion.steps().size(); ++i) {
    const Decomposed& d = motion.steps()[i];
    RTCQuaternionDecomposition q;
    rtcInitQuaternionDecomposition(&q);
    rtcQuaternionDecompositionSetTranslation(&q, d.translation.x, d.translation.y, d.translation.z);
    rtcQuaternionDecompositionSetQuaternion(&q, d.rotation.w, d.rotation.x, d.rotation.y,
                                            d.rotation.z);
    rtcQuaternionDecompositionSetScale(&q, d.xx, d.yy, d.zz);
    rtcQuaternionDecompositionSetSkew(&q, d.xy, d.xz, d.yz);
    rtcSetGeometryTransformQuaternion(geometry, i, &q);
  }
}

float largest_stretch(const Affine& a) {
  // The Frobenius norm over sqrt(3) is exact for similarities; the longest column covers the rest
  // well enough.
  return std::max({length(a.column(0)), length(a.column(1)), length(a.column(2))});
}

Vec3 transform_exactly(const std::array<double, 12>& m, const Vec3& p) {
  const auto row = [&](int r) {
    return static_cast<float>(m[4 * r] * p.x + m[4 * r + 1] * p.y + m[4 * r + 2] * p.z +
                              m[4 * r + 3]);
  };
  return {row(0), row(1), row(2)};
}

// Strands hold no more than one radius: only then can they stand in the world themselves.
bool scales_evenly(const Affine& a) {
  const float x = length2(a.column(0)), y = length2(a.column(1)), z = length2(a.column(2));
  const float most = 1e-5f * std::max({x, y, z});
  const auto square = [&](int i, int k) { return std::abs(dot(a.column(i), a.column(k))) <= most; };
  return std::abs(x - y) <= most && std::abs(x - z) <= most && square(0, 1) && square(0, 2) &&
         square(1, 2);
}

// Its mesh is in the world's coordinates.
void stand_still(Instance& instance) {
  instance.to_world = instance.to_local = Affine{};
  instance.mirrored = false;
  instance.scale = 1;
}

template <class Change>
void change_all(LargeArray<Vec3>& values, ThreadPool& pool, const CancelFlag& cancel,
                Change&& change) {
  pool.for_parts(values.size(), 1 << 14, cancel, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) change(values[i]);
  });
}

// Puts a mesh that stands once in the scene into world coordinates.
void move_to_world(Mesh& mesh, const Instance& instance, ThreadPool& pool,
                   const CancelFlag& cancel) {
  const auto move = [&](Vec3& p) { p = transform_exactly(instance.exact, p); };
  const auto turn = [&](Vec3& n) {
    const Vec3 world = instance.to_local.transposed_vector(n);
    const float len = length(world);
    n = len > 0 ? world / len : n;
  };
  change_all(mesh.positions, pool, cancel, move);
  change_all(mesh.corner_normals.own(), pool, cancel, turn);
  change_all(mesh.vertex_normals.own(), pool, cancel, turn);
  for (LargeArray<Vec3>& positions : mesh.motion.positions)
    change_all(positions, pool, cancel, move);
  for (LargeArray<Vec3>& normals : mesh.motion.corner_normals)
    change_all(normals, pool, cancel, turn);
  if (instance.mirrored) {  // restore the winding, so that the front stays the front
    LargeArray<Triangle>& triangles = mesh.triangles.own();
    LargeArray<Vec3>& corner_normals = mesh.corner_normals.own();
    LargeArray<Vec2>& uv = mesh.uv.own();
    for (size_t t = 0; t < triangles.size(); ++t) {
      std::swap(triangles[t][1], triangles[t][2]);
      if (!corner_normals.empty()) std::swap(corner_normals[3 * t + 1], corner_normals[3 * t + 2]);
      for (LargeArray<Vec3>& normals : mesh.motion.corner_normals)
        if (!normals.empty()) std::swap(normals[3 * t + 1], normals[3 * t + 2]);
      if (!uv.empty()) std::swap(uv[3 * t + 1], uv[3 * t + 2]);
      for (MeshAttribute& attribute : mesh.attributes) attribute.swap_corners(3 * t + 1, 3 * t + 2);
    }
  }
}

}  // namespace

Scene::Scene(int threads) : pool_(threads) {
  // A thread count given to Embree limits TBB, and so Blender, while the device lives: given only
  // when asked for.
  const bool restricted =
      threads > 0 && static_cast<unsigned>(threads) < std::thread::hardware_concurrency();
  const std::string n = std::to_string(pool_.size());
  device_ = rtcNewDevice(restricted ? ("threads=" + n + ",user_threads=" + n).c_str() : nullptr);
  if (!device_) throw std::runtime_error("Embree could not be started");
  packets_ = rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0;
}

Scene::~Scene() {
  if (top_) rtcReleaseScene(top_);
  for (const auto* scenes : {&mesh_scenes_, &own_scenes_})
    for (RTCScene scene : *scenes)
      if (scene) rtcReleaseScene(scene);
  rtcReleaseDevice(device_);
}

void Scene::add_instance(uint32_t mesh, const std::array<double, 12>& exact,
                         const std::vector<int32_t>& slots) {
  if (mesh >= meshes.size())
    throw std::invalid_argument("an instance names a mesh that does not exist");
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

void Scene::set_motion(uint32_t instance, std::span<const Affine> steps) {
  if (instance >= instances.size())
    throw std::invalid_argument("there is no instance that could move");
  if (steps.size() < 3 || steps.size() % 2 == 0)
    throw std::invalid_argument("an instance's motion has no step in its middle");
  instances[instance].motion = static_cast<int32_t>(motions.size());
  motions.emplace_back(steps);
}

void Scene::throw_on_error(const CancelFlag& cancel) const {
  const RTCError error = rtcGetDeviceError(device_);
  cancel.check();
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error(std::string("Embree failed: ") + rtcGetErrorString(error));
}

RTCGeometry Scene::make_geometry(const Mesh& mesh) const {
  return mesh.strands ? mesh.strands->make_geometry(device_) : triangles_of(device_, mesh);
}

void Mesh::describe_surface(ScratchMemory& scratch, const CancelFlag& cancel) {
  if (strands) return;
  topology = build_topology(positions, triangles, scratch, cancel);
  edge_tree = std::make_unique<EdgeTree>(topology.edges);
  surface_tree = std::make_unique<SurfaceTree>(positions, triangles, topology, scratch, cancel);
  bent = bent_shares(*this);
  rounding = farthest = 0;
  for (const Vec3& p : positions) farthest = std::max(farthest, max_abs(p));
  for (uint32_t t = 0; t < triangles.size(); ++t) rounding = std::max(rounding, rounding_of(t));
}

void Scene::commit(RTCScene scene, const CancelFlag& cancel,
                   const std::function<void()>& meanwhile) {
  // Curves else take twice the memory
  rtcSetSceneFlags(
      scene, strands_ ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneProgressMonitorFunction(scene, report_progress, const_cast<CancelFlag*>(&cancel));
  pool_.run_on_all([&](int worker) {
    // One with Embree, the others with what can be done meanwhile
    const bool begins = worker == pool_.size() - 1;
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
  find_moving();
  for (Instance& instance : instances) {
    instance.shared = uses[instance.mesh] > 1 || instance.motion >= 0;
    const auto& strands = meshes[instance.mesh].strands;
    instance.shared |= strands && !scales_evenly(instance.to_world);
    if (instance.shared) continue;
    if (strands) {
      strands->transform(instance.exact, instance.scale);
      stand_still(instance);
      continue;
    }
    cancel.check();
    move_to_world(meshes[instance.mesh], instance, pool_, cancel);
    stand_still(instance);
  }

  find_swept();
  see_limits();
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
        RTCGeometry own = make_geometry(mesh);
        if (limits_rays()) {
          rtcSetGeometryMask(own, kAllRays);
          rtcCommitGeometry(own);
        }
        rtcAttachGeometryByID(inner, own, 0);
        rtcReleaseGeometry(own);
        commit(inner, cancel);
      }
      geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
      rtcSetGeometryInstancedScene(geometry, inner);
      if (instance.motion >= 0)
        set_transforms(geometry, motions[instance.motion]);
      else
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                                instance.to_world.m.data());
      if (limits_rays()) rtcSetGeometryMask(geometry, mask_of(instance));
      rtcCommitGeometry(geometry);
    } else {
      geometry = make_geometry(mesh);
      if (limits_rays()) {
        rtcSetGeometryMask(geometry, mask_of(instance));
        rtcCommitGeometry(geometry);
      }
    }
    rtcAttachGeometryByID(top_, geometry, i);
    rtcReleaseGeometry(geometry);
  }
  std::atomic<size_t> next{0};
  const auto describe_surfaces = [&] {
    ScratchMemory scratch;
    for (size_t m; (m = next++) < meshes.size();) {
      cancel.check();
      if (uses[m]) meshes[m].describe_surface(scratch, cancel);
    }
  };
  commit(top_, cancel, describe_surfaces);
  make_lookups();
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
  is_built_ = true;
  update_own_scenes(cancel);
  update_media(cancel);
  update_layers(cancel);
}

void Scene::update_own_scenes(const CancelFlag& cancel) {
  constexpr uint32_t kAsking = kProgramSubsurface | kProgramMeetsItself;
  if (!(features_ & kAsking)) return;
  own_scenes_.resize(instances.size(), nullptr);
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const Instance& instance = instances[i];
    if (instance.shared || own_scenes_[i] || meshes[instance.mesh].strands) continue;
    bool any = false;
    for (uint32_t slot = 0; slot < instance.slot_count; ++slot) {
      const int program = materials[slot_materials[instance.first_material + slot]].program;
      any |= program >= 0 && programs[program].features & kAsking;
    }
    if (!any) continue;
    own_scenes_[i] = rtcNewScene(device_);
    rtcAttachGeometryByID(own_scenes_[i], rtcGetGeometry(top_, i), 0);
    commit(own_scenes_[i], cancel);
  }
}

void Scene::update_media(const CancelFlag& cancel) { media_ = Media::of(*this, pool_, cancel); }

bool Scene::needs_paths() const {
  return strands_emit_ || asks_depth_ || emission_asks_length_ ||
         (media_ && (media_->emits() || media_->hides_from_shadows()));
}

bool Scene::scatters_in_media() const { return media_ && media_->scatters(); }

void Scene::see_limits() {
  catchers_ = std::any_of(instances.begin(), instances.end(),
                          [](const Instance& instance) { return instance.catcher; });
  any_ray_ = moves_ || strands_ || catchers_ ? 0 : kAllRays;
  kinds_differ_ = first_kinds_differ_ = translucence_differs_ = shadows_differ_ = false;
  for (const Instance& instance : instances) {
    const RayMask seen_by = instance.seen_by, scattered = seen_by & kScatteredRays;
    const auto same = [&](RayInfo::Kind a, RayInfo::Kind b) {
      return !(seen_by & ray_bit(a)) == !(seen_by & ray_bit(b));
    };
    if (seen_by != kAllRays) any_ray_ = 0;
    kinds_differ_ |= scattered != 0 && scattered != kScatteredRays;
    translucence_differs_ |= !same(RayInfo::kDiffuse, RayInfo::kTransmission);
    first_kinds_differ_ |= !same(RayInfo::kShadow, RayInfo::kGlossy) ||
                           !same(RayInfo::kShadow, RayInfo::kTransmission);
    shadows_differ_ |= !same(RayInfo::kShadow, RayInfo::kDiffuse) ||
                       !same(RayInfo::kShadow, RayInfo::kGlossy) ||
                       !same(RayInfo::kShadow, RayInfo::kTransmission) ||
                       !same(RayInfo::kShadow, RayInfo::kVolume);
  }
  if (limits_rays() && !rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED))
    throw std::runtime_error(
        "this Embree has no ray masks, which the visibility of objects to rays needs");
}

bool Scene::emits(const Instance& instance) const {
  for (uint32_t slot = 0; slot < instance.slot_count; ++slot) {
    const Material& m = materials[slot_materials[instance.first_material + slot]];
    if (m.program < 0 ? !is_black(m.front.emission)
                      : (programs[m.program].features & kProgramEmits) != 0)
      return true;
  }
  return false;
}

void Scene::update_features() {
  features_ = 0;
  asks_depth_ = emission_asks_length_ = programs_ask_shadow_ = false;
  for (int32_t material : slot_materials) {
    const int program = materials[material].program;
    if (program >= 0) {
      const Program& p = programs[program];
      asks_depth_ |= p.asks_depth;
      emission_asks_length_ |= p.asks_length && p.features & kProgramEmits;
      programs_ask_shadow_ |= p.asks_shadow && p.features & kProgramTransparent;
    }
    features_ |= program < 0 ? kProgramGathers | kProgramEmits : programs[program].features;
  }
  strands_emit_ = false;
  for (const Instance& instance : instances)
    strands_emit_ |= meshes[instance.mesh].strands && emits(instance);
  see_bent_normals();
}

void Scene::see_bent_normals() {
  for (Program& program : programs) program.on_bent_normals = false;
  for (const Instance& instance : instances) {
    const std::vector<float>& bent = meshes[instance.mesh].bent;
    for (uint32_t slot = 0; slot < std::min<size_t>(instance.slot_count, bent.size()); ++slot) {
      const int program = materials[slot_materials[instance.first_material + slot]].program;
      if (program >= 0 && bent[slot] > kBentShare) programs[program].on_bent_normals = true;
    }
  }
}

void Scene::make_lookups() {
  static constexpr Vec3 kNoNormals[3];
  static constexpr uint32_t kOnePatch = 0;
  static constexpr uint16_t kOneSlot = 0;
  lookups_.clear();
  for (const Instance& instance : instances) {
    const Mesh& mesh = meshes[instance.mesh];
    const bool flat = !mesh.is_smooth(), one_patch = mesh.topology.planar.size() <= 1,
               one_slot = mesh.slots.empty(), by_vertex = !mesh.vertex_normals.empty();
    lookups_.push_back(
        {flat        ? kNoNormals
         : by_vertex ? mesh.vertex_normals.data()
                     : mesh.corner_normals.data(),
         by_vertex ? mesh.triangles.data() : nullptr,
         one_patch ? &kOnePatch : mesh.topology.patch.data(),
         one_slot ? &kOneSlot : mesh.slots.data(), flat ? 0 : ~0u, one_patch ? 0 : ~0u,
         one_slot ? 0 : ~0u, instance.seed, instance.shared,
         instance.shared
             ? instance.scale * std::max(mesh.rounding, ray_offset({mesh.farthest, 0, 0}, 0))
             : mesh.rounding,
         mesh.strands.get()});
  }
}

}  // namespace photon_splat
