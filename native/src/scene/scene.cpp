// What rays find.
#include "scene/scene.h"

#include <bit>

#include "math/sampling.h"

namespace photon_splat {
namespace {

constexpr int kLooksInTime = 9;  // at what may come near while the shutter is open

}  // namespace

bool Scene::meets_itself(uint32_t index, const Vec3& origin, const Vec3& direction, float near,
                         float far, float time, OwnHit& found) const {
  const Instance& instance = instances[index];
  if (meshes[instance.mesh].strands) return false;
  const RTCScene scene = instance.shared              ? mesh_scenes_[instance.mesh]
                         : index < own_scenes_.size() ? own_scenes_[index]
                                                      : nullptr;
  if (!scene) return false;
  Affine to_local;
  if (instance.shared) to_local = pose_at(index, time).to_local;
  const Vec3 o = instance.shared ? to_local.point(origin) : origin,
             d = instance.shared ? to_local.vector(direction) : direction;
  RTCRayHit hit;
  hit.ray = {o.x, o.y, o.z, near, d.x, d.y, d.z, time, far, ~0u, 0, 0};
  hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcIntersect1(scene, &hit, &arguments);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  Vec3 normal{hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z};
  if (instance.shared) normal = to_local.transposed_vector(normal);
  found = {hit.hit.primID, hit.hit.u, hit.hit.v, hit.ray.tfar, normalize(normal)};
  return true;
}

bool Scene::intersect(const Vec3& origin, const Vec3& direction, float near, float far,
                      bool coherent, Surface& surface, RayMask kinds, float time,
                      uint32_t left) const {
  RTCRayHit hit;
  hit.ray = {origin.x,    origin.y,         origin.z,    near,
             direction.x, direction.y,      direction.z, time,
             far,         kinds | any_ray_, left,        0};
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
  if (instanced) normal = normal_from_mesh(instance, normal, time);
  fill_surface({instance, hit.hit.primID, hit.hit.u, hit.hit.v, hit.ray.tfar,
                origin + direction * hit.ray.tfar, normalize(normal), time},
               direction, surface);
  return true;
}

// Has the memory come while others are worked on.
inline void Scene::Lookup::fetch_ahead(uint32_t triangle) const {
  if (corners)
    prefetch(corners + triangle);
  else
    prefetch(normals + 3 * static_cast<size_t>(triangle & normals_mask));
  prefetch(patches + (triangle & patches_mask));
  prefetch(slots + (triangle & slots_mask));
}

inline uint32_t Scene::Lookup::key(uint32_t triangle, bool back) const {
  // An odd multiplier keeps patches of one instance apart; the seed is random, so that those of
  // others rarely meet.
  return ((seed ^ patches[triangle & patches_mask] * 0x9e3779b1u) << 1) | (back ? 1u : 0u);
}

// Smooth normal of the front, of any length; 0 where the mesh is flat.
inline Vec3 Scene::smooth_normal(uint32_t index, uint32_t triangle, float u, float v,
                                 float time) const {
  if (moves(index)) return moving_normal(index, triangle, u, v, time);
  const Lookup& lookup = lookups_[index];
  Vec3 made[3];
  const Vec3* n = lookup.normals_of(triangle, made);
  const Vec3 ns = n[0] * (1 - u - v) + n[1] * u + n[2] * v;
  return lookup.shared ? instances[index].to_local.transposed_vector(ns) : ns;
}

// Rays `place` and the next seven, as far as there are any. Normals are as Embree has them, of the
// instanced mesh where `back` says that there is one; `instance` is RTC_INVALID_GEOMETRY_ID where
// nothing was met.
void Scene::intersect_eight(const Rays& rays, uint32_t count, RayHits& hits, uint32_t place) const {
  const auto take = [&](uint32_t k, uint32_t geometry, uint32_t instance, uint32_t triangle,
                        float u, float v, float distance, const Vec3& normal) {
    hits.back[k] = instance != RTC_INVALID_GEOMETRY_ID;
    hits.instance[k] = hits.back[k] ? instance : geometry;
    hits.triangle[k] = triangle;
    hits.u[k] = u, hits.v[k] = v, hits.distance[k] = distance;
    hits.nx[k] = normal.x, hits.ny[k] = normal.y, hits.nz[k] = normal.z;
  };
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  if (!packets_) {
    for (uint32_t k = place; k < place + kPacket; ++k) {
      RTCRayHit hit{};
      const Vec3 d = rays.direction(k);
      hit.ray = {rays.origin_x[k],
                 rays.origin_y[k],
                 rays.origin_z[k],
                 0,
                 d.x,
                 d.y,
                 d.z,
                 rays.time ? rays.time[k] : kShutterCentre,
                 INFINITY,
                 rays.kinds ? rays.kinds[k] : kAllRays,
                 rays.left ? rays.left[k] : 0,
                 0};
      hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      if (k < count) rtcIntersect1(top_, &hit, &arguments);
      take(k, hit.hit.geomID, hit.hit.instID[0], hit.hit.primID, hit.hit.u, hit.hit.v, hit.ray.tfar,
           {hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z});
    }
    return;
  }
  alignas(64) RTCRayHit8 hit;
  alignas(64) int valid[kPacket];
  const auto copy = [place](const float* from, float* to) {
    std::copy_n(from + place, kPacket, to);
  };
  copy(rays.origin_x, hit.ray.org_x);
  copy(rays.origin_y, hit.ray.org_y);
  copy(rays.origin_z, hit.ray.org_z);
  copy(rays.direction_x, hit.ray.dir_x);
  copy(rays.direction_y, hit.ray.dir_y);
  copy(rays.direction_z, hit.ray.dir_z);
  for (uint32_t k = 0; k < kPacket; ++k) {
    valid[k] = place + k < count ? -1 : 0;
    hit.ray.tnear[k] = 0;
    hit.ray.time[k] = rays.time ? rays.time[place + k] : kShutterCentre;
    hit.ray.tfar[k] = INFINITY;
    hit.ray.mask[k] = rays.kinds ? rays.kinds[place + k] : kAllRays;
    hit.ray.id[k] = rays.left ? rays.left[place + k] : 0;
    hit.ray.flags[k] = 0;
    hit.hit.geomID[k] = hit.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    hit.hit.primID[k] = 0;
    hit.hit.u[k] = hit.hit.v[k] = 0;
    hit.hit.Ng_x[k] = hit.hit.Ng_y[k] = hit.hit.Ng_z[k] = 1;
  }
  rtcIntersect8(valid, top_, &hit, &arguments);
  for (uint32_t k = 0; k < kPacket; ++k)
    take(place + k, hit.hit.geomID[k], hit.hit.instID[0][k], hit.hit.primID[k], hit.hit.u[k],
         hit.hit.v[k], hit.ray.tfar[k], {hit.hit.Ng_x[k], hit.hit.Ng_y[k], hit.hit.Ng_z[k]});
}

unsigned Scene::intersect(const Rays& rays, uint32_t count, RayHits& hits) const {
  constexpr uint32_t kMost = RayHits::kMost;
  static_assert(kMost % kPacket == 0);
  for (uint32_t place = 0; place < kMost; place += kPacket) {
    if (place < count)
      intersect_eight(rays, count, hits, place);
    else
      std::fill_n(hits.instance + place, kPacket, RTC_INVALID_GEOMETRY_ID);
  }
  unsigned found = 0;
  for (uint32_t k = 0; k < kMost; ++k) {
    if (hits.instance[k] == RTC_INVALID_GEOMETRY_ID) continue;
    found |= 1u << k;
    lookups_[hits.instance[k]].fetch_ahead(hits.triangle[k]);
    if (!hits.back[k]) continue;
    const Vec3 n = normal_from_mesh(hits.instance[k], {hits.nx[k], hits.ny[k], hits.nz[k]},
                                    rays.time ? rays.time[k] : kShutterCentre);
    hits.nx[k] = n.x, hits.ny[k] = n.y, hits.nz[k] = n.z;
  }
  // All lanes at once, those that missed too.
  for (uint32_t k = 0; k < kMost; ++k) {
    const Vec3 n = normalize({hits.nx[k], hits.ny[k], hits.nz[k]});
    const bool back = dot(n, rays.direction(k)) > 0;
    hits.back[k] = back;
    hits.nx[k] = back ? -n.x : n.x;
    hits.ny[k] = back ? -n.y : n.y;
    hits.nz[k] = back ? -n.z : n.z;
    hits.x[k] = rays.origin_x[k] + rays.direction_x[k] * hits.distance[k];
    hits.y[k] = rays.origin_y[k] + rays.direction_y[k] * hits.distance[k];
    hits.z[k] = rays.origin_z[k] + rays.direction_z[k] * hits.distance[k];
  }
  return found;
}

unsigned Scene::plain_surfaces(const RayHits& hits, unsigned which, PlainSurfaces& out) const {
  unsigned plain = 0;
  for (unsigned rest = which; rest; rest &= rest - 1) {
    const uint32_t k = static_cast<uint32_t>(std::countr_zero(rest)), instance = hits.instance[k],
                   triangle = hits.triangle[k];
    const Material& material = material_of(instance, triangle);
    if (material.program >= 0 || lookups_[instance].strands) continue;
    plain |= 1u << k;
    const MaterialSide& side = hits.back[k] ? material.back : material.front;
    const Vec3 n = smooth_normal(instance, triangle, hits.u[k], hits.v[k], kShutterCentre);
    Rgb albedo = side.albedo;
    if (side.albedo_texture >= 0)
      albedo *=
          textures[side.albedo_texture].lookup(uv_at(instance, triangle, hits.u[k], hits.v[k]));
    out.nx[k] = n.x, out.ny[k] = n.y, out.nz[k] = n.z;
    out.red[k] = albedo.x, out.green[k] = albedo.y, out.blue[k] = albedo.z;
    out.key[k] = lookups_[instance].key(triangle, hits.back[k]);
    out.rounding[k] = rounding_beyond(
        ray_offset({hits.x[k], hits.y[k], hits.z[k]}, hits.distance[k]), instance, triangle);
  }
  return plain;
}

Surface Scene::surface_of(const RayHits& hits, uint32_t k, const Vec3& direction,
                          float time) const {
  const Vec3 n{hits.nx[k], hits.ny[k], hits.nz[k]};
  Surface s;
  fill_surface({hits.instance[k],
                hits.triangle[k],
                hits.u[k],
                hits.v[k],
                hits.distance[k],
                {hits.x[k], hits.y[k], hits.z[k]},
                hits.back[k] ? -n : n,
                time},
               direction, s);
  return s;
}

unsigned Scene::intersect_packet(const Vec3* origins, const Vec3* directions, uint32_t count,
                                 Surface* surfaces, RayMask kinds) const {
  alignas(64) float ray[6][RayHits::kMost] = {};
  for (uint32_t k = 0; k < count; ++k) {
    const float all[6] = {origins[k].x,    origins[k].y,    origins[k].z,
                          directions[k].x, directions[k].y, directions[k].z};
    for (int i = 0; i < 6; ++i) ray[i][k] = all[i];
  }
  RayMask masks[RayHits::kMost];
  std::fill_n(masks, RayHits::kMost, kinds | any_ray_);
  RayHits hits;
  const unsigned found =
      intersect({ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], masks}, count, hits);
  for (uint32_t k = 0; k < count; ++k)
    if (found >> k & 1) surfaces[k] = surface_of(hits, k, directions[k]);
  return found;
}

