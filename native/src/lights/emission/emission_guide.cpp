#include "lights/emission/emission_guide.h"

#include <numeric>

namespace photon_splat {

EmissionGuide::EmissionGuide(std::vector<double> powers, std::vector<Division> divisions)
    : powers_(std::move(powers)), divisions_(std::move(divisions)) {
  if (!divisions_.empty())
    cells_ = divisions_[0].place * divisions_[0].place * divisions_[0].way * divisions_[0].way;
  useful_.resize(powers_.size() * cells_);
  paths_.resize(useful_.size());
  all_power_ = std::accumulate(powers_.begin(), powers_.end(), 0.0);
}

int EmissionGuide::cell_of(uint32_t emitter, const Vec2& place, const Vec2& way) const {
  const Division d = divisions_[emitter];
  const auto index = [](float u, int n) {
    return std::min(static_cast<int>(u * static_cast<float>(n)), n - 1);
  };
  return ((index(place.x, d.place) * d.place + index(place.y, d.place)) * d.way +
          index(way.x, d.way)) *
             d.way +
         index(way.y, d.way);
}

void EmissionGuide::learn(const EmissionPrimary& path, double useful) {
  const size_t at = size_t{path.emitter} * cells_ + cell_of(path.emitter, path.place, path.way);
  paths_[at] += 1;
  useful_[at] += static_cast<float>(useful);
}

void EmissionGuide::finish() {
  const size_t emitters = powers_.size();
  std::vector<double> emitter_wish(emitters);
  cell_cdf_.resize(useful_.size());
  double wishes = 0;
  for (size_t e = 0; e < emitters; ++e) {
    const float* useful = &useful_[e * cells_];
    const float* paths = &paths_[e * cells_];
    const double found = std::accumulate(useful, useful + cells_, 0.0),
                 tried = std::accumulate(paths, paths + cells_, 0.0);
    const double mean = tried > 0 ? found / tried : 0;
    // Each cell's mean is drawn towards the emitter's by as much as one path weighs; neighbours
    // that were not tried get it.
    std::vector<double> wish(cells_, 1.0);
    double sum = 0;
    for (int c = 0; c < cells_; ++c) {
      if (mean > 0) wish[c] = std::sqrt((useful[c] + mean) / (paths[c] + 1.0));
      sum += wish[c];
    }
    double running = 0;
    for (int c = 0; c < cells_; ++c) {
      running += kUnguided / cells_ + (1 - kUnguided) * wish[c] / sum;
      cell_cdf_[e * cells_ + c] = static_cast<float>(running);
    }
    emitter_wish[e] = powers_[e] * (mean > 0 ? sum / cells_ : 0.0);
    wishes += emitter_wish[e];
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
  const float* cdf = &cell_cdf_[e * cells_];
  const int c = std::min<int>(
      static_cast<int>(std::upper_bound(cdf, cdf + cells_, u.y * cdf[cells_ - 1]) - cdf),
      cells_ - 1);
  // Relative to uniform
  const float density = (cdf[c] - (c ? cdf[c - 1] : 0)) / cdf[cells_ - 1] * cells_;
  const Division d = divisions_[e];
  const int way_y = c % d.way, way_x = c / d.way % d.way, place_y = c / (d.way * d.way) % d.place,
            place_x = c / (d.way * d.way * d.place);
  const auto inside = [](int cell, float f, int n) {
    return std::min((static_cast<float>(cell) + f) / static_cast<float>(n), kBelowOne);
  };
  sample.emitter = static_cast<uint32_t>(e);
  sample.place = {inside(place_x, sample.place.x, d.place),
                  inside(place_y, sample.place.y, d.place)};
  sample.way = {inside(way_x, sample.way.x, d.way), inside(way_y, sample.way.y, d.way)};
  sample.weight = static_cast<float>(powers_[e] / all_power_ / emitter_density_[e]) / density;
}

}  // namespace photon_splat
