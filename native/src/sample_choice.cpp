#include "sample_choice.h"

#include <bit>
#include <numeric>

namespace photon_splat {
namespace {

constexpr int kReach = 2;           // pixels around one that tell after one sample
constexpr float kFurther = 0.1f;    // weight of those that are not next to it
constexpr double kMost = 256;       // samples of a pixel in one pass
constexpr double kMostMean = 2;     // of all pixels: passes stay short
constexpr double kOutlier = 100;    // times the mean deviation: more counts as that much
constexpr double kLeastWork = 0.05;

float known(float variance) { return variance < 1e30f ? variance : 0; }

// Powers of two, the nearest in ratio.
uint32_t rounded(double samples, double least) { return std::bit_floor(static_cast<uint32_t>(std::clamp(samples, least, kMost) * std::sqrt(2.0))); }

}  // namespace

void SampleChoice::Moments::reset(size_t pixels) {
  sum.assign(pixels, 0.0f);
  squares.assign(pixels, 0.0f);
}

void SampleChoice::Moments::add(size_t i, float mean, float samples) {
  sum[i] += mean * samples;
  squares[i] += mean * mean * samples;
}

float SampleChoice::Moments::variance(size_t i, float samples, float passes) const {
  return std::max(0.0f, squares[i] - sum[i] * sum[i] / samples) / (passes - 1);
}

void SampleChoice::reset(int width, int height, uint32_t least) {
  least_ = least;
  width_ = width;
  height_ = height;
  passes_ = 0;
  to_choose_ = false;
  const size_t pixels = static_cast<size_t>(width) * height;
  camera_.reset(pixels);
  all_.reset(pixels);
  samples_.assign(pixels, 0.0f);
  extra_.assign(pixels, 0);
  count_.assign(pixels, 1);
}

void SampleChoice::see(const Film& pass, Moments& moments, ThreadPool& pool) const {
  const CancelFlag never;
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (size_t i = row * width_; i < (row + 1) * width_; ++i)
      moments.add(i, luminance(pass.pixels[i].combined()) * pass.pixels[i].share(), pass.pixels[i].samples);
  });
}

double SampleChoice::mean_count() const {
  return count_.empty() ? 1 : std::accumulate(count_.begin(), count_.end(), 0.0) / static_cast<double>(count_.size());
}

void SampleChoice::see_camera(const Film& pass, ThreadPool& pool) { see(pass, camera_, pool); }

void SampleChoice::end_pass(const Film& pass, double work, ThreadPool& pool) {
  see(pass, all_, pool);
  const CancelFlag never;
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (size_t i = row * width_; i < (row + 1) * width_; ++i) {
      samples_[i] += pass.pixels[i].samples;
      extra_[i] += count_[i] - 1u;
    }
  });
  to_choose_ = std::has_single_bit(++passes_);
  work_ = work;
}

void SampleChoice::limit(double mean, ThreadPool& pool) {
  begin_pass(pool);
  while (mean_count() > std::max(mean, 1.0))
    for (uint16_t& count : count_) count = static_cast<uint16_t>((count + 1) / 2);
}

void SampleChoice::begin_pass(ThreadPool& pool) {
  const auto of = [&](const Moments& moments) { return passes_ > 1 ? deviations(moments, pool) : first_deviations(moments, pool); };
  if (to_choose_) choose(of(camera_), of(all_));
  to_choose_ = false;
}

