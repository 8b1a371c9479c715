#include "film/adaptive_sampler.h"

#include <bit>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace photon_splat {
namespace {

constexpr int kReach = 2;         // pixels around one that tell after one sample
constexpr float kFurther = 0.1f;  // weight of those that are not next to it
constexpr double kGolden = 0.6180339887;
constexpr double kMost = 256;     // samples of a pixel in one pass
constexpr double kOutlier = 100;  // times the mean deviation: more counts as that much
constexpr double kLeastWork = 0.05;
// Of the camera's work, what photons may cost for noise that no pixel shows
constexpr double kCheap = 0.25;
// Errors count beside the light around them; where there is less than this part of the picture's
// mean, beside about that.
constexpr float kDark = 0.2f;
// Times the variance of photons is their squared error, where radii balance the two: see
// AdaptiveRadius
constexpr double kWithBlur = 1.5;
// Variance of low-discrepancy samples over that of random ones: before it is known, and the
// smallest that is believed.
constexpr double kUsualOrder = 0.5, kBestOrder = 0.05;

float known(float variance) { return variance < 1e30f ? variance : 0; }

// Deviations above count as much as this; `all`: the sum of those of so many pixels.
double outlier_limit(double all, size_t pixels) {
  return kOutlier * all / static_cast<double>(std::max<size_t>(pixels, 1));
}

// Powers of two, the nearest in ratio.
uint32_t rounded(double samples, double least) {
  return std::bit_floor(static_cast<uint32_t>(std::clamp(samples, least, kMost) * std::sqrt(2.0)));
}

// Steps of a quarter octave: how one splatter or another rounds its sums changes no photon count.
double stepped(double count) {
  return count > 0 ? std::exp2(std::round(4 * std::log2(count)) / 4) : 0;
}

}  // namespace

void AdaptiveSampler::Moments::reset(size_t pixels) {
  sum.assign(pixels, 0.0f);
  squares.assign(pixels, 0.0f);
}

void AdaptiveSampler::Moments::add(size_t i, float mean, float samples) {
  sum[i] += mean * samples;
  squares[i] += mean * mean * samples;
}

float AdaptiveSampler::Moments::variance(size_t i, float samples, float passes) const {
  return std::max(0.0f, squares[i] - sum[i] * sum[i] / samples) / (passes - 1);
}

double PhotonSet::variance(const std::vector<float>& weights, double limit) const {
  double sum = 0;
  for (size_t i = 0; i < noise.size(); ++i) {
    const double n = static_cast<double>(noise[i]) * weights[i];
    sum += std::pow(n < limit ? n : limit, 2);
  }
  return sum * last;
}

void AdaptiveSampler::reset(int width, int height, uint32_t least, std::vector<PhotonSet> photons) {
  least_ = least;
  width_ = width;
  height_ = height;
  passes_ = 0;
  to_choose_ = lacks_pixels_ = false;
  const size_t pixels = static_cast<size_t>(width) * height;
  camera_.reset(pixels);
  all_.reset(pixels);
  photons_ = std::move(photons);
  for (PhotonSet& set : photons_) set.noise.assign(pixels, 0.0f);
  by_photons_.assign(pixels, 0.0f);
  samples_.assign(pixels, 0.0f);
  earlier_ = {};
  then_ = samples_then_ = {};
  extra_.assign(pixels, 0);
  count_.assign(pixels, 1);
}

AdaptiveSampler::Known AdaptiveSampler::seen() const {
  Known out;
  out.passes = passes_;
  for (const PhotonSet& set : photons_) out.photons.push_back(set.count);
  out.pixels.resize(samples_.size());
  for (size_t i = 0; i < samples_.size(); ++i) {
    Known::Pixel& to = out.pixels[i];
    to[Known::kCamera] = camera_.sum[i], to[Known::kCameraSquares] = camera_.squares[i];
    to[Known::kAll] = all_.sum[i], to[Known::kAllSquares] = all_.squares[i];
    to[Known::kByPhotons] = by_photons_[i];
    to[Known::kSamples] = samples_[i];
    if (!then_.empty()) to[Known::kThen] = then_[i], to[Known::kSamplesThen] = samples_then_[i];
    to[Known::kCount] = static_cast<float>(count_[i]);
  }
  return out;
}

void AdaptiveSampler::go_on(Known earlier) {
  if (earlier.pixels.size() != samples_.size())
    throw std::invalid_argument("the samples of each pixel are known or of none");
  earlier_ = std::move(earlier);
}

