// What a place asks of the lights, and what one of them sends there.
#pragma once

#include <functional>

#include "lights/environment_guide.h"
#include "scene/scene.h"

namespace photon_splat {

// Sums of light by group, each times a factor.
struct GroupLight {
  Rgb* sums;  // by number of the group
  Rgb factor;
  void add(const Rgb& light, int16_t group) {
    if (const Rgb scaled = factor * light; group != kNoLightGroup && can_be_added(scaled))
      sums[group] += scaled;
  }
};

// Share of the light from a light so far off that comes through the media on its way.
using Attenuation = std::function<Rgb(float distance)>;

// Where light is wanted.
struct Receiver {
  Vec3 x;
  Vec3 n;  // unit; 0 where light from either side counts
  // Scatters in narrow lobes: its rays share all lights they can find with `sample`, not near ones
  // only
  bool sharp = false;
  uint64_t group = ~uint64_t{0};  // Instance::group
  // The guide to the world at this place, from Lights::guide_at(), or null
  const EnvironmentGuide::Cell* guide = nullptr;
  uint8_t world_samples = 1;  // how many sample_world() is asked for
  // RayMasks of the ray on its way from there, see light_rays(): as diffuse lobes send it, and as
  // the others do. Which share of it counts as the former, for lights and for the world, says
  // Bsdf::diffuse_share(); exact where a light hides from some rays or the world asks.
  uint8_t ray = 0xff, diffuse_ray = 0xff;
  Rgb diffuse_share{}, diffuse_share_of_world{};
  float ray_pdf = INFINITY;  // Bsdf::ray_pdf() of that ray, where Lights::world_shares()
  uint16_t bounces = 0;      // of the path before that
  // unit: it scatters in proportion to the cosine with this, more or less; 0: who knows
  Vec3 ns{};
  // Its mesh is coarse for its smooth normals: lights below the surface proper count as well
  bool bent = false;
  float time = kShutterCentre;
  bool catchers_only = false;  // RayInfo::catchers_only of the path

  // The share of the ray that finds lights, or the world, that are seen by these.
  Rgb seeing(RayMask seen_by, bool world) const {
    const Rgb& diffuse = world ? diffuse_share_of_world : diffuse_share;
    return (seen_by & diffuse_ray ? diffuse : Rgb{}) +
           (seen_by & ray ? Rgb{1, 1, 1} - diffuse : Rgb{});
  }
  Vec3 horizon() const { return bent ? Vec3{} : n; }
  // Whether light is to be sampled in proportion to the cosine.
  bool diffuse() const { return !sharp && !is_black(n * n) && !is_black(ns * ns); }
};

// Light arriving at a point from one direction. weight = radiance / pdf (solid angle, choice of
// light included).
struct LightSample {
  Vec3 direction;
  float distance;
  // Normal of an emissive surface, towards the point; 0 for lamps, which nothing shadows but what
  // is before them
  Vec3 normal;
  Rgb weight;
  float pdf;  // solid angle; 0 for directions no BSDF sample can find
  bool use_mis;
  uint64_t blockers = ~uint64_t{0};
  int16_t light_group = kNoLightGroup;
  RayMask seen_by = kAllRays;
  bool from_world = false;
  float rounding = 0;  // of an emissive surface's place (rounding_of()), m
  int32_t exact = -1;  // a lamp's emitter that lies in a surface: see Lights::blocked_exactly()
  Vec3 place;          // on it
};

}  // namespace photon_splat
