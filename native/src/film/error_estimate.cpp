#include "film/error_estimate.h"

#include <algorithm>
#include <numeric>

#include "film/pixel_blur.h"

namespace photon_splat {
namespace {

// Half sides of the windows over which neighbours lend their statistics
constexpr int kNear = 2, kFar = 8;
// What the wide one counts at first: no pixel is quiet only because nothing rare has hit it yet
constexpr float kFarShare = 0.1f;
// From so many on, a pixel that has never varied takes less from its near ones
constexpr float kQuietPairs = 3, kQuietShare = 0.1f;
// Statistics of how many pixels one has, its near neighbours' included
constexpr float kLent = 4;
// Times the picture's mean, straight from a source, in this part of all passes: such pixels tell
// nothing of those beside them
constexpr double kBright = 4;
constexpr float kOften = 0.25f;
constexpr int kSlopes = 9;  // a = 1, 1.25, ... 3
constexpr float kSlopeStep = 0.25f;
constexpr int kGroups = 10;  // of pixels that are equally far off, by their estimates
// passes: before, groups count nothing, or half
constexpr uint32_t kFirstGroups = 4, kAllGroups = 8;
constexpr size_t kSorted = 20000;  // pixels that tell where groups end
// A group counts as so many pixels at most: errors of neighbouring pixels are correlated
constexpr float kLentInGroup = 20;
// Blocks tell the variance of a group once they hold this part of all passes
constexpr float kKnown = 0.75f;
constexpr float kGroupStep = 4;  // at most, of the variance, up or down
constexpr float kMost = 1e37f;
constexpr size_t kPart = 1 << 14;     // pixels that a thread takes at once
constexpr float kNoisePerDetail = 2;  // squared: see AdaptiveRadius
// Bias ~ h^2: discs of h and h/sqrt(2) differ by half of it
constexpr float kBiasPerDetail = 2;

template <class Visit>
void for_pixels(ThreadPool& pool, size_t count, Visit&& visit) {
  pool.for_parts(count, kPart, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) visit(i);
  });
}

// Mean of value(i); the same for any number of threads.
template <class Value>
double mean_of(ThreadPool& pool, size_t count, Value&& value) {
  std::vector<double> parts((count + kPart - 1) / kPart);
  pool.for_parts(count, kPart, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) parts[begin / kPart] += value(i);
  });
  const double sum = std::accumulate(parts.begin(), parts.end(), 0.0);
  return count ? sum / static_cast<double>(count) : 0;
}

// blur(), but pixels where `apart` is 1 lend nothing to those where it is 0. share_apart: blur() of
// it. Empty: there are none.
void blur_apart(const std::vector<float>& in, const std::vector<float>& apart,
                const std::vector<float>& share_apart, int width, int height, int r,
                std::vector<float>& out, ThreadPool& pool) {
  blur(in, width, height, r, out, pool);
  if (apart.empty()) return;
  std::vector<float> rest(in.size()), of_rest;
  for_pixels(pool, in.size(), [&](size_t i) { rest[i] = apart[i] > 0 ? 0 : in[i]; });
  blur(rest, width, height, r, of_rest, pool);
  for_pixels(pool, in.size(), [&](size_t i) {
    if (!(apart[i] > 0)) out[i] = of_rest[i] / (1 - share_apart[i]);
  });
}

// c k^-a / (2 - 2^(1-a)) fitted to D(k) = c k^-a at several k, with a prior on a.
class PowerLaw {
 public:
  struct Prior {
    float slope, spread;
  };
  // `pairs` of blocks of k passes each; every D counts as the mean over `lent` pixels.
  PowerLaw(uint32_t passes, const std::vector<float>& k, const std::vector<float>& pairs,
           float lent, Prior prior)
      : levels_(k.size()), trust_(0.5f * lent * std::accumulate(pairs.begin(), pairs.end(), 0.0f)) {
    const float all = 2 * trust_ / lent;
    for (int s = 0; s < kSlopes; ++s) {
      const float a = 1 + kSlopeStep * static_cast<float>(s);
      // The law holds for blocks that the sequence fills evenly: the passes are as many as the
      // binary digits of their number say.
      double of_all = 0;
      for (uint32_t digit = 1; digit && digit <= passes; digit *= 2)
        if (passes & digit)
          of_all += std::pow(double(digit) / passes, 2) * std::pow(double(digit), double(-a));
      of_mean_[s] = static_cast<float>(of_all / (2 - std::exp2(1 - a)));
      penalty_[s] = (a - prior.slope) * (a - prior.slope) / (2 * prior.spread * prior.spread);
      for (size_t i = 0; i < levels_; ++i) {
        power_[s][i] = std::pow(k[i], a) * pairs[i] / all;
        penalty_[s] -= 0.5f * lent * pairs[i] * a * std::log(k[i]);
      }
    }
  }

