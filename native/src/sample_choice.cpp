#include "sample_choice.h"

#include <bit>
#include <numeric>

namespace photon_splat {
namespace {

constexpr int kAround = 8;          // pixels around one, in a ring
constexpr double kMost = 64;        // samples of a pixel in one pass
constexpr double kMostMean = 2;     // of all pixels: passes stay short
constexpr double kOutlier = 100;    // times the mean deviation: more counts as that much
constexpr double kLeastWork = 0.05;

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
    for (uint8_t& count : count_) count = static_cast<uint8_t>((count + 1) / 2);
}

void SampleChoice::begin_pass(ThreadPool& pool) {
  if (to_choose_) choose(pool);
  to_choose_ = false;
}

// Of one sample, as the eight pixels around tell; after one pass alone, from how those next to each other differ. The pixel's own
// samples have no say: what is bright by chance would get more company than what is dark by chance, and the mean come out too dark.
std::vector<float> SampleChoice::deviations(const Moments& moments, ThreadPool& pool) const {
  constexpr int kAcross[kAround + 1] = {-1, 0, 1, 1, 1, 0, -1, -1, -1}, kDown[kAround + 1] = {-1, -1, -1, 0, 1, 1, 1, 0, -1};
  const bool alone = passes_ == 1;
  std::vector<float> own(alone ? 0 : samples_.size()), result(samples_.size());
  const auto known = [](float v) { return v < 1e30f ? v : 0; };
  const CancelFlag never;
  if (!alone)
    pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
      for (size_t i = row * width_; i < (row + 1) * width_; ++i)
        own[i] = known(moments.variance(i, std::max(samples_[i], 1.0f), static_cast<float>(passes_)));
    });
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (int x = 0; x < width_; ++x) {
      const auto at = [&](int k) -> int64_t {  // -1: outside
        const int64_t column = x + kAcross[k], line = static_cast<int64_t>(row) + kDown[k];
        return column < 0 || column >= width_ || line < 0 || line >= height_ ? -1 : line * width_ + column;
      };
      float sum = 0;
      int count = 0;
      for (int k = 0; k < kAround; ++k) {
        const int64_t one = at(k), next = alone ? at(k + 1) : one;
        if (one < 0 || next < 0) continue;
        const float difference = alone ? moments.sum[one] - moments.sum[next] : 0;
        sum += alone ? known(0.5f * difference * difference) : own[one];
        ++count;
      }
      result[row * width_ + x] = count ? std::sqrt(sum / static_cast<float>(count)) : 0;
    }
  });
  return result;
}

void SampleChoice::choose(ThreadPool& pool) {
  const std::vector<float> camera = deviations(camera_, pool), all = deviations(all_, pool);
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
  const double unit = std::max(worth, wanted / pixels / kMostMean);
  const double least = std::clamp(worth > 0 ? wanted / pixels / worth : kMost, 1.0, static_cast<double>(least_));
  for (size_t i = 0; i < count_.size(); ++i) {
    const double samples = unit > 0 ? std::clamp(camera[i] / unit, least, kMost) : 1;
    count_[i] = static_cast<uint8_t>(std::bit_floor(static_cast<uint32_t>(samples * std::sqrt(2.0))));
  }
}

}  // namespace photon_splat
