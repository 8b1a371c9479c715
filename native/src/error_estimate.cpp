#include "error_estimate.h"

#include "pixel_blur.h"

namespace photon_splat {
namespace {

constexpr int kNear = 2, kFar = 8;       // half sides of the windows over which neighbours lend their statistics
constexpr float kFarShare = 0.1f;        // what the wide one counts at first: no pixel is quiet only because nothing rare has hit it yet
constexpr float kQuietPairs = 3, kQuietShare = 0.1f;  // from so many on, a pixel that has never varied takes less from its near ones
constexpr float kLent = 4;               // statistics of how many pixels one has, its near neighbours' included
constexpr int kSlopes = 9;               // a = 1, 1.25, ... 3
constexpr float kSlopeStep = 0.25f, kUsualSlope = 1.3f, kSlopeSpread = 0.35f;
constexpr float kMost = 1e37f;
constexpr float kBiasPerDetail = 2;      // bias ~ h^2: discs of h and h/sqrt(2) differ by half of it

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (float v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

}  // namespace

void ErrorEstimate::reset(int width, int height) {
  width_ = width;
  height_ = height;
  passes_ = estimated_ = 0;
  levels_.clear();
  const size_t pixels = static_cast<size_t>(width) * height;
  for (auto* sum : {&luminance_, &samples_, &detail_, &detail_squares_, &error_, &variance_, &squared_bias_}) sum->assign(pixels, 0.0f);
  figures_ = {};
}

void ErrorEstimate::add(const Film& pass, ThreadPool& pool) {
  // Passes count in binary: each 1 that is carried is a block that has found its neighbour.
  uint32_t carried = 0;
  while (passes_ >> carried & 1) ++carried;
  while (levels_.size() <= carried) {
    const std::vector<float> none(luminance_.size());
    levels_.push_back({none, none, none, none, 0});
  }
  for (uint32_t i = 0; i < carried; ++i) ++levels_[i].pairs;
  const CancelFlag never;
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (size_t i = row * width_; i < (row + 1) * width_; ++i) {
      const Pixel& pixel = pass.pixels[i];
      float block = luminance(pixel.combined()), samples = std::max(pixel.samples, 1.0f);
      const float detail = pixel.detail / samples;
      luminance_[i] += block;
      samples_[i] += samples;
      detail_[i] += detail;
      detail_squares_[i] += detail * detail;
      for (uint32_t k = 0; k < carried; ++k) {
        const float open = levels_[k].open[i], open_samples = levels_[k].open_samples[i];
        const float difference = open / open_samples - block / samples;
        const float harmonic = 2 * open_samples * samples / (open_samples + samples);
        const float weight = harmonic / static_cast<float>(1u << k);
        levels_[k].squares[i] += difference * difference * harmonic * static_cast<float>(1u << k) * weight;
        levels_[k].weights[i] += weight;
        block += open;
        samples += open_samples;
      }
      levels_[carried].open[i] = block;
      levels_[carried].open_samples[i] = samples;
    }
  });
  ++passes_;
}

