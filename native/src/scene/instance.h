// A mesh that stands in the scene.
#pragma once

#include <array>

#include "math/vec.h"
#include "shading/program.h"

namespace photon_splat {

// Light groups are numbers from 0; this is the light of none.
inline constexpr int16_t kNoLightGroup = -1;

// A mesh that stands once in the scene is held in world coordinates (`shared` false, to_world =
// identity); others are Embree instances, and so is what a transform moves. Of what moves all here
// is that of the shutter's centre.
struct Instance {
  uint32_t mesh = 0;
  int32_t motion = -1;  // into Scene::motions, of to_world; -1: it stays where it is
  bool moves = false;   // so, or its mesh changes its shape
  bool shared = false;
  // The transform flips the winding; the front stays where Blender has it
  bool mirrored = false;
  uint32_t first_material = 0;  // into Scene::slot_materials
  uint32_t slot_count = 1;
  uint32_t seed = 0;                   // of surface keys
  uint64_t group = 1;                  // of light linking: a single bit
  uint64_t lit_groups = ~uint64_t{0};  // what it lights if it shines
  uint64_t blockers = ~uint64_t{0};    // what casts shadows in its light
  int16_t light_group = kNoLightGroup;
  RayMask seen_by = kAllRays;
  bool holdout = false;  // to the camera a hole in the picture
  bool layered = false;  // lets light pass and lies in another surface to within rounding
  bool catcher = false;  // shows the camera what other things take from its light, and no more
  // Cosine below which shadow rays start off the surface that smooth normals promise
  float terminator_offset = 0.1f;
  float scale = 1;  // largest stretch of to_world
  // Factor on the coefficients of its medium
  float density = 1;
  Affine to_world, to_local;
  std::array<double, 12> exact{};  // to_world before rounding
};

}  // namespace photon_splat
