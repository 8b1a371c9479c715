// Means over windows of a picture.
#pragma once

#include <cstddef>
#include <vector>

#include "util/parallel.h"

namespace photon_splat {

// Means over the square of 2r + 1 pixels around each one, cut off at the picture's border; never
// below 0. `in` holds rows of `width` values. The same for any number of threads.
void blur(const std::vector<float>& in, int width, int height, int r, std::vector<float>& out,
          ThreadPool& pool);

}  // namespace photon_splat
