// Whether camera paths are to bring all of the indirect light, or photons a part of it: what comes
// from beyond the first place that paths go on from (final gathering), or all that comes to the
// first diffuse surface.
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
  // Counts the rays of `paths` camera paths; `deep`: rays for light that photons would bring.
  void add_rays(uint64_t paths, uint64_t rays, uint64_t deep) {
    paths_ += paths, rays_ += rays, deep_rays_ += deep;
  }
  // Mean luminance of the tile that the next pixels are of.
  void begin_tile(double light);
  // Variance of one sample of a pixel's luminance, of all of it and without what photons bring.
  void add_pixel(double all, double shallow);
  // A pixel's luminance and that of a neighbour, `deep` the part of it that photons would bring.
  void add_pair(float light, float deep, float other_light, float other_deep);
  void add(const GatherTrial& other);

  // Whether paths reach the same noise for less work than final gathering. `photon_paths`: of a
  // pass that ends paths at photons, for each of its camera paths.
  bool paths_pay(double photon_paths) const;
  // Whether photons at the first diffuse surface would take so little off the noise of paths that
  // they are not worth their own work and blur.
  bool paths_beat_density() const;

 private:
  double noise_ = 0, shallow_noise_ = 0;  // sums of squared relative differences
  double all_ = 0, shallow_ = 0;          // sums of variances beside the squared light of tiles
  double scale_ = 0;                      // of the tile
  uint64_t paths_ = 0, rays_ = 0, deep_rays_ = 0;
};

}  // namespace photon_splat