void AdaptiveSampler::begin_part() {
  extra_.assign(extra_.size(), 0);
  if (earlier_.pixels.empty()) return;
  const Known earlier = std::exchange(earlier_, {});
  then_.resize(samples_.size());
  samples_then_.resize(samples_.size());
  for (size_t i = 0; i < earlier.pixels.size(); ++i) {
    const Known::Pixel& from = earlier.pixels[i];
    camera_.sum[i] = from[Known::kCamera], camera_.squares[i] = from[Known::kCameraSquares];
    all_.sum[i] = from[Known::kAll], all_.squares[i] = from[Known::kAllSquares];
    by_photons_[i] = from[Known::kByPhotons];
    samples_[i] = from[Known::kSamples];
    extra_[i] = static_cast<uint32_t>(from[Known::kSamples]);
    then_[i] = from[Known::kThen], samples_then_[i] = from[Known::kSamplesThen];
    count_[i] = static_cast<uint16_t>(std::clamp<double>(from[Known::kCount], 1, kMost));
  }
  passes_ = earlier.passes;
  to_choose_ = std::has_single_bit(passes_);
  for (size_t s = 0; s < photons_.size() && s < earlier.photons.size(); ++s) {
    PhotonSet& set = photons_[s];  // its noise and work are of the last pass here
    const double more = earlier.photons[s] / set.last;
    if (!(more > 0)) continue;
    for (float& noise : set.noise) noise /= static_cast<float>(std::sqrt(more));
    set.work *= more;
    set.last = set.count = earlier.photons[s];
  }
}

void AdaptiveSampler::see(const PackedFilm& pass, Moments& moments, ThreadPool& pool) const {
  const CancelFlag never;
  pool.for_each(pass.tiles(), never, [&](size_t t, int) {
    PackedFilm::Sums sums;
    pass.see(t, sums);
    pass.each(t, [&](size_t i, size_t place) {
      const float samples = sums.samples[place];
      moments.add(i, sums.luminance[place] * (samples > 0 ? 1 / samples : 0), samples);
    });
  });
}

double AdaptiveSampler::mean_count() const {
  return count_.empty() ? 1
                        : std::accumulate(count_.begin(), count_.end(), 0.0) /
                              static_cast<double>(count_.size());
}

void AdaptiveSampler::see_camera(const PackedFilm& pass, ThreadPool& pool) {
  see(pass, camera_, pool);
}

double AdaptiveSampler::photon_count() const {
  double first = 0, next = 0;
  for (const PhotonSet& set : photons_) {
    first += set.unit_work();
    next += set.unit_work() * set.count;
  }
  return first > 0 ? next / first : 1;
}

void AdaptiveSampler::count_pass() {
  for (size_t i = 0; i < count_.size(); ++i) {
    samples_[i] += count_[i];
    extra_[i] += count_[i] - 1u;
  }
  lacks_pixels_ = false;
}

void AdaptiveSampler::end_pass(const PackedFilm& pass, const PassWork& work, ThreadPool& pool) {
  count_pass();
  see(pass, all_, pool);
  const CancelFlag never;
  pool.for_each(pass.tiles(), never, [&](size_t t, int) {
    PackedFilm::Sums sums;
    pass.see(t, sums);
    pass.each(t, [&](size_t i, size_t place) {
      for (const PhotonSet& set : photons_)
        by_photons_[i] += sums.samples[place] * set.noise[i] * set.noise[i];
    });
  });
  for (PhotonSet& set : photons_) set.last = set.count;
  to_choose_ = std::has_single_bit(++passes_);
  work_ = work;
}

void AdaptiveSampler::limit(double mean, double photons, ThreadPool& pool) {
  begin_pass(pool);
  const double all = mean_count();
  lacks_pixels_ = mean < 1;
  if (all > mean) {
    const double least = lacks_pixels_ ? 0 : 1, part = std::max(mean - least, 0.0) / (all - least);
    double due = 0;  // and not given yet: what is left over goes to the next pixel
    for (size_t i = 0; i < count_.size(); ++i) {
      if (lacks_pixels_ && i % width_ == 0)  // else a column would have some in every row
        due = std::fmod(kGolden * static_cast<double>(i / width_), 1.0);
      due += least + part * (count_[i] - least);
      count_[i] = static_cast<uint16_t>(due);
      due -= count_[i];
    }
  }
  const double share = std::min(1.0, photons / photon_count());
  for (PhotonSet& set : photons_)
    if (set.fewest < set.most) set.count *= share;
}

void AdaptiveSampler::begin_pass(ThreadPool& pool) {
  if (to_choose_) {
    const std::vector<float> weights = this->weights(pool);
    choose(passes_ > 1 ? deviations(weights, pool) : first_deviations(pool), weights);
  }
  to_choose_ = false;
}

