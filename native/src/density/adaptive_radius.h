// Kernel radii from what the passes before have shown: narrow where discs of two sizes disagree,
// wide where they do not.
#pragma once

#include <array>
#include <vector>

#include "util/parallel.h"

namespace photon_splat {

// Per pixel a factor on the radius. From the passes since the last choice, d = (estimate of disc h)
// - (of h/sqrt(2)) tells bias^2 ~ 4 (mean(d)^2 - var(d)/n), and its variance over passes is half of
// that of the estimate itself (Epanechnikov kernel); the mean squared error is least where bias^2 =
// variance/2, both going as h^4 and h^-2. Choices are made after pass 4, 8, 16, ... and are for the
// passes that follow: photons never judge themselves.
class AdaptiveRadius {
 public:
  // `parts` such renders make the picture together.
  void reset(int width, int height, uint32_t parts = 1);
  // What is known of a pixel: its factor, and sums since the last choice of d and of its square.
  using Known = std::array<float, 3>;
  std::vector<Known> known() const;
  // Where an earlier generation has stopped after `passes`: counts once begin_part() is called.
  void go_on(std::vector<Known> known, uint32_t passes);
  // After the passes that parts have in common.
  void begin_part();
  // What d adds to each pixel's luminance in this pass; written by the renderer, then taken by
  // end_pass().
  std::vector<float>& detail() { return detail_; }
  void end_pass(ThreadPool& pool);
  const std::vector<float>& factors() const { return factors_; }

 private:
  void choose(ThreadPool& pool);

  int width_ = 0, height_ = 0;
  uint32_t passes_ = 0, since_ = 0;  // in all; at the last choice
  uint32_t parts_ = 1, before_ = 0;
  std::vector<Known> earlier_;  // of an earlier generation of `before_` passes
  std::vector<float> detail_, sum_, squares_, factors_;
};

}  // namespace photon_splat
