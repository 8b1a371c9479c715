// The visible points of a layer, block by block.
#pragma once

#include "large_pages.h"
#include "point_block.h"

namespace photon_splat {

using PointBlocks = LargeArray<PointBlock>;

}  // namespace photon_splat
