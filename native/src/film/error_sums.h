// What is known of a film's errors, as sums that those of other films of the same picture are added
// to.
#pragma once

#include <vector>

namespace photon_splat {

// Per pixel, of luminances. Films are independent of each other, and each is weighed by its
// samples: the mean of all has the variance sum(variance s^2) / (sum s)^2.
struct ErrorSums {
  std::vector<float> variance;  // of the film's mean, times the square of its samples
  // The square of the film's sum over its samples, in two floats: a small difference is what counts
  std::vector<float> square, square_rest;
  std::vector<float> detail, detail_squares;  // sums over passes, each its mean
};

}  // namespace photon_splat
