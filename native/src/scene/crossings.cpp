#include "scene/crossings.h"

#include "scene/scene.h"

namespace photon_splat {
namespace {

// Notes what the ray meets and lets nothing stop it.
struct Query {
  RTCRayQueryContext context;  // first, as it is what Embree hands back
  Crossings out;
  std::array<Vec3, Crossings::kMost> normals;  // of the front, of the mesh where it is instanced
  std::array<bool, Crossings::kMost> instanced;

  static void note(const RTCFilterFunctionNArguments* arguments) {
    Query& query = *reinterpret_cast<Query*>(arguments->context);
    Crossings& out = query.out;
    const auto* const hit = reinterpret_cast<const RTCHit*>(arguments->hit);
    const auto* const ray = reinterpret_cast<const RTCRay*>(arguments->ray);
    if (arguments->valid[0] && out.count < Crossings::kMost) {
      const bool instanced = hit->instID[0] != RTC_INVALID_GEOMETRY_ID;
      query.normals[out.count] = {hit->Ng_x, hit->Ng_y, hit->Ng_z};
      query.instanced[out.count] = instanced;
      out.met[out.count++] = {
          instanced ? hit->instID[0] : hit->geomID, hit->primID, hit->u, hit->v, ray->tfar, false};
    }
    arguments->valid[0] = 0;
  }
};

}  // namespace

Crossings Scene::crossings(const Vec3& origin, const Vec3& direction, float near, float far,
                           RayMask kinds, float time) const {
  Query query;
  rtcInitRayQueryContext(&query.context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = static_cast<RTCRayQueryFlags>(RTC_RAY_QUERY_FLAG_INCOHERENT |
                                                  RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER);
  arguments.filter = Query::note;
  arguments.context = &query.context;
  RTCRayHit hit;
  hit.ray = {origin.x,    origin.y,         origin.z,    near,
             direction.x, direction.y,      direction.z, time,
             far,         kinds | any_ray_, 0,           0};
  hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(top_, &hit, &arguments);
  for (size_t i = 0; i < query.out.count; ++i) {
    const Vec3& n = query.normals[i];
    query.out.met[i].back =
        dot(query.instanced[i] ? normal_from_mesh(query.out.met[i].instance, n, time) : n,
            direction) > 0;
  }
  return query.out;
}

}  // namespace photon_splat