// Of one sample, as the eight pixels around tell. The pixel's own samples have no say: what is bright by chance would get more company
// than what is dark by chance, and the mean come out too dark.
std::vector<float> SampleChoice::deviations(const Moments& moments, ThreadPool& pool) const {
  std::vector<float> own(samples_.size()), result(samples_.size());
  const CancelFlag never;
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (size_t i = row * width_; i < (row + 1) * width_; ++i)
      own[i] = known(moments.variance(i, std::max(samples_[i], 1.0f), static_cast<float>(passes_)));
  });
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    const int top = std::max(static_cast<int>(row) - 1, 0), bottom = std::min(static_cast<int>(row) + 1, height_ - 1);
    for (int x = 0; x < width_; ++x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, width_ - 1);
      float sum = 0;
      for (int y = top; y <= bottom; ++y)
        for (int at = left; at <= right; ++at)
          if (at != x || y != static_cast<int>(row)) sum += own[static_cast<size_t>(y) * width_ + at];
      const int count = (bottom - top + 1) * (right - left + 1) - 1;
      result[row * width_ + x] = count ? std::sqrt(sum / static_cast<float>(count)) : 0;
    }
  });
  return result;
}

// The same after one sample of each pixel: as those next to each other differ, at most two pixels away. What is seen only further than
// one away counts little, but an edge that is as bright as a lamp is not to be missed.
std::vector<float> SampleChoice::first_deviations(const Moments& moments, ThreadPool& pool) const {
  const std::vector<float>& light = moments.sum;
  std::vector<float> across(light.size()), down(light.size()), result(light.size());
  const CancelFlag never;
  const auto rows = [&](auto&& work) { pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) { work(static_cast<int>(row)); }); };
  const auto half_square = [](float a, float b) { return known(0.5f * (a - b) * (a - b)); };
  rows([&](int y) {  // each pixel and the next one of its row, or of the next row
    for (int x = 0; x < width_; ++x) {
      const size_t i = static_cast<size_t>(y) * width_ + x;
      if (x + 1 < width_) across[i] = half_square(light[i], light[i + 1]);
      if (y + 1 < height_) down[i] = half_square(light[i], light[i + width_]);
    }
  });
  rows([&](int y) {
    for (int x = 0; x < width_; ++x) {
      float sum = 0, weights = 0;
      for (int dy = -kReach; dy <= kReach; ++dy) {
        if (y + dy < 0 || y + dy >= height_) continue;
        for (int dx = -kReach; dx <= kReach; ++dx) {
          if (x + dx < 0 || x + dx >= width_) continue;
          const size_t i = static_cast<size_t>(y + dy) * width_ + (x + dx);
          const bool close = std::abs(dx) <= 1 && std::abs(dy) <= 1;
          if (dx < kReach && x + dx + 1 < width_ && !(dy == 0 && (dx == 0 || dx == -1))) {
            const float weight = close && dx < 1 ? 1 : kFurther;
            sum += weight * across[i];
            weights += weight;
          }
          if (dy < kReach && y + dy + 1 < height_ && !(dx == 0 && (dy == 0 || dy == -1))) {
            const float weight = close && dy < 1 ? 1 : kFurther;
            sum += weight * down[i];
            weights += weight;
          }
        }
      }
      result[static_cast<size_t>(y) * width_ + x] = weights > 0 ? std::sqrt(sum / weights) : 0;
    }
  });
  return result;
}

void SampleChoice::choose(const std::vector<float>& camera, const std::vector<float>& all) {
  const auto mean_below = [&](double limit) {
    double sum = 0;
    for (const float d : all) sum += std::min<double>(d, limit);
    return all.empty() ? 0 : sum / static_cast<double>(all.size());
  };
  const double limit = kOutlier * mean_below(INFINITY);
  double photons = 0, wanted = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    const double d = std::min<double>(all[i], limit), c = std::min<double>(camera[i], limit);
    photons += std::max(0.0, d * d - c * c);
    wanted += c;
  }
  const double pixels = static_cast<double>(all.size());
  const double worth = std::sqrt(photons / pixels * std::max(work_, kLeastWork));
  const double least = std::clamp(worth > 0 ? wanted / pixels / worth : kMost, 1.0, static_cast<double>(least_));
  const double unit = std::max(worth, wanted / pixels / kMostMean);
  for (size_t i = 0; i < count_.size(); ++i)
    count_[i] = static_cast<uint16_t>(unit > 0 ? rounded(std::min<double>(camera[i], limit) / unit, least) : 1);
}

}  // namespace photon_splat
