// From where in the sky photons that are aimed come: learnt from a pilot, as of what a window's
// pane sees of it most may shine on walls first.
#pragma once

#include <array>

#include "math/sampling.h"

namespace photon_splat {

// A histogram over the numbers that the world's directions are drawn by.
class WayGuide {
 public:
  // A photon drawn by `way` was of so much use.
  void learn(const Vec2& way, double useful);
  // Cells are drawn by the root of the mean use from now on, or uniformly.
  void finish();
  // Draws `way`, uniform before, anew; `u` picks the cell. Returns its density, relative to
  // uniform.
  float warp(Vec2& way, float u) const;

 private:
  static constexpr int kCells = 16;         // per axis
  static constexpr double kUnguided = 0.2;  // share of the uniform density
  static constexpr int kAll = kCells * kCells;

  std::array<float, kAll> useful_{}, paths_{};
  std::array<float, kAll> cdf_{};  // its end 0: nothing learnt
};

}  // namespace photon_splat