// Variance of one sample, estimated from the pixels around. The pixel's own samples have no say:
// what is bright by chance would get more samples than what is dark by chance, and the mean come
// out too dark. Variance of photons' light near edges counts as well.
AdaptiveSampler::Rings AdaptiveSampler::variances(ThreadPool& pool) const {
  std::vector<float> own(samples_.size());
  const CancelFlag never;
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    for (size_t i = row * width_; i < (row + 1) * width_; ++i) {
      const float samples = std::max(samples_[i], 1.0f), passes = static_cast<float>(passes_);
      const float all = known(all_.variance(i, samples, passes)),
                  camera = known(camera_.variance(i, samples, passes));
      own[i] = std::max(camera, all - known(by_photons_[i] / passes));
    }
  });
  return rings(own, 0, pool);
}

// Where a few bright samples are most of the noise, what is found around a pixel is chance: as far
// as pixels next to it and those two away do not agree, the deviation is taken for that of the
// picture (Spearman and Brown's share of two halves that agree so much).
std::vector<float> AdaptiveSampler::deviations(const std::vector<float>& weights,
                                               ThreadPool& pool) const {
  Rings around = variances(pool);
  const size_t pixels = weights.size();
  double all = 0;
  for (size_t i = 0; i < pixels; ++i) all += weights[i] * std::sqrt(around.near[i]);
  const double limit = outlier_limit(all, pixels);
  double mean = 0, near2 = 0, far2 = 0, both = 0, mean_near = 0, mean_far = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const double near = std::min(limit, double{weights[i]} * std::sqrt(around.near[i])),
                 far = std::min(limit, double{weights[i]} * std::sqrt(around.far[i]));
    mean_near += near, mean_far += far;
    near2 += near * near, far2 += far * far, both += near * far;
    mean += std::min(limit, weights[i] * std::sqrt(0.5 * (around.near[i] + around.far[i])));
  }
  const double n = static_cast<double>(std::max<size_t>(pixels, 1));
  const double covariance = both / n - mean_near / n * mean_far / n,
               variances = std::sqrt(std::max(near2 / n - std::pow(mean_near / n, 2), 0.0) *
                                     std::max(far2 / n - std::pow(mean_far / n, 2), 0.0));
  const double alike = variances > 0 ? std::clamp(covariance / variances, 0.0, 1.0) : 1;
  const double believed = 2 * alike / (1 + alike);
  std::vector<float> result(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const double found = weights[i] * std::sqrt(0.5 * (around.near[i] + around.far[i]));
    result[i] = static_cast<float>((mean / n + believed * (found - mean / n)) / weights[i]);
  }
  return result;
}

// Means over the pixels next to each one and over those two away; the pixel itself is left out.
AdaptiveSampler::Rings AdaptiveSampler::rings(const std::vector<float>& values, float of_none,
                                              ThreadPool& pool) const {
  Rings found{std::vector<float>(values.size()), std::vector<float>(values.size())};
  const CancelFlag never;
  pool.for_each(static_cast<size_t>(height_), never, [&](size_t row, int) {
    const int y = static_cast<int>(row);
    const int top = std::max(y - kReach, 0), bottom = std::min(y + kReach, height_ - 1);
    for (int x = 0; x < width_; ++x) {
      const int left = std::max(x - kReach, 0), right = std::min(x + kReach, width_ - 1);
      float near = 0, far = 0;
      int near_count = 0, far_count = 0;
      for (int at = top; at <= bottom; ++at)
        for (int along = left; along <= right; ++along) {
          const float value = values[static_cast<size_t>(at) * width_ + along];
          const int away = std::max(std::abs(at - y), std::abs(along - x));
          if (away == 1) near += value, ++near_count;
          if (away == 2) far += value, ++far_count;
        }
      const size_t i = row * width_ + x;
      found.near[i] = near_count ? near / static_cast<float>(near_count) : of_none;
      found.far[i] = far_count ? far / static_cast<float>(far_count) : found.near[i];
    }
  });
  return found;
}

