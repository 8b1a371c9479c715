#include "photons/path_worth.h"

#include <algorithm>
#include <numeric>

namespace photon_splat {
namespace {

// Stops in a cell that is divided. What few of them have brought says little: as many more are
// taken to have brought as much as in the cell around it.
constexpr double kFewest = 64;
constexpr double kSure = 2;          // over what a path may bring that goes on for sure
constexpr float kLeast = 1.0f / 32;  // chance to go on: no path gets stronger than that at once

}  // namespace

uint64_t PathWorth::cell(const Vec3& x, int level) const {
  const float most = static_cast<float>(1 << level), scale = most / size_;
  const Vec3 p = (x - corner_) * scale;
  const auto index = [&](float f) {  // of no number: the first
    return f > 0 ? static_cast<uint64_t>(std::min(f, most - 1)) : 0;
  };
  return hash64(hash64(index(p.x) | index(p.y) << 20 | index(p.z) << 40) +
                static_cast<uint64_t>(level));
}

void PathWorth::learn(std::span<const Stop> stops, double brought, double total) {
  brought_ = brought * total * total;
  stops_.insert(stops_.end(), stops.begin(), stops.end());
  cells_ = {};
  std::vector<uint32_t> inside(stops_.size());
  std::iota(inside.begin(), inside.end(), 0u);
  for (int level = 0; level < kLevels && !inside.empty(); ++level) {
    std::vector<uint64_t> cells(inside.size());
    for (size_t i = 0; i < inside.size(); ++i) {
      const Stop& stop = stops_[inside[i]];
      Sums& sums = cells_[cells[i] = cell(stop.place, level)];
      sums.stops += stop.weight;
      sums.brought += stop.weight * (stop.brought / stop.power);
    }
    size_t kept = 0;
    for (size_t i = 0; i < inside.size(); ++i)
      if (cells_.find(cells[i])->stops >= kFewest) inside[kept++] = inside[i];
    inside.resize(kept);
  }
}

float PathWorth::chance(const Vec3& x, float power, double total) const {
  double worth = 0;  // squared powers that a path of power 1 brings
  for (int level = 0; level < kLevels; ++level) {
    const Sums* sums = cells_.find(cell(x, level));
    if (!sums) break;
    const double prior = level ? kFewest : 0;
    worth = (sums->brought + prior * worth) / (sums->stops + prior);
  }
  const double share = kSure * std::sqrt(worth / brought_) * std::abs(power) * total;
  return share < 1 ? std::max(kLeast, static_cast<float>(share)) : 1;
}

}  // namespace photon_splat