void ErrorEstimate::estimate_variance(ThreadPool& pool) {
  struct Used {
    std::vector<float> difference;  // D(k), mean over the window
    float weight, k;                // pairs; passes per block
  };
  std::vector<Used> used;
  for (size_t i = 0; i < levels_.size(); ++i)
    if (levels_[i].pairs) used.push_back({{}, static_cast<float>(levels_[i].pairs), std::exp2(static_cast<float>(i))});
  const bool alone = used.empty();
  if (alone) used.push_back({{}, 1, 1});
  float pairs = 0;
  for (const Used& u : used) pairs += u.weight;
  const float far_share = kFarShare / (1 + pairs / 8);
  const CancelFlag never;
  pool.for_each(used.size(), never, [&](size_t i, int) {
    std::vector<float> own(luminance_.size()), near, far;
    if (alone) {
      for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
          const size_t at = static_cast<size_t>(y) * width_ + x;
          const float right = luminance_[x + 1 < width_ ? at + 1 : at], up = luminance_[y + 1 < height_ ? at + width_ : at];
          own[at] = 0.25f * ((luminance_[at] - right) * (luminance_[at] - right) + (luminance_[at] - up) * (luminance_[at] - up));
        }
    } else {
      const float scale = 0.5f / (used[i].k * used[i].k);
      for (size_t at = 0; at < own.size(); ++at)
        own[at] = levels_[i].squares[at] / levels_[i].weights[at] * scale * static_cast<float>(passes_) / samples_[at];
    }
    blur(own, width_, height_, kNear, near);
    blur(own, width_, height_, kFar, far);
    const float quiet_share = used[i].weight < kQuietPairs ? 1 : kQuietShare;
    for (size_t at = 0; at < near.size(); ++at) {
      if (!alone && own[at] == 0) near[at] *= quiet_share;  // the sky beside a hedge
      near[at] += far_share * (far[at] - near[at]);
    }
    used[i].difference = std::move(near);
  });

  // V(n) / c for each slope: n passes are nets of k = 2^i of them, by the bits of n.
  float of_mean[kSlopes], power[kSlopes][32], penalty[kSlopes];
  for (int s = 0; s < kSlopes; ++s) {
    const double a = 1 + kSlopeStep * s, n = passes_;
    double sum = 0;
    for (int bit = 0; bit < 32; ++bit)
      if (passes_ >> bit & 1) sum += std::exp2(bit * (2 - a));
    of_mean[s] = static_cast<float>(sum / (n * n) / (2 - std::exp2(1 - a)));
    penalty[s] = static_cast<float>((a - kUsualSlope) * (a - kUsualSlope) / (2 * kSlopeSpread * kSlopeSpread));
    for (size_t i = 0; i < used.size(); ++i) {
      power[s][i] = static_cast<float>(std::pow(used[i].k, a)) * used[i].weight / pairs;
      penalty[s] -= 0.5f * kLent * used[i].weight * static_cast<float>(a) * std::log(used[i].k);
    }
  }
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (size_t at = row * width_; at < (row + 1) * width_; ++at) {
      float best = -INFINITY;
      for (int s = 0; s < kSlopes; ++s) {
        // Each D is a sum of squares: gamma-distributed, its shape in proportion to its pairs.
        float c = 1e-30f;
        for (size_t i = 0; i < used.size(); ++i) c += used[i].difference[at] * power[s][i];
        const float likelihood = -0.5f * kLent * pairs * std::log(c) - penalty[s];
        if (likelihood > best) {
          best = likelihood;
          variance_[at] = c * of_mean[s];
        }
      }
    }
  });
}

void ErrorEstimate::estimate_bias(ThreadPool& pool) {
  const float n = static_cast<float>(passes_);
  std::vector<float> square(detail_.size()), noise(detail_.size());
  for (size_t i = 0; i < detail_.size(); ++i) {
    const float mean = detail_[i] / n;
    square[i] = mean * mean;
    noise[i] = passes_ > 1 ? std::max(0.0f, detail_squares_[i] / n - mean * mean) / (n - 1) : square[i];
  }
  std::vector<float> squares, noises;
  const CancelFlag never;
  pool.for_each(2, never, [&](size_t i, int) { i ? blur(noise, width_, height_, 1, noises) : blur(square, width_, height_, 1, squares); });
  for (size_t i = 0; i < squares.size(); ++i)
    squared_bias_[i] = kBiasPerDetail * kBiasPerDetail * std::max(0.0f, squares[i] - noises[i]);
}

void ErrorEstimate::update(ThreadPool& pool) {
  if (estimated_ == passes_ || luminance_.empty()) return;
  estimated_ = passes_;
  estimate_variance(pool);
  estimate_bias(pool);
  for (size_t i = 0; i < error_.size(); ++i) {
    // Squares of what is barely a float are none any more.
    for (float* square : {&variance_[i], &squared_bias_[i]})
      if (!(*square < kMost)) *square = kMost;
    error_[i] = std::sqrt(variance_[i] + squared_bias_[i]);
  }
  std::vector<float> means(luminance_.size());
  for (size_t i = 0; i < means.size(); ++i) means[i] = luminance_[i] / samples_[i];
  const double mean = mean_of(means), variance = mean_of(variance_), bias = mean_of(squared_bias_);
  figures_ = {0, 0, 0, mean};
  if (mean > 0) figures_ = {std::sqrt(variance + bias) / mean, std::sqrt(variance) / mean, std::sqrt(bias) / mean, mean};
}

}  // namespace photon_splat