  // Variance of the mean of all passes. difference(i) is D at the i-th k.
  template <class Difference>
  float variance(Difference&& difference) const {
    float best = -INFINITY, result = 0;
    for (int s = 0; s < kSlopes; ++s) {
      // Each D is a sum of squares: gamma-distributed, its shape in proportion to its pairs.
      float c = 1e-30f;
      for (size_t i = 0; i < levels_; ++i) c += difference(i) * power_[s][i];
      const float likelihood = -trust_ * std::log(c) - penalty_[s];
      if (likelihood > best) {
        best = likelihood;
        result = c * of_mean_[s];
      }
    }
    return result;
  }

 private:
  size_t levels_;
  float trust_, of_mean_[kSlopes], power_[kSlopes][32], penalty_[kSlopes];
};

constexpr PowerLaw::Prior kOfPixel{1.3f, 0.35f}, kOfGroup{1.15f, 0.5f};

}  // namespace

void ErrorEstimate::reset(int width, int height) {
  width_ = width;
  height_ = height;
  passes_ = estimated_ = 0;
  levels_.clear();
  const size_t pixels = static_cast<size_t>(width) * height;
  for (auto* sum : {&luminance_, &samples_, &sources_, &source_passes_, &noises_, &detail_,
                    &detail_squares_, &error_, &variance_, &squared_bias_})
    sum->assign(pixels, 0.0f);
  figures_ = {};
}

void ErrorEstimate::add(const PackedFilm& pass, ThreadPool& pool) {
  // Passes count in binary: each 1 that is carried is a block that has found its neighbour.
  uint32_t carried = 0;
  while (passes_ >> carried & 1) ++carried;
  while (levels_.size() <= carried) {
    const std::vector<float> none(luminance_.size());
    levels_.push_back({none, none, none, none, none, 0});
  }
  for (uint32_t i = 0; i < carried; ++i) ++levels_[i].pairs;
  const CancelFlag never;
  pool.for_each(pass.tiles(), never, [&](size_t t, int) {
    PackedFilm::Sums sums;
    pass.see(t, sums);
    pass.each(t, [&](size_t i, size_t place) {
      float block = sums.luminance[place], samples = std::max(sums.samples[place], 1.0f),
            noise = std::sqrt(samples);
      const float detail = sums.detail[place] / samples;
      luminance_[i] += block;
      samples_[i] += samples;
      sources_[i] += sums.sources[place];
      source_passes_[i] += sums.sources[place] > 0;
      noises_[i] += noise;
      detail_[i] += detail;
      detail_squares_[i] += detail * detail;
      for (uint32_t k = 0; k < carried; ++k) {
        const float open = levels_[k].open[i], open_samples = levels_[k].open_samples[i],
                    open_noise = levels_[k].open_noise[i];
        const float difference = open / open_samples - block / samples;
        const float expected =
            open_noise / (open_samples * open_samples) + noise / (samples * samples);
        levels_[k].squares[i] += difference * difference / (expected * expected);
        levels_[k].weights[i] += 1 / expected;
        block += open;
        samples += open_samples;
        noise += open_noise;
      }
      levels_[carried].open[i] = block;
      levels_[carried].open_samples[i] = samples;
      levels_[carried].open_noise[i] = noise;
    });
  });
  ++passes_;
}

