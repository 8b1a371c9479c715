#pragma once

#include "scene/scene.h"

namespace photon_splat {

// Where a photon path starts. `power` is that of the whole light field divided by the pdf: W for
// one photon of one.
struct PhotonStart {
  Vec3 origin, direction;
  Rgb power;
  // For a lamp that faces its receiver, see `accepts`: its squared radius, the squared distance at
  // which the ray passes its centre, and how far from the origin that is.
  float soft_radius2 = -1, soft_miss2 = 0, soft_nearest = 0;
  // Distances at which the first surface is lit by this photon
  float first_hit_from = 0, first_hit_to = INFINITY;
  uint64_t lit_groups = ~uint64_t{0};  // the first surface is lit if it is of one of these
  uint64_t blockers = ~uint64_t{0};    // and lets the light pass if it is of none of these
  int16_t light_group = kNoLightGroup;
  RayMask seen_by = kAllRays;  // the first surface scatters it by lobes of these kinds
  uint32_t max_bounces = ~0u;  // lobes that it goes through
  bool deltas = true;          // the first surface's may be deltas
  // Else nothing blocks it, but behind what would have done so deltas do not scatter it
  bool casts_shadows = true;
  int32_t aim = -1;  // pair of EmissionTargets; -1: natural emission
  // An emitter that lies in a surface, and the place on it that the first surface must be seen from
  int32_t exact = -1;
  Vec3 place;
  // a lamp with a program: `power` lacks Lights::first_hit_factor(), which needs the distance
  int32_t shaded_by = -1;
  // A photon of the world: `power` lacks Environment::share() of the ray that sees it
  bool asks_ray = false;
  bool of_world = false;
  // It comes where scattered rays meet the light, by no light sample: what shadow rays do not see
  // blocks it too
  bool by_rays = false;
  // Half of its light comes so and half by light samples, which gets its part where it is scattered
  // first
  bool shares_with_rays = false;
  // A lamp's emitter, where what scatters its light by lobes that are not diffuse tells rays that
  // find the lamp from light samples
  int32_t told_apart = -1;
  // Emitter of a lamp without shadow that rays find: behind what would block it they do not
  int32_t unshadowed = -1;
  bool from_afar = false;  // of a sun or the world
  float time = kShutterCentre;

  // Whether it lights and is stopped by whatever it meets, as it is.
  bool plain() const {
    return !~lit_groups && seen_by == kAllRays && !~max_bounces && deltas && casts_shadows &&
           !~blockers && soft_radius2 < 0 && first_hit_from == 0 && first_hit_to == INFINITY &&
           shaded_by < 0 && !asks_ray && !shares_with_rays && exact < 0;
  }
  // How far before the point nearest to the centre the light leaves such a disc, for a receiver
  // there.
  float before_nearest(float distance) const {
    const float t = distance - soft_nearest;
    return soft_radius2 > 0 && t > 0 ? soft_miss2 / t : 0;
  }
  // A disc of radius r that faces a receiver shows it, of the rays that pass its centre at a
  // distance m, those that have gone on for t >= m^2 / sqrt(r^2 - m^2) since they were nearest to
  // the centre. (They leave the disc m^2 / t before that.)
  bool accepts(float distance) const {
    if (distance < first_hit_from || distance > first_hit_to) return false;
    if (soft_radius2 < 0) return true;
    const float t = distance - soft_nearest;
    return t > 0 && soft_miss2 <= t * std::sqrt(std::max(0.0f, soft_radius2 - soft_miss2));
  }
};

}  // namespace photon_splat
