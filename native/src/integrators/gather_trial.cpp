#include "integrators/gather_trial.h"

#include <algorithm>

namespace photon_splat {
namespace {

constexpr double kDark = 1e-4;  // squared luminance that errors are not measured against
constexpr double kMost = 2;     // of a squared relative difference: specks count no more
// Work in camera rays with their shading, measured on street and kitchen.
// One of a path that ends at photons, with its part of records and points
constexpr double kGatherRay = 1.5;
constexpr double kPhotonPath = 4.5;  // a photon path, with its part of boundaries

}  // namespace

void GatherTrial::add_pair(float light, float deep, float other_light, float other_deep) {
  const double mean = 0.5 * (double(light) + other_light), difference = double(light) - other_light;
  const double shallow = difference - (double(deep) - other_deep);
  const double scale = 0.5 / (mean * mean + kDark);
  if (!(difference * difference * scale < 1e30)) return;
  noise_ += std::min(difference * difference * scale, kMost);
  shallow_noise_ += std::min(shallow * shallow * scale, kMost);
}

void GatherTrial::add(const GatherTrial& other) {
  noise_ += other.noise_;
  shallow_noise_ += other.shallow_noise_;
  paths_ += other.paths_;
  rays_ += other.rays_;
  deep_rays_ += other.deep_rays_;
}

bool GatherTrial::paths_pay(double photon_paths) const {
  const double by_paths = static_cast<double>(rays_);
  const double by_photons = kGatherRay * static_cast<double>(rays_ - deep_rays_) +
                            kPhotonPath * photon_paths * static_cast<double>(paths_);
  return noise_ * by_paths < shallow_noise_ * by_photons;
}

}  // namespace photon_splat
