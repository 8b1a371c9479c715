// Visible points, block by block.
#pragma once

#include "density/point_block.h"
#include "util/large_pages.h"

namespace photon_splat {

using PointBlocks = LargeArray<PointBlock>;

}  // namespace photon_splat
