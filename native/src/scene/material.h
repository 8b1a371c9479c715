// What surfaces and the world are made of, where no node program says it.
#pragma once

#include "math/sampling.h"
#include "math/vec.h"

namespace photon_splat {

// One side of a surface; albedo and emission are multiplied by their texture where there is one.
struct MaterialSide {
  Rgb albedo{0.8f, 0.8f, 0.8f}, emission{};  // emission: radiance, W/m^2/sr
  int albedo_texture = -1, emission_texture = -1;
};

struct Material {
  MaterialSide front, back;
  int program = -1;  // into Scene::programs: then the sides are not read
  int volume = -1;   // the same of the medium behind the surface; -1: none
};

// An image of the world, lit by every direction.
struct WorldMap {
  int texture = -1;
  bool mirror_ball = false;  // else equirectangular
  Affine to_lookup;          // of a direction, before it is looked up
};

// The sun of a sky: a disc with limb darkening, its radiance between that of its lower and that of
// its upper edge.
struct SunDisc {
  Vec3 direction;  // towards it
  float half_angle = 0;
  Rgb bottom{}, top{};
  float horizon = -kPi;  // elevation below which nothing is seen of it
};

// Such a disc as it is looked up.
struct SunCone {
  explicit SunCone(const SunDisc& of);
  bool contains(const Vec3& d) const { return length2(d - towards) <= 2 * one_minus_cos; }
  Rgb radiance(const Vec3& d) const;

  SunDisc sun;
  Vec3 towards;
  float one_minus_cos, low, high;  // elevations of its lower and its upper edge
};

}  // namespace photon_splat
