// What splatting kernels are told of a block beforehand.
#pragma once

#include <vector>

#include "density/point_block.h"

namespace photon_splat {

// The parts of a block: of each 16 neighbours those that catch something, surface by surface.
std::vector<SplatPart> parts_of(const PointBlock& block);

}  // namespace photon_splat
