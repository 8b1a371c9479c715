// Where photons start: learnt from pilots, so that they reach what the camera sees through windows
// and key-holes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
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
  uint32_t cell = 0;  // of the guide that it was drawn by
};

// The hypercube of each emitter, cut where the use of paths differs into cells as small as there
// are useful ones to tell apart. Cells are drawn with density ~ sqrt(mean use of a path from
// there), which minimises the variance, mixed with the unguided density so that none is ever left
// out. The tree is that of adaptive Monte Carlo integration (Friedman and Wright, A nested
// partitioning procedure for numerical multiple optimization, 1981), its criterion what a cut saves
// of the standard deviation.
class EmissionGuide {
 public:
  // Power of each emitter, W: unguided, they are drawn in proportion.
  explicit EmissionGuide(std::vector<double> powers);

  // A path of a pilot, drawn as the guide draws now: unguided before the first finish(). Use goes
  // with the square of power.
  void learn(const EmissionPrimary& path, double useful);
  // Draws by all that was learnt from now on. More may be learnt then, which cuts the cells
  // further.
  void finish();

  // Replaces emitter, place and way of an unguided sample by guided ones; `u` picks emitter and
  // cell.
  void warp(EmissionPrimary& sample, const Vec2& u) const;

  size_t cells() const { return cells_.size(); }

 private:
  using Point = std::array<float, 4>;       // place, way
  static constexpr double kUnguided = 0.3;  // share of the unguided density

  struct Sample {
    Point at;
    uint32_t cell;
    float useful;
  };
  struct Cell {
    Point low{0, 0, 0, 0}, high{1, 1, 1, 1};
    double mean = 0;  // use of a path from here
    double volume() const;
  };
  struct Cut {
    int axis = -1;
    float at;
    double low, high;  // means of the parts
  };

  static Cut best_cut(std::span<const Sample> samples, const Cell& cell);
  void divide(std::span<Sample> samples, const Cell& cell);

  std::vector<double> powers_;
  double all_power_ = 0;
  std::vector<Sample> samples_;
  std::vector<double> emitter_cdf_;
  std::vector<double> emitter_density_;  // probability of an emitter
  // Of all emitters, one after the other
  std::vector<Cell> cells_;
  std::vector<double> cell_cdf_;  // cumulative in each emitter
  std::vector<uint32_t> first_;   // cell of each emitter, and the end
};

}  // namespace photon_splat
