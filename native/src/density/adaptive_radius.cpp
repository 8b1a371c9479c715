#include "density/adaptive_radius.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "film/pixel_blur.h"

namespace photon_splat {
namespace {

constexpr uint32_t kFirstChoice = 4;  // passes
// Half sides of the windows over which pixels lend their statistics
constexpr int kNear = 2, kFar = 12;
// mean(d)^2 over the noise in it, from which the near window is believed
constexpr float kSignificant = 2.5f;
constexpr float kLeastStep = 0.35f, kMostStep = 1.4f;  // of one choice
constexpr float kLeast = 0.1f, kMost = 2.0f;           // of all together

}  // namespace

void AdaptiveRadius::reset(int width, int height, uint32_t parts) {
  parts_ = parts;
  before_ = 0;
  earlier_ = {};
  width_ = width;
  height_ = height;
  passes_ = since_ = 0;
  const size_t pixels = static_cast<size_t>(width) * height;
  for (auto* values : {&detail_, &sum_, &squares_}) values->assign(pixels, 0.0f);
  factors_.assign(pixels, 1.0f);
}

void AdaptiveRadius::end_pass(ThreadPool& pool) {
  const CancelFlag never;
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (size_t i = row * width_; i < (row + 1) * width_; ++i) {
      sum_[i] += detail_[i];
      squares_[i] += detail_[i] * detail_[i];
      detail_[i] = 0;
    }
  });
  if (++passes_ >= kFirstChoice && std::has_single_bit(passes_)) choose(pool);
}

std::vector<AdaptiveRadius::Known> AdaptiveRadius::known() const {
  std::vector<Known> out(factors_.size());
  for (size_t i = 0; i < out.size(); ++i) out[i] = {factors_[i], sum_[i], squares_[i]};
  return out;
}

void AdaptiveRadius::go_on(std::vector<Known> known, uint32_t passes) {
  earlier_ = std::move(known);
  before_ = passes;
}

void AdaptiveRadius::begin_part() {
  if (earlier_.empty()) return;
  passes_ = before_;
  since_ = passes_ < kFirstChoice ? 0 : std::bit_floor(passes_);
  for (size_t i = 0; i < earlier_.size(); ++i) {
    detail_[i] = 0;
    factors_[i] = earlier_[i][0], sum_[i] = earlier_[i][1], squares_[i] = earlier_[i][2];
  }
  earlier_ = {};
}

void AdaptiveRadius::choose(ThreadPool& pool) {
  const float n = static_cast<float>(passes_ - since_);
  std::vector<float> square(sum_.size()), variance(sum_.size()), squares, variances, far_squares,
      far_variances;
  for (size_t i = 0; i < sum_.size(); ++i) {
    const float mean = sum_[i] / n;
    square[i] = mean * mean;
    variance[i] = std::max(0.0f, squares_[i] / n - mean * mean) * n / (n - 1);
    sum_[i] = squares_[i] = 0;
  }
  blur(square, width_, height_, kNear, squares, pool);
  blur(variance, width_, height_, kNear, variances, pool);
  // A bias as small as the best one drowns in the noise of a few discs: where nothing is seen from
  // near, the pixels further around in which nothing is seen either are asked together.
  const auto is_seen = [&](size_t i) { return squares[i] > kSignificant * variances[i] / n; };
  for (size_t i = 0; i < square.size(); ++i)
    if (is_seen(i)) square[i] = variance[i] = 0;
  blur(square, width_, height_, kFar, far_squares, pool);
  blur(variance, width_, height_, kFar, far_variances, pool);
  for (size_t i = 0; i < factors_.size(); ++i) {
    // Bias goes with brightness
    const float share = is_seen(i) || !(far_variances[i] > 0) ? 1 : variances[i] / far_variances[i];
    const float bias2 =
        4 * (is_seen(i) ? squares[i] - variances[i] / n
                        : share * std::max(0.0f, far_squares[i] - far_variances[i] / n));
    // Variance of the mean of all parts by the time of the next choice
    const float noise2 = variances[i] / (static_cast<float>(parts_) * static_cast<float>(passes_));
    float step = 1;
    if (noise2 > 0 || bias2 > 0)
      step = std::clamp(std::pow(noise2 / std::max(2 * bias2, 1e-30f), 1.0f / 6), kLeastStep,
                        kMostStep);
    if (std::isfinite(step)) factors_[i] = std::clamp(factors_[i] * step, kLeast, kMost);
  }
  since_ = passes_;
}

}  // namespace photon_splat
