// Places on what moves, now and at the shutter's centre.
#pragma once

#include <array>

#include "math/vec.h"

namespace photon_splat {

// Where an instance is at some time.
struct Pose {
  Affine to_world, to_local;
};

// How a triangle turns on its way from one place to another.
class Turn {
 public:
  Turn(const Vec3 from[3], const Vec3 to[3]) : from_(axes(from)), to_(axes(to)) {}
  Vec3 operator()(const Vec3& d) const {
    return to_[0] * dot(from_[0], d) + to_[1] * dot(from_[1], d) + to_[2] * dot(from_[2], d);
  }

 private:
  static std::array<Vec3, 3> axes(const Vec3 corner[3]) {
    const Vec3 x = normalize(corner[1] - corner[0]), z = normalize(cross(x, corner[2] - corner[0]));
    return {x, cross(z, x), z};
  }
  std::array<Vec3, 3> from_, to_;
};

// A point of a moving surface as it is at the shutter's centre, where photons and points meet.
struct PlaceAtRest {
  Vec3 position, ng;  // on the side of the surface it was made of
  float area;         // of the surface there, over that where it is now
  Turn turn;          // of directions
};

}  // namespace photon_splat
