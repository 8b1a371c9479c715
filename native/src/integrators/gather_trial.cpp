#include "integrators/gather_trial.h"

#include <algorithm>

#include "render/cost_model.h"

namespace photon_splat {
namespace {

constexpr double kDark = 1e-4;          // squared luminance that errors are not measured against
constexpr double kMost = 2;             // of a squared relative difference: specks count no more
constexpr double kMostBesideTile = 64;  // of a variance beside the squared light of a tile
// Times the work of paths that end at photons, from which on photons are worth theirs and their
// blur: on seventeen scenes ratios below 1.5 and above 2.8 told which way had less error in equal
// time
constexpr double kWorthPhotons = 2;

}  // namespace

void GatherTrial::add_pair(float light, float deep, float other_light, float other_deep) {
  const double mean = 0.5 * (double(light) + other_light), difference = double(light) - other_light;
  const double shallow = difference - (double(deep) - other_deep);
  const double scale = 0.5 / (mean * mean + kDark);
  if (!(difference * difference * scale < 1e30)) return;
  noise_ += std::min(difference * difference * scale, kMost);
  shallow_noise_ += std::min(shallow * shallow * scale, kMost);
}

void GatherTrial::add_pixel(double all, double shallow) {
  if (!(scale_ > 0) || !(all * scale_ < 1e30)) return;
  all_ += std::min(all * scale_, kMostBesideTile);
  shallow_ += std::min(shallow * scale_, kMostBesideTile);
}

void GatherTrial::begin_tile(double light) {
  scale_ = light < 1e15 ? 1 / (light * light + kDark) : 0;
}

void GatherTrial::add(const GatherTrial& other) {
  noise_ += other.noise_;
  shallow_noise_ += other.shallow_noise_;
  all_ += other.all_;
  shallow_ += other.shallow_;
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

bool GatherTrial::paths_beat_density() const {
  const double by_paths = all_ * static_cast<double>(rays_);
  const double by_photons =
      cost::kGatherPointRay * shallow_ * static_cast<double>(rays_ - deep_rays_);
  return by_paths < kWorthPhotons * by_photons;
}

}  // namespace photon_splat
