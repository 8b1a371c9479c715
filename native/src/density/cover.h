// What lies, or hovers, close over a place on a surface and keeps photons off it.
#pragma once

#include <optional>

#include "math/sampling.h"
#include "scene/scene.h"

namespace photon_splat {

// What is closer over the surface than this, in disc radii h, keeps photons off it.
constexpr float kCover = 0.12f;

// What lies close over y is looked for from kCover * h above it, down to just before the surface:
// so far. Not over 0: rounding leaves nothing to look at.
float length_of_look(const Vec3& y, float h);

// What keeps photons from a place, or gives it light that no other one has.
struct Cover {
  bool shines;
  bool back;  // is met: the look has begun inside of it, as in a wall, which is higher than a cover
  uint32_t key;  // of the surface
  bool parts() const { return shines || back; }
};
std::optional<Cover> cover_of(const Scene& scene, RayMask kinds, const Vec3& y, const Vec3& normal,
                              float h);

enum class FromRim { kNone, kStraight, kThrown };
// Whether light comes in from the rim of the cover of y, straight or thrown to and fro in the gap
// below it: by one path, so that the mean tells how much.
FromRim light_from_rim(const Scene& scene, RayMask kinds, const Vec3& y, const Vec3& normal,
                       float h, Random& random);

}  // namespace photon_splat
