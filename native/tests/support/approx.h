// doctest's Approx adds 1 to what its epsilon is a share of: .epsilon(0.02) of 0.1 lets 22 % pass.
// Here it is a share of the values themselves, and of 1e-3 where they are less than that;
// .scale(1) where they are near 0 by chance.
#pragma once

#include <doctest/doctest.h>

namespace photon_splat {

inline doctest::Approx approx(double value) {
  doctest::Approx out(value);
  out.scale(1e-3);
  return out;
}

}  // namespace photon_splat
