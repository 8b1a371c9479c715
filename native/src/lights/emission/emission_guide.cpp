#include "lights/emission/emission_guide.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace photon_splat {
namespace {

constexpr int kBins = 8;        // a cut falls between two
constexpr size_t kFewest = 16;  // paths of a cell that is cut
// A cut must save this share of the standard deviation, and this over the number of useful paths,
// as chance alone makes parts differ
constexpr double kLeastGain = 0.003, kChance = 0.5;
constexpr float kThinnest = 0x1p-18f;  // part of an axis: numbers inside have bits left

}  // namespace

EmissionGuide::EmissionGuide(std::vector<double> powers)
    : powers_(std::move(powers)), cells_(powers_.size()), first_(powers_.size() + 1) {
  all_power_ = std::accumulate(powers_.begin(), powers_.end(), 0.0);
  std::iota(first_.begin(), first_.end(), 0u);
}

double EmissionGuide::Cell::volume() const {
  double v = 1;
  for (int a = 0; a < 4; ++a) v *= static_cast<double>(high[a]) - low[a];
  return v;
}

void EmissionGuide::learn(const EmissionPrimary& path, double useful) {
  // Unguided paths know no cells
  const uint32_t cell = cell_cdf_.empty() ? path.emitter : path.cell;
  samples_.push_back({{path.place.x, path.place.y, path.way.x, path.way.y},
                      cell,
                      static_cast<float>(useful / (double(path.weight) * path.weight))});
}

// The one that saves most, where any is worth it. Each part's mean is drawn towards the cell's by
// as many paths as it takes to find one that is useful: that none was among fewer says little.
EmissionGuide::Cut EmissionGuide::best_cut(std::span<const Sample> samples, const Cell& cell) {
  double sum = 0, squares = 0;
  for (const Sample& s : samples) sum += s.useful, squares += double(s.useful) * s.useful;
  Cut best;
  if (samples.size() < kFewest || !(squares > 0) || !std::isfinite(squares)) return best;
  const double useful_paths = sum * sum / squares;
  const double prior = static_cast<double>(samples.size()) / useful_paths;
  double most = std::max(kLeastGain, kChance / useful_paths);
  for (int axis = 0; axis < 4; ++axis) {
    const float low = cell.low[axis], width = cell.high[axis] - low;
    if (width < kThinnest) continue;
    double found[kBins] = {}, tried[kBins] = {};
    for (const Sample& s : samples) {
      const int bin =
          std::clamp(static_cast<int>((s.at[axis] - low) / width * kBins), 0, kBins - 1);
      found[bin] += s.useful, tried[bin] += 1;
    }
    double below = 0, paths_below = 0;
    for (int k = 1; k < kBins; ++k) {
      below += found[k - 1], paths_below += tried[k - 1];
      const double share = static_cast<double>(k) / kBins,
                   above_mean = (sum - below + prior * cell.mean) /
                                (static_cast<double>(samples.size()) - paths_below + prior),
                   below_mean = (below + prior * cell.mean) / (paths_below + prior);
      const double gain =
          1 - (share * std::sqrt(below_mean) + (1 - share) * std::sqrt(above_mean)) /
                  std::sqrt(cell.mean);
      if (gain <= most) continue;
      most = gain;
      best = {axis, low + width * static_cast<float>(share), below_mean, above_mean};
    }
  }
  return best;
}

void EmissionGuide::divide(std::span<Sample> samples, const Cell& cell) {
  const Cut cut = best_cut(samples, cell);
  if (cut.axis < 0) {
    for (Sample& s : samples) s.cell = static_cast<uint32_t>(cells_.size());
    cells_.push_back(cell);
    return;
  }
  const auto middle = std::partition(samples.begin(), samples.end(),
                                     [&](const Sample& s) { return s.at[cut.axis] < cut.at; });
  const size_t below = static_cast<size_t>(middle - samples.begin());
  Cell low = cell, high = cell;
  low.high[cut.axis] = high.low[cut.axis] = cut.at;
  low.mean = cut.low, high.mean = cut.high;
  divide(samples.first(below), low);
  divide(samples.subspan(below), high);
}