// Deviations of one sample after the first pass, from differences between neighbours at most two
// pixels away. What is seen only further than one pixel away counts little, but an edge that is as
// bright as a lamp is not to be missed. Light of photons differs little between such neighbours,
// except at edges. A first pass of more samples knows light better, and photons still as badly:
// variances count as much more. Without that `village` has 9 % more variance in equal time.
std::vector<float> AdaptiveSampler::first_deviations(ThreadPool& pool) const {
  std::vector<float> light(all_.sum);
  float most = 1;
  for (size_t i = 0; i < light.size(); ++i) {
    light[i] /= std::max(samples_[i], 1.0f);
    most = std::max(most, samples_[i]);
  }
  std::vector<float> across(light.size()), down(light.size()), result(light.size());
  const CancelFlag never;
  const auto rows = [&](auto&& work) {
    pool.for_each(static_cast<size_t>(height_), never,
                  [&](size_t row, int) { work(static_cast<int>(row)); });
  };
  const auto of_one = [&](size_t a, size_t b) {
    const float difference = light[a] - light[b],
                scale = 1 / std::max(samples_[a], 1.0f) + 1 / std::max(samples_[b], 1.0f);
    return known(most * difference * difference / scale);
  };
  rows([&](int y) {  // each pixel and the next one of its row, or of the next row
    for (int x = 0; x < width_; ++x) {
      const size_t i = static_cast<size_t>(y) * width_ + x;
      if (x + 1 < width_) across[i] = of_one(i, i + 1);
      if (y + 1 < height_) down[i] = of_one(i, i + width_);
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

// What an error counts for in each pixel, by the light of those around it: its own samples have no
// say here either.
std::vector<float> AdaptiveSampler::weights(ThreadPool& pool) const {
  std::vector<float> light(samples_.size());
  double all = 0;
  for (size_t i = 0; i < light.size(); ++i)
    all += light[i] = std::max(known(all_.sum[i] / std::max(samples_[i], 1.0f)), 0.0f);
  const float mean =
      static_cast<float>(all / std::max<double>(static_cast<double>(light.size()), 1));
  if (!(mean > 0)) return std::vector<float>(light.size(), 1.0f);
  Rings around = rings(light, mean, pool);
  std::vector<float>& result = around.near;
  for (size_t i = 0; i < result.size(); ++i)
    result[i] = mean / std::hypot(0.5f * (result[i] + around.far[i]), kDark * mean);
  return result;
}

void AdaptiveSampler::choose(std::vector<float> deviations, const std::vector<float>& weights) {
  const double pixels = static_cast<double>(deviations.size());
  double all = 0, wanted = 0, photons = 0, photon_work = work_.fixed;
  for (size_t i = 0; i < deviations.size(); ++i) {
    float variance = deviations[i] * deviations[i];
    for (const PhotonSet& set : photons_) variance += set.noise[i] * set.noise[i];
    all += weights[i] * std::sqrt(known(variance));
    deviations[i] *= weights[i];
  }
  const double limit = outlier_limit(all, deviations.size());
  for (const float d : deviations) wanted += std::min<double>(d, limit);
  for (const PhotonSet& set : photons_) {
    photons += set.variance(weights, limit);
    photon_work += set.unit_work();
  }
  const double relative_work = photon_work > 0 ? work_.samples / photon_work : 1;
  const double worth = std::sqrt(photons / pixels * std::max(relative_work, kLeastWork));
  const double least =
      std::clamp(worth > 0 ? wanted / pixels / worth : kMost, 1.0, static_cast<double>(least_));
  const double unit = std::max(worth, wanted / pixels / most_mean_);
  double remaining = 0;
  for (size_t i = 0; i < count_.size(); ++i) {
    const double d = std::min<double>(deviations[i], limit);
    count_[i] = static_cast<uint16_t>(unit > 0 ? rounded(d / unit, least) : 1);
    remaining += d * d / count_[i];
  }
  choose_photons(weights, limit, remaining * gain_of_order(deviations, weights, limit));
}

// By how much the mean of low-discrepancy samples varies less than that of random ones with the
// same deviations, as the passes since the last choice differ from those before it.
double AdaptiveSampler::gain_of_order(const std::vector<float>& deviations,
                                      const std::vector<float>& weights, double limit) {
  double found = 0, random = 0;
  if (passes_ > 1)
    for (size_t i = 0; i < samples_.size(); ++i) {
      const float before = samples_then_[i], since = samples_[i] - before;
      const double difference =
          weights[i] * known(then_[i] / before - (camera_.sum[i] - then_[i]) / since);
      const double of_one = 1 / before + 1 / since;
      found += std::min(difference * difference, limit * limit * of_one);
      random += std::pow(std::min<double>(deviations[i], limit), 2) * of_one;
    }
  then_ = camera_.sum;
  samples_then_ = samples_;
  return random > 0 ? std::clamp(found / random, kBestOrder, 1.0) : kUsualOrder;
}

void AdaptiveSampler::choose_photons(const std::vector<float>& weights, double limit,
                                     double camera_variance) {
  const double others = work_.fixed + work_.samples * mean_count();
  for (PhotonSet& set : photons_) {
    const double variance = set.variance(weights, limit);
    if (!(set.work > 0)) continue;
    const double pays =
        variance > 0
            ? std::sqrt(kWithBlur * variance / camera_variance * (others / set.unit_work()))
            : 0;
    const double cheap = std::min(set.wanted, kCheap * others / set.unit_work());
    set.count = std::clamp(stepped(std::max(pays, cheap)), set.fewest, set.most);
  }
}

}  // namespace photon_splat
