// Whether camera paths are to bring all of the indirect light, or photons what comes from beyond
// the first place that paths go on from.
#pragma once

#include <cstdint>

namespace photon_splat {

// What some paths that bring all of it have found. Photons bring their part next to free of noise,
// but they must be traced, and paths that end at them need gather points, points and a guide to the
// world; paths that go on need their own rays. A sum of noise and cost for each way, from the
// differences between neighbours in the picture: the noise of paths, next to what it were without
// that part.
class GatherTrial {
 public:
  // Of `paths` camera paths their rays; `deep`: those for light from beyond.
  void add_rays(uint64_t paths, uint64_t rays, uint64_t deep) {
    paths_ += paths, rays_ += rays, deep_rays_ += deep;
  }
  // A pixel's luminance and that of a neighbour, `deep` the part of it from beyond.
  void add_pair(float light, float deep, float other_light, float other_deep);
  void add(const GatherTrial& other);

  // Whether paths reach the same noise for less work. `photon_paths`: of a pass that ends paths at
  // photons, for each of its camera paths.
  bool paths_pay(double photon_paths) const;

 private:
  double noise_ = 0, shallow_noise_ = 0;  // sums of squared relative differences
  uint64_t paths_ = 0, rays_ = 0, deep_rays_ = 0;
};

}  // namespace photon_splat