void ErrorEstimate::estimate_variance(ThreadPool& pool) {
  std::vector<float> k, pairs;
  for (size_t i = 0; i < levels_.size(); ++i)
    if (levels_[i].pairs) {
      k.push_back(std::exp2(static_cast<float>(i)));
      pairs.push_back(static_cast<float>(levels_[i].pairs));
    }
  const bool alone = k.empty();
  if (alone) k = pairs = {1};
  const float far_share = kFarShare / (1 + std::accumulate(pairs.begin(), pairs.end(), 0.0f) / 8);
  // D(k)
  std::vector<std::vector<float>> own(k.size(), std::vector<float>(luminance_.size())),
      lent(k.size());
  if (alone)
    own[0] = differences_of_neighbours(pool);
  else
    for (size_t i = 0; i < k.size(); ++i) {
      const float scale = static_cast<float>(passes_) / k[i];
      for_pixels(pool, own[i].size(), [&](size_t at) {
        own[i][at] = levels_[i].squares[at] / levels_[i].weights[at] * scale * noises_[at] /
                     (samples_[at] * samples_[at]);
      });
    }
  const std::vector<float> sources = beside_sources(pool);
  std::vector<float> sources_near, sources_far, far;
  if (!sources.empty()) {
    blur(sources, width_, height_, kNear, sources_near, pool);
    blur(sources, width_, height_, kFar, sources_far, pool);
  }
  for (size_t i = 0; i < k.size(); ++i) {
    blur_apart(own[i], sources, sources_near, width_, height_, kNear, lent[i], pool);
    blur_apart(own[i], sources, sources_far, width_, height_, kFar, far, pool);
    const float quiet_share = pairs[i] < kQuietPairs ? 1 : kQuietShare;
    for_pixels(pool, far.size(), [&](size_t at) {
      if (!alone && own[i][at] == 0) lent[i][at] *= quiet_share;  // the sky beside a hedge
      lent[i][at] += far_share * (far[at] - lent[i][at]);
    });
  }
  const PowerLaw law(passes_, k, pairs, kLent, kOfPixel);
  for_pixels(pool, variance_.size(), [&](size_t at) {
    variance_[at] = law.variance([&](size_t i) { return lent[i][at]; });
  });
  if (passes_ >= kFirstGroups) correct_by_group(own, sources, k, pairs, pool);
}

// 1 where a source is seen that outshines the picture, as a lamp does, and next to there; 0
// elsewhere. The rim of a lamp varies from pass to pass by more than all else, which shows nothing
// of the pixels that never see it. What is met rarely, as a lamp out of focus, may be anywhere
// around. Empty where there are none.
std::vector<float> ErrorEstimate::beside_sources(ThreadPool& pool) const {
  const double bright = kBright * mean_of(pool, luminance_.size(),
                                          [&](size_t i) { return luminance_[i] / samples_[i]; });
  const auto is_source = [&](size_t i) {
    return sources_[i] / samples_[i] > bright &&
           source_passes_[i] >= kOften * static_cast<float>(passes_);
  };
  const double sources =
      mean_of(pool, luminance_.size(), [&](size_t i) { return is_source(i) ? 1.0 : 0.0; });
  if (!(sources > 0)) return {};
  std::vector<float> result(luminance_.size());
  pool.for_each(static_cast<size_t>(height_), CancelFlag{}, [&](size_t row, int) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width_; ++x)
      for (int at = std::max(y - 1, 0); at <= std::min(y + 1, height_ - 1); ++at)
        for (int along = std::max(x - 1, 0); along <= std::min(x + 1, width_ - 1); ++along)
          if (is_source(static_cast<size_t>(at) * width_ + along)) result[row * width_ + x] = 1;
  });
  return result;
}

// After one pass.
std::vector<float> ErrorEstimate::differences_of_neighbours(ThreadPool& pool) const {
  std::vector<float> result(luminance_.size());
  pool.for_each(static_cast<size_t>(height_), CancelFlag{}, [&](size_t y, int) {
    for (int x = 0; x < width_; ++x) {
      const size_t at = y * width_ + x;
      const float right = luminance_[x + 1 < width_ ? at + 1 : at],
                  up = luminance_[y + 1 < static_cast<size_t>(height_) ? at + width_ : at];
      result[at] = 0.25f * ((luminance_[at] - right) * (luminance_[at] - right) +
                            (luminance_[at] - up) * (luminance_[at] - up));
      // Neighbours share most of their photons
      result[at] += kNoisePerDetail * detail_squares_[at];
    }
  });
  return result;
}

