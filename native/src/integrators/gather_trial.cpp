#include "integrators/gather_trial.h"

#include <algorithm>

#include "render/cost_model.h"

namespace photon_splat {
namespace {

constexpr double kDark = 1e-4;  // squared luminance that errors are not measured against
constexpr double kMost = 2;     // of a squared relative difference: specks count no more

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
  const double by_photons = cost::kGatherRay * static_cast<double>(rays_ - deep_rays_) +
                            cost::kPhotonPath * photon_paths * static_cast<double>(paths_);
  return noise_ * by_paths < shallow_noise_ * by_photons;
}

}  // namespace photon_splat