void EmissionGuide::finish() {
  const size_t emitters = powers_.size();
  std::stable_sort(samples_.begin(), samples_.end(),
                   [](const Sample& a, const Sample& b) { return a.cell < b.cell; });
  const bool first_time = cell_cdf_.empty();
  const std::vector<Cell> coarse = std::move(cells_);
  const std::vector<uint32_t> first = first_;
  cells_.clear();
  size_t begin = 0;
  for (size_t e = 0; e < emitters; ++e) {
    first_[e] = static_cast<uint32_t>(cells_.size());
    for (uint32_t c = first[e]; c < first[e + 1]; ++c) {
      size_t end = begin;
      double found = 0;
      for (; end < samples_.size() && samples_[end].cell == c; ++end) found += samples_[end].useful;
      Cell cell = coarse[c];
      const double tried = static_cast<double>(end - begin);
      // What was thought before weighs as much as one path
      if (!first_time || end > begin)
        cell.mean = first_time ? found / tried : (found + cell.mean) / (tried + 1);
      divide({samples_.begin() + begin, samples_.begin() + end}, cell);
      begin = end;
    }
  }
  first_[emitters] = static_cast<uint32_t>(cells_.size());
  std::vector<double> emitter_wish(emitters);
  cell_cdf_.resize(cells_.size());
  double wishes = 0;
  for (size_t e = 0; e < emitters; ++e) {
    double sum = 0;
    for (uint32_t c = first_[e]; c < first_[e + 1]; ++c)
      sum += cells_[c].volume() * std::sqrt(cells_[c].mean);
    double running = 0;
    for (uint32_t c = first_[e]; c < first_[e + 1]; ++c) {
      const double volume = cells_[c].volume();
      const double wish = sum > 0 ? volume * std::sqrt(cells_[c].mean) / sum : volume;
      cell_cdf_[c] = running += kUnguided * volume + (1 - kUnguided) * wish;
    }
    wishes += emitter_wish[e] = powers_[e] * sum;
  }
  emitter_density_.resize(emitters);
  emitter_cdf_.resize(emitters);
  double running = 0;
  for (size_t e = 0; e < emitters; ++e) {
    const double share = powers_[e] / all_power_;
    emitter_density_[e] =
        wishes > 0 ? kUnguided * share + (1 - kUnguided) * emitter_wish[e] / wishes : share;
    emitter_cdf_[e] = running += emitter_density_[e];
  }
}

void EmissionGuide::warp(EmissionPrimary& sample, const Vec2& u) const {
  const double target = u.x * emitter_cdf_.back();
  size_t e =
      std::upper_bound(emitter_cdf_.begin(), emitter_cdf_.end(), target) - emitter_cdf_.begin();
  e = std::min(e, emitter_cdf_.size() - 1);
  const double* cdf = &cell_cdf_[first_[e]];
  const int count = static_cast<int>(first_[e + 1] - first_[e]);
  const int c = std::min(
      static_cast<int>(std::upper_bound(cdf, cdf + count, u.y * cdf[count - 1]) - cdf), count - 1);
  sample.emitter = static_cast<uint32_t>(e);
  sample.cell = first_[e] + static_cast<uint32_t>(c);
  const Cell& cell = cells_[sample.cell];
  // Relative to uniform
  const double density = (cdf[c] - (c ? cdf[c - 1] : 0)) / (cdf[count - 1] * cell.volume());
  const auto inside = [&](int axis, float f) {
    return std::min(cell.low[axis] + f * (cell.high[axis] - cell.low[axis]), kBelowOne);
  };
  sample.place = {inside(0, sample.place.x), inside(1, sample.place.y)};
  sample.way = {inside(2, sample.way.x), inside(3, sample.way.y)};
  sample.weight = static_cast<float>(powers_[e] / all_power_ / emitter_density_[e] / density);
}

}  // namespace photon_splat
