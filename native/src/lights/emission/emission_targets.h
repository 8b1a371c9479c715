// Spheres that photons are aimed at, so that a small glass in a big room gets its caustic.
#pragma once

#include <vector>

#include "lights/emission/way_guide.h"

namespace photon_splat {

struct PhotonStart;

// What PhotonEmitter::aim_at makes and PhotonEmitter::emit_towards draws from: a mixture of the
// lights' natural emission and, for every pair of an emitter and a target, emission into what the
// target fills of the emitter's view. Pairs are drawn in proportion to the power that passes from
// one to the other, times the target's weight.
class EmissionTargets {
 public:
  struct Sphere {
    Vec3 center;
    float radius;      // m, positive
    float weight = 1;  // photons wanted there per power that arrives, relative to the other targets
  };

  size_t size() const { return spheres_.size(); }
  const Sphere& sphere(size_t i) const { return spheres_[i]; }

  // A path that began with `start` was of so much use: the squares of what its photons kept of its
  // power, say. It counts for the smallest target on its way, whichever it was aimed at. After
  // finish(), pairs are drawn by the root of the mean use of their paths as well (with squares:
  // what makes the variance of the sum least), none less than a hundredth of its share before. So
  // are the directions that the world's light comes from; `way`: the numbers that drew it.
  void learn(const PhotonStart& start, const Vec2& way, double useful);
  void finish();

 private:
  friend class PhotonEmitter;
  struct Pair {
    uint32_t emitter, target;
    double flux;  // about W from one to the other, times the target's weight
    float probability = 0;
    float paths = 0, useful = 0;
  };
  void distribute(const std::vector<double>& wishes);
  double natural_share() const { return pairs_.empty() ? 1 : natural_share_; }

  std::vector<Sphere> spheres_;
  double natural_share_ = 0.125;
  std::vector<Pair> pairs_;           // by emitter
  std::vector<uint32_t> first_pair_;  // of each emitter, and the end
  std::vector<double> pair_cdf_;
  WayGuide world_ways_;
};

}  // namespace photon_splat
