// What kernels see that bounce photon paths off plain surfaces, many side by side: plain data,
// included by files that are compiled for several instruction sets. Nothing here may define a
// function: the linker would keep one copy for all machines.
#pragma once

#include "scene/ray_hits.h"

namespace photon_splat {

inline constexpr uint32_t kBounceLanes = RayHits::kMost;

// Paths between two of their rays; structure of arrays. Kernels read whole vectors, beyond the last
// path too.
struct alignas(64) PhotonPaths {
  static constexpr uint32_t kMost = 512, kSpace = kMost + kBounceLanes;
  float origin_x[kSpace], origin_y[kSpace], origin_z[kSpace];
  float direction_x[kSpace], direction_y[kSpace], direction_z[kSpace];
  float red[kSpace], green[kSpace], blue[kSpace];  // power
  float reference[kSpace];                         // power that survivors of Russian roulette keep
  float caustic[kSpace];                           // share of caustic light
  uint64_t random[kSpace];                         // state of `Random`
  uint32_t bounces[kSpace];                        // lobes
  uint32_t alone[kSpace];                          // 1: may not be bounced with others
  // In [0, 1): where they go after their first bounce, if none has gone yet or ended
  float first_u[kSpace], first_v[kSpace];
  float time[kSpace];     // in the shutter's opening; not set where nothing moves
  uint32_t left[kSpace];  // Surface::mark of where they start
};

struct BounceSettings {
  // a photon takes share + share_of_caustic * (share of caustic light) of its path's power
  float share, share_of_caustic;
  uint32_t max_bounces;  // after which paths end
};

struct alignas(64) Bounced {
  // Power of what is stored, W
  float stored_red[kBounceLanes], stored_green[kBounceLanes], stored_blue[kBounceLanes];
  // encode_direction() of the geometric normal and, in the upper half, of the way it came
  uint32_t directions[kBounceLanes];
  float origin_x[kBounceLanes], origin_y[kBounceLanes], origin_z[kBounceLanes];
  float direction_x[kBounceLanes], direction_y[kBounceLanes], direction_z[kBounceLanes];
  float red[kBounceLanes], green[kBounceLanes], blue[kBounceLanes];
  uint64_t random[kBounceLanes];
  uint32_t stores, goes_on;  // bit k: lane k
};

// What PhotonTracer::shade() does, to paths first .. first + kBounceLanes - 1. All give the same
// numbers bit for bit.
using BounceKernel = void (*)(const PhotonPaths& paths, uint32_t first, const RayHits& hits,
                              const PlainSurfaces& surfaces, const BounceSettings& settings,
                              Bounced& out);

void bounce_generic(const PhotonPaths& paths, uint32_t first, const RayHits& hits,
                    const PlainSurfaces& surfaces, const BounceSettings& settings, Bounced& out);
void bounce_sse42(const PhotonPaths& paths, uint32_t first, const RayHits& hits,
                  const PlainSurfaces& surfaces, const BounceSettings& settings, Bounced& out);
void bounce_avx2(const PhotonPaths& paths, uint32_t first, const RayHits& hits,
                 const PlainSurfaces& surfaces, const BounceSettings& settings, Bounced& out);
void bounce_avx512(const PhotonPaths& paths, uint32_t first, const RayHits& hits,
                   const PlainSurfaces& surfaces, const BounceSettings& settings, Bounced& out);

}  // namespace photon_splat
