#pragma once

#include "lights/lamp.h"
#include "lights/mesh_light.h"
#include "math/spherical_triangle.h"

namespace photon_splat {

// A lamp of a few triangles, seen from a place.
struct CloseLight {
  static constexpr int kMost = 4;
  struct Place {
    int triangle;
    Vec3 direction, normal;
    float distance, u, v;
    float pdf;  // solid angle
  };
  int count = 0;
  Vec3 corner[kMost][3];  // relative to the place
  SphericalTriangle seen[kMost];
  bool by_cosine = false;
  float cosine[kMost][3];  // at the corners, by_cosine, and not less than a little
  float share[kMost];      // of the samples, not normalised
  float total = 0;         // of those: solid angle, sr, or times the cosine
  // Adds a triangle; false if it is too small to be seen precisely.
  bool add(const Vec3& a, const Vec3& b, const Vec3& c);
  void weigh_by_cosine(const Vec3& ns);
  bool sample(Vec2 u, Place& out) const;
};

// From further off all of a light looks alike.
bool is_close(const Vec3& center, float radius, const Vec3& x);
// Sees the lamp or the mesh from the place; false where it is to be sampled by area. `out` is new.
bool see_close(const Lamp& lamp, const Receiver& to, CloseLight& out);
bool see_close(const MeshLight& mesh, const Receiver& to, CloseLight& out);

}  // namespace photon_splat
