#include "lights/emission/way_guide.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "math/sampling.h"

namespace photon_splat {

void WayGuide::learn(const Vec2& way, double useful) {
  const auto index = [](float u) {
    return std::clamp(static_cast<int>(u * static_cast<float>(kCells)), 0, kCells - 1);
  };
  const int cell = index(way.x) * kCells + index(way.y);
  paths_[cell] += 1;
  useful_[cell] += static_cast<float>(useful);
}

void WayGuide::finish() {
  cdf_ = {};
  const double found = std::accumulate(useful_.begin(), useful_.end(), 0.0),
               tried = std::accumulate(paths_.begin(), paths_.end(), 0.0);
  if (!(found > 0) || !std::isfinite(found)) return;
  const double mean = found / tried;
  // Each cell's mean is drawn towards that of all by as much as one path weighs.
  std::array<double, kAll> wish;
  for (int c = 0; c < kAll; ++c) wish[c] = std::sqrt((useful_[c] + mean) / (paths_[c] + 1.0));
  const double sum = std::accumulate(wish.begin(), wish.end(), 0.0);
  double running = 0;
  for (int c = 0; c < kAll; ++c)
    cdf_[c] = static_cast<float>(running += kUnguided / kAll + (1 - kUnguided) * wish[c] / sum);
}

float WayGuide::warp(Vec2& way, float u) const {
  if (!(cdf_.back() > 0)) return 1;
  const int c = std::min(
      static_cast<int>(std::upper_bound(cdf_.begin(), cdf_.end(), u * cdf_.back()) - cdf_.begin()),
      kAll - 1);
  const auto inside = [](int cell, float f) {
    return std::min((static_cast<float>(cell) + f) / static_cast<float>(kCells), kBelowOne);
  };
  way = {inside(c / kCells, way.x), inside(c % kCells, way.y)};
  return (cdf_[c] - (c ? cdf_[c - 1] : 0)) / cdf_.back() * static_cast<float>(kAll);
}

}  // namespace photon_splat
