// Where photons start: learnt from a pilot, so that they reach what the camera sees through windows
// and key-holes.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/motion.h"
#include "math/sampling.h"

namespace photon_splat {

// Where in the unit hypercube of emission a photon starts: which emitter, where on it, which way.
struct EmissionPrimary {
  uint32_t emitter;
  Vec2 pick;  // of the emitter (x) and of its triangle (y)
  Vec2 place, way;
  float weight = 1;  // one over the density relative to unguided emission
  float time = kShutterCentre;
};

// A histogram over the hypercube of each emitter. Cells are drawn with density ~ sqrt(mean useful
// photons of a path from there), which minimises the variance, mixed with the unguided density so
// that none is ever left out.
class EmissionGuide {
 public:
  // How an emitter's cells divide place and way, per axis: 4096 as 8 x 8 each, or all of them for
  // the one that matters. All emitters have equally many.
  struct Division {
    int place = 8, way = 8;
  };
  EmissionGuide(std::vector<double> powers, std::vector<Division> divisions);

  void learn(const EmissionPrimary& path, double useful);
  void finish();

  // Replaces emitter, place and way of an unguided sample by guided ones; `u` picks emitter and
  // cell.
  void warp(EmissionPrimary& sample, const Vec2& u) const;

 private:
  static constexpr double kUnguided = 0.2;  // share of the unguided density

  int cell_of(uint32_t emitter, const Vec2& place, const Vec2& way) const;

  std::vector<double> powers_;
  double all_power_ = 0;
  int cells_ = 1;
  std::vector<Division> divisions_;
  std::vector<float> useful_, paths_;  // per emitter and cell
  std::vector<double> emitter_cdf_;
  std::vector<double> emitter_density_;  // probability of an emitter
  std::vector<float> cell_cdf_;          // per emitter, cumulative
};

}  // namespace photon_splat
