// Lenses that see more than a plane: the whole picture as a map of directions.
#pragma once

#include <array>
#include <optional>

#include "math/sampling.h"

namespace photon_splat {

enum class PanoramaKind {
  kNone,
  kEquirectangular,
  kEquiangularCubeFace,
  kMirrorBall,
  kFisheyeEquidistant,
  kFisheyeEquisolid,
  kFisheyePolynomial,
  kCentralCylindrical
};

// Angles in radians; which fields count depends on the kind.
struct PanoramaSettings {
  PanoramaKind kind = PanoramaKind::kNone;
  // equirectangular
  float longitude_min = -kPi, longitude_max = kPi, latitude_min = -kPi / 2, latitude_max = kPi / 2;
  // fisheyes: full angle; beyond it nothing is seen
  float fov = kPi;
  float focal_length = 10.5f;  // mm, equisolid
  // mm, of the whole frame: equisolid and polynomial
  float sensor_width = 36, sensor_height = 36;
  // -angle to the axis in powers of the distance from the centre in mm
  std::array<float, 5> polynomial{};
  float u_min = -kPi, u_max = kPi, v_min = -1, v_max = 1;  // cylinder of radius 1: angles, heights
};

// Direction (unit, camera space: looks along -Z, +Y up) seen at (u, v) of the whole frame, 0..1
// from its lower left corner and beyond for a pixel filter. nullopt where the lens sees nothing.
std::optional<Vec3> panorama_direction(const PanoramaSettings& settings, float u, float v);

// Its inverse: where a direction (unit) is seen, or would be if the lens reached so far.
Vec2 panorama_place(const PanoramaSettings& settings, const Vec3& direction);

}  // namespace photon_splat
