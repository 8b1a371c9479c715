#include "bench/photon_tracer.h"

#include <chrono>

namespace photon_splat {
namespace {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

constexpr size_t kRaysPerChunk = 4096;
constexpr float kNear = 1e-4f;  // m: off the surface that the ray starts from

// The ways that photons came, backwards: rays as long and as scattered as those of the tracer, as
// origin, near, direction, far (8 floats a ray).
std::vector<float> rays_back(const Photons& photons) {
  std::vector<float> rays;
  rays.reserve(8 * photons.size());
  for (const Photon& p : photons) {
    const Vec3 back = decode_direction(p.from);
    rays.insert(rays.end(), {p.position.x, p.position.y, p.position.z, kNear, back.x, back.y,
                             back.z, INFINITY});
  }
  return rays;
}

template <class Hit, int N, class Intersect>
void replay_packets(Renderer& r, const std::vector<float>& log, Intersect&& intersect) {
  const size_t rays = log.size() / 8;
  r.scene.pool().for_each((rays + kRaysPerChunk - 1) / kRaysPerChunk, r.cancel_flag(),
                          [&](size_t c, int) {
                            RTCIntersectArguments arguments;
                            rtcInitIntersectArguments(&arguments);
                            arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
                            const size_t end = std::min(rays, (c + 1) * kRaysPerChunk);
                            for (size_t i = c * kRaysPerChunk; i < end; i += N) {
                              alignas(64) Hit hit;
                              alignas(64) int valid[N];
                              for (int k = 0; k < N; ++k) {
                                const float* p = &log[8 * std::min(i + k, end - 1)];
                                valid[k] = i + k < end ? -1 : 0;
                                hit.ray.org_x[k] = p[0];
                                hit.ray.org_y[k] = p[1];
                                hit.ray.org_z[k] = p[2];
                                hit.ray.tnear[k] = p[3];
                                hit.ray.dir_x[k] = p[4];
                                hit.ray.dir_y[k] = p[5];
                                hit.ray.dir_z[k] = p[6];
                                hit.ray.tfar[k] = p[7];
                                hit.ray.time[k] = 0;
                                hit.ray.mask[k] = ~0u;
                                hit.ray.id[k] = 0;
                                hit.ray.flags[k] = 0;
                                hit.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
                                hit.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
                              }
                              intersect(valid, &hit, &arguments);
                            }
                          });
}

}  // namespace

TracerBench bench_photon_tracer(Renderer& r, uint64_t paths) {
  TracerBench out;
  SurfaceFilter all;
  for (uint32_t i = 0; i < 1u << 22; ++i) all.add(i);
  PhotonTracer& tracer = r.map().tracer();
  const Photons* photons = nullptr;
  const auto trace = [&] {
    photons = &tracer.trace(0, paths, static_cast<double>(paths), 1, all, r.cancel_flag());
  };
  trace();
  const uint64_t before = tracer.counts().rays;
  out.tracer_seconds = seconds_of(trace);
  out.rays = tracer.counts().rays - before;
  const std::vector<float> log = rays_back(*photons);
  out.embree_rays = log.size() / 8;

  RTCScene scene = r.scene.embree();
  out.intersect1_seconds = seconds_of([&] {
    const size_t rays = log.size() / 8;
    r.scene.pool().for_each(
        (rays + kRaysPerChunk - 1) / kRaysPerChunk, r.cancel_flag(), [&](size_t c, int) {
          RTCIntersectArguments arguments;
          rtcInitIntersectArguments(&arguments);
          arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
          for (size_t i = c * kRaysPerChunk; i < std::min(rays, (c + 1) * kRaysPerChunk); ++i) {
            const float* p = &log[8 * i];
            RTCRayHit hit;
            hit.ray = {p[0], p[1], p[2], p[3], p[4], p[5], p[6], 0, p[7], ~0u, 0, 0};
            hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene, &hit, &arguments);
          }
        });
  });
  out.intersect8_seconds = seconds_of([&] {
    replay_packets<RTCRayHit8, 8>(r, log,
                                  [&](const int* valid, RTCRayHit8* hit, RTCIntersectArguments* a) {
                                    rtcIntersect8(valid, scene, hit, a);
                                  });
  });
  out.intersect16_seconds = seconds_of([&] {
    replay_packets<RTCRayHit16, 16>(
        r, log, [&](const int* valid, RTCRayHit16* hit, RTCIntersectArguments* a) {
          rtcIntersect16(valid, scene, hit, a);
        });
  });
  return out;
}

}  // namespace photon_splat
