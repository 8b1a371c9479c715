// What a ray has found, and where rays start from it.
#pragma once

#include "math/vec.h"
#include "scene/material.h"
#include "shading/program.h"

namespace photon_splat {

// A point on a surface as a ray found it. Normals are unit length and on the side the ray came
// from.
struct Surface {
  Vec3 position, ng, ns;
  uint32_t instance, triangle;
  uint32_t key;  // hash of instance, patch and side
  bool back;
  float u, v;  // barycentric
  float distance;
  float rounding = 0;  // of where it is, as far as its triangle is to blame
  uint32_t mark;       // of the strand that it is on, as Embree takes it; 0: of a mesh
  const MaterialSide* side;
  const Program* program;  // or null: then `side` says it all

  // On strands ng is ns, `back` is never set and `triangle` is a segment; photons are not stored
  // there.
  bool on_strand() const { return mark != 0; }
};

// Places this close to `position`, found `distance` away, are the same but for rounding, whoever
// has computed them.
inline float ray_epsilon(const Vec3& position, float distance) {
  return 4e-6f * std::max(max_abs(position), distance);
}
// How far off its surface a ray starts: past the rounding error of the hit, and no further, as
// light would leak where surfaces run into each other. Eight times as much made a lamp that apples
// hide shine out along the seams of drops on them, 11 % of the picture's light.
inline float ray_offset(const Vec3& position, float distance) {
  return 0.125f * ray_epsilon(position, distance);
}
inline float ray_offset(const Surface& s) {
  return std::max(ray_offset(s.position, s.distance), s.rounding);
}
// Where a ray starts that leaves `s` that way. On strands no distance is far enough: rays that
// leave one do not meet it (Surface::mark).
inline Vec3 leave(const Surface& s, const Vec3& direction) {
  if (s.on_strand()) return s.position;
  return s.position + s.ng * std::copysign(ray_offset(s), dot(direction, s.ng));
}
// Where the ray goes on that found `s` and takes no notice of it.
inline float past(const Surface& s) { return std::nextafter(s.distance + ray_offset(s), INFINITY); }

// The stretch of a ray on which surfaces are at the same place as the one that it goes through, but
// for rounding, in whatever order it meets them.
struct Gap {
  Vec3 origin, direction;
  float near, far;
  float at;  // where that one is
};
// Of the ray that found `s` and goes straight on.
inline Gap gap_at(const Surface& s, const Vec3& origin, const Vec3& direction) {
  const float epsilon = std::max(ray_epsilon(s.position, s.distance), s.rounding);
  return {origin, direction, s.distance - epsilon, s.distance + epsilon, s.distance};
}
// Of the ray that starts anew, from leave(s, direction).
inline Gap gap_beside(const Surface& s, const Vec3& direction) {
  const float side = std::copysign(1.0f, dot(direction, s.ng));
  return {s.position, s.ng * side, 0, ray_offset(s), 0};
}

}  // namespace photon_splat