bool Scene::occluded(const Vec3& origin, const Vec3& direction, float near, float far,
                     RayMask kinds, float time, uint32_t left) const {
  RTCRay ray{origin.x,    origin.y,         origin.z,    near,
             direction.x, direction.y,      direction.z, time,
             far,         kinds | any_ray_, left,        0};
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcOccluded1(top_, &ray, &arguments);
  return ray.tfar < 0;
}

unsigned Scene::occluded_packet(const Vec3* origins, uint32_t count, const Vec3& direction,
                                float far, RayMask kinds) const {
  unsigned found = 0;
  if (!packets_) {
    for (uint32_t k = 0; k < count; ++k)
      found |= unsigned(occluded(origins[k], direction, 0, far, kinds)) << k;
    return found;
  }
  alignas(64) RTCRay8 ray;
  alignas(64) int valid[kPacket];
  for (uint32_t k = 0; k < kPacket; ++k) {
    const Vec3& origin = origins[std::min(k, count - 1)];
    valid[k] = k < count ? -1 : 0;
    ray.org_x[k] = origin.x;
    ray.org_y[k] = origin.y;
    ray.org_z[k] = origin.z;
    ray.dir_x[k] = direction.x;
    ray.dir_y[k] = direction.y;
    ray.dir_z[k] = direction.z;
    ray.tnear[k] = 0;
    ray.time[k] = kShutterCentre;
    ray.tfar[k] = far;
    ray.mask[k] = kinds | any_ray_;
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
  const auto stop_at_first = [](RTCPointQueryFunctionArguments* arguments) {
    *static_cast<bool*>(arguments->userPtr) = true;
    arguments->query->radius = 0;
    return true;
  };
  const int looks = moves_ ? kLooksInTime : 1;
  for (int i = 0; i < looks && !found; ++i) {
    const float time =
        moves_ ? static_cast<float>(i) / static_cast<float>(looks - 1) : kShutterCentre;
    RTCPointQuery query{x.x, x.y, x.z, time, radius};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    rtcPointQuery(top_, &query, &context, stop_at_first, &found);
  }
  return found;
}

void Scene::fill_surface(const RawHit& hit, const Vec3& direction, Surface& s) const {
  s.instance = hit.instance;
  s.triangle = hit.triangle;
  s.u = hit.u;
  s.v = hit.v;
  s.distance = hit.distance;
  s.position = hit.position;
  if (lookups_[hit.instance].strands)
    fill_strand(hit, direction, s);
  else
    fill_triangle(hit, direction, s);
  const Material& material = material_of(s.instance, s.triangle);
  s.side = s.back ? &material.back : &material.front;
  s.program = material.program < 0 ? nullptr : &programs[material.program];
}

inline void Scene::fill_triangle(const RawHit& hit, const Vec3& direction, Surface& s) const {
  s.mark = 0;
  Vec3 ng = hit.normal;
  // Blender keeps a mirrored object's front where the mesh's normals, mirrored with it, point.
  s.back = dot(ng, direction) > 0;
  const Vec3 ns = smooth_normal(s.instance, s.triangle, s.u, s.v, hit.time);
  const float len = length(ns);
  s.ns = len > 0 ? ns / len : ng;
  if (s.back) {
    ng = -ng;
    s.ns = -s.ns;
  }
  s.ng = ng;
  s.key = lookups_[s.instance].key(s.triangle, s.back);
  s.rounding = rounding_beyond(ray_offset(s.position, s.distance), s.instance, s.triangle);
}

float Scene::large_rounding(uint32_t instance, uint32_t triangle) const {
  const Instance& of = instances[instance];
  const Mesh& mesh = meshes[of.mesh];
  float found = mesh.rounding_of(triangle);
  if (!of.shared) return found;
  // Embree has the ray in the mesh's coordinates
  for (const uint32_t corner : mesh.triangles[triangle])
    found = std::max(found, ray_offset(mesh.positions[corner], 0));
  return found * of.scale;
}

Surface Scene::surface_at(uint32_t index, uint32_t triangle, float u, float v, bool back,
                          float time) const {
  if (moves(index)) return moving_surface_at(index, triangle, u, v, back, time);
  const Instance& instance = instances[index];
  const Mesh& mesh = meshes[instance.mesh];
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 a = mesh.positions[t[0]], ab = mesh.positions[t[1]] - a, ac = mesh.positions[t[2]] - a;
  const Vec3 normal = cross(ab, ac);
  const Vec3 front = instance.shared ? instance.to_local.transposed_vector(normal) : normal;
  Surface s;
  fill_surface(
      {index, triangle, u, v, 0, instance.to_world.point(a + ab * u + ac * v), normalize(front)},
      normalize(back ? front : -front), s);
  return s;
}

const Material& Scene::material_of(uint32_t instance_index, uint32_t triangle) const {
  const Instance& instance = instances[instance_index];
  const Lookup& lookup = lookups_[instance_index];
  const uint32_t slot =
      std::min<uint32_t>(lookup.slots[triangle & lookup.slots_mask], instance.slot_count - 1);
  return materials[slot_materials[instance.first_material + slot]];
}

Vec2 Scene::uv_at(uint32_t instance, uint32_t triangle, float u, float v) const {
  const Mesh& mesh = meshes[instances[instance].mesh];
  if (mesh.uv.empty()) return {0, 0};
  if (mesh.strands) return mesh.uv[mesh.strands->strand(triangle)];
  const Vec2* uv = &mesh.uv[3 * static_cast<size_t>(triangle)];
  const float w = 1 - u - v;
  return {uv[0].x * w + uv[1].x * u + uv[2].x * v, uv[0].y * w + uv[1].y * u + uv[2].y * v};
}

}  // namespace photon_splat
