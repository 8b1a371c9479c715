// Tabulated densities of one variable.
#pragma once

#include "math/sampling.h"

#include <vector>

namespace photon_splat {

inline constexpr int kTableSize = 256;

// Cumulative table of a density over [low, high]; the last entry is its integral.
template <class Density>
std::vector<float> tabulate(float low, float high, Density density) {
  std::vector<float> cdf(kTableSize);
  double sum = 0;
  const float step = (high - low) / kTableSize;
  for (int i = 0; i < kTableSize; ++i) {
    // A floor keeps every place that may emit reachable; the exact weight of a sample makes good
    // for it.
    const float value = density(low + (static_cast<float>(i) + 0.5f) * step);
    sum += std::max(value, 1e-4f) * step;
    cdf[i] = static_cast<float>(sum);
  }
  return cdf;
}

struct TableSample {
  float value, pdf;
};

inline TableSample sample_table(const std::vector<float>& cdf, float low, float high, float u) {
  const float target = u * cdf.back();
  size_t bin = std::upper_bound(cdf.begin(), cdf.end(), target) - cdf.begin();
  bin = std::min(bin, cdf.size() - 1);
  const float before = bin ? cdf[bin - 1] : 0, share = cdf[bin] - before;
  const float step = (high - low) / static_cast<float>(cdf.size());
  const float inside = std::clamp((target - before) / share, 0.0f, 1.0f);
  return {low + (static_cast<float>(bin) + inside) * step, share / (cdf.back() * step)};
}

// Density at `value`; 0 outside.
inline float table_pdf(const std::vector<float>& cdf, float low, float high, float value) {
  if (!(value >= low) || value > high) return 0;
  const float size = static_cast<float>(cdf.size()), step = (high - low) / size;
  const size_t bin = std::min(static_cast<size_t>((value - low) / step), cdf.size() - 1);
  return (cdf[bin] - (bin ? cdf[bin - 1] : 0)) / (cdf.back() * step);
}

}  // namespace photon_splat
