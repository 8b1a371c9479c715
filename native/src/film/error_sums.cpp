#include "film/error_sums.h"

#include <algorithm>
#include <cmath>

#include "film/error_estimate.h"

namespace photon_splat {
namespace {

// From so many films on their differences say how large the variance is, and what each knows of
// itself says where: a film of one pass knows little.
constexpr uint32_t kTellingFilms = 4;

}  // namespace

ErrorSums ErrorEstimate::sums() const {
  const size_t count = luminance_.size();
  ErrorSums out{std::vector<float>(count), std::vector<float>(count), std::vector<float>(count),
                detail_, detail_squares_};
  for (size_t i = 0; i < count; ++i) {
    const double samples = samples_[i], light = luminance_[i];
    if (!(samples > 0)) continue;
    const auto kept = [](double value) { return static_cast<float>(std::min(value, 1e37)); };
    out.variance[i] = kept(variance_[i] * samples * samples);
    const double square = light * light / samples;
    out.square[i] = kept(square);
    out.square_rest[i] = static_cast<float>(std::min(square, 1e37) - out.square[i]);
  }
  return out;
}

void ErrorEstimate::restore(const ErrorSums& sums, const PackedFilm& film, uint32_t films,
                            ThreadPool& pool) {
  reset(film.width, film.height);
  passes_ = estimated_ = film.passes;
  detail_ = sums.detail;
  detail_squares_ = sums.detail_squares;
  double between = 0, within = 0;
  for (size_t t = 0; t < film.tiles(); ++t) {
    PackedFilm::Sums seen;
    film.see(t, seen);
    film.each(t, [&](size_t i, size_t place) {
      luminance_[i] = seen.luminance[place];
      samples_[i] = std::max(seen.samples[place], 1.0f);
      const double samples = samples_[i], light = luminance_[i];
      variance_[i] = static_cast<float>(sums.variance[i] / (samples * samples));
      within += variance_[i];
      between += (double{sums.square[i]} + sums.square_rest[i] - light * light / samples) / samples;
    });
  }
  const double ratio = films > 1 && within > 0 ? between / (films - 1) / within : 0;
  if (films >= kTellingFilms && ratio > 0)
    for (float& variance : variance_) variance *= static_cast<float>(ratio);
  estimate_bias(pool);
  make_figures(pool);
  figures_.between = ratio;
}

}  // namespace photon_splat
