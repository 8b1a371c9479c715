// Triangles that can be rendered.
#pragma once

#include <span>

#include "geometry/topology.h"

namespace photon_splat {

// Whether the cross products of all triangles have a component other than 0, and finite ones alone.
// Throws std::invalid_argument for vertices that do not exist.
bool all_have_area(std::span<const Vec3> positions, std::span<const Triangle> triangles);

}  // namespace photon_splat