// A pixel's slope is that of its small blocks, of which there are many. Large blocks are few, but a
// tenth of the picture has enough of them: its variance is taken from blocks of a quarter of all
// passes or more, and from smaller ones where those leave passes out. They say nothing about which
// pixel falls into which tenth, so that no tenth is made of those that happened to look noisy.
// Pixels beside sources are a group of their own: one lamp would speak for a tenth of the picture.
void ErrorEstimate::correct_by_group(const std::vector<std::vector<float>>& own,
                                     const std::vector<float>& sources, const std::vector<float>& k,
                                     const std::vector<float>& pairs, ThreadPool& pool) {
  std::vector<size_t> large;
  std::vector<float> large_k, large_pairs;
  const float passes = static_cast<float>(passes_);
  float known = 0;  // the most passes that pairs of one size hold
  for (size_t i = k.size(); i-- > 0;) {
    if (4 * k[i] < passes && known >= kKnown * passes) break;
    known = std::max(known, 2 * k[i] * pairs[i]);
    large.push_back(i);
    large_k.push_back(k[i]);
    large_pairs.push_back(pairs[i]);
  }
  std::vector<float> sorted;
  for (size_t at = 0, step = 1 + variance_.size() / kSorted; at < variance_.size(); at += step)
    if (sources.empty() || !(sources[at] > 0)) sorted.push_back(variance_[at]);
  std::sort(sorted.begin(), sorted.end());
  float limits[kGroups - 1];
  for (int g = 0; g + 1 < kGroups; ++g)
    limits[g] = sorted.empty() ? 0 : sorted[sorted.size() * (g + 1) / kGroups];
  const auto group_of = [&](size_t at) -> long {
    if (!sources.empty() && sources[at] > 0) return kGroups;
    return std::upper_bound(limits, limits + kGroups - 1, variance_[at]) - limits;
  };
  // Of each group: what it sums up, and the number of its pixels
  const size_t figures = large.size() + 2, all = (kGroups + 1) * figures;
  std::vector<double> parts((variance_.size() + kPart - 1) / kPart * all), sums(all);
  pool.for_parts(variance_.size(), kPart, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t at = begin; at < end; ++at) {
      double* part = &parts[begin / kPart * all + static_cast<size_t>(group_of(at)) * figures];
      for (size_t i = 0; i < large.size(); ++i) part[i] += own[large[i]][at];
      part[large.size()] += variance_[at];
      ++part[large.size() + 1];
    }
  });
  for (size_t i = 0; i < parts.size(); ++i) sums[i % all] += parts[i];
  const PowerLaw law(passes_, large_k, large_pairs, kLentInGroup, kOfGroup);
  float factor[kGroups + 1];
  for (size_t g = 0; g <= kGroups; ++g) {
    const double* sum = &sums[g * figures];
    const double count = std::max(sum[large.size() + 1], 1.0);
    const float variance =
        law.variance([&](size_t i) { return static_cast<float>(sum[i] / count); });
    const double before = sum[large.size()] / count;
    factor[g] = std::isfinite(variance) && before > 0 && std::isfinite(before)
                    ? std::clamp(static_cast<float>(variance / before), 1 / kGroupStep, kGroupStep)
                    : 1;
    if (passes_ < kAllGroups) factor[g] = std::sqrt(factor[g]);
  }
  for_pixels(pool, variance_.size(), [&](size_t at) { variance_[at] *= factor[group_of(at)]; });
}

void ErrorEstimate::estimate_bias(ThreadPool& pool) {
  const float n = static_cast<float>(passes_);
  std::vector<float> square(detail_.size()), noise(detail_.size());
  for_pixels(pool, detail_.size(), [&](size_t i) {
    const float mean = detail_[i] / n;
    square[i] = mean * mean;
    noise[i] =
        passes_ > 1 ? std::max(0.0f, detail_squares_[i] / n - mean * mean) / (n - 1) : square[i];
  });
  std::vector<float> squares, noises;
  blur(square, width_, height_, 1, squares, pool);
  blur(noise, width_, height_, 1, noises, pool);
  for_pixels(pool, squares.size(), [&](size_t i) {
    squared_bias_[i] = kBiasPerDetail * kBiasPerDetail * std::max(0.0f, squares[i] - noises[i]);
  });
}

void ErrorEstimate::update(ThreadPool& pool) {
  if (estimated_ == passes_ || luminance_.empty()) return;
  estimated_ = passes_;
  estimate_variance(pool);
  estimate_bias(pool);
  make_figures(pool);
}

void ErrorEstimate::make_figures(ThreadPool& pool) {
  const size_t count = error_.size();
  for_pixels(pool, count, [&](size_t i) {
    // Squares of what is barely a float are none any more.
    for (float* square : {&variance_[i], &squared_bias_[i]})
      if (!(*square < kMost)) *square = kMost;
    error_[i] = std::sqrt(variance_[i] + squared_bias_[i]);
  });
  const double mean = mean_of(pool, count, [&](size_t i) { return luminance_[i] / samples_[i]; }),
               variance = mean_of(pool, count, [&](size_t i) { return variance_[i]; }),
               bias = mean_of(pool, count, [&](size_t i) { return squared_bias_[i]; });
  figures_ = {0, 0, 0, mean};
  if (mean > 0)
    figures_ = {std::sqrt(variance + bias) / mean, std::sqrt(variance) / mean,
                std::sqrt(bias) / mean, mean};
}

}  // namespace photon_splat
