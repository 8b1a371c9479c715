// What a pass is made of: camera samples where the noise is, and as many photons as are worth their
// work beside them, from what the passes before have shown.
#pragma once

#include <array>
#include <vector>

#include "film/packed_film.h"
#include "util/parallel.h"

namespace photon_splat {

// Photons of one kind in a pass. Of n photons that a kernel weighs by Epanechnikov the estimate has
// a relative variance of 4/(3n).
struct PhotonSet {
  // Of caustic photons: what caustic_ring, caustic_glass and small_glass have, or more. In scenes
  // that are not about caustics it is .0003 to .06 (village, street, kitchen, car, chapel).
  static constexpr double kGreatShare = 0.16;
  // Standard deviation of what a pass' photons add to each pixel's luminance; written by the
  // renderer
  std::vector<float> noise;
  double work = 0;                 // of the last pass, in the unit of PassWork
  double last = 1, count = 1;      // in the last pass and in the next, over those of the first
  double fewest = 0.25, most = 8;  // bounds of that; both 1 where all passes have to have as many
  // So many for noise that no pixel shows, as far as they are cheap beside the camera's samples
  double wanted = 0;

  // Sum of the squared errors of all pixels, each error times its weight, for as many photons as
  // the first pass has; noise above `limit` counts as `limit`
  double variance(const std::vector<float>& weights, double limit) const;
  double unit_work() const { return work / last; }
  // Sets `count` for a first pass, of which nothing is known but the share of its paths that bring
  // light to where it is seen. The smaller that is, the more work is each of those photons, and as
  // many are worth theirs as the root of it says.
  void begin_with_share(double share) {
    count = std::clamp(std::sqrt(share / kGreatShare), fewest, 1.0);
  }
};

// Work of a pass beside that of its photons, in any unit.
struct PassWork {
  double samples = 1;  // of one camera sample in each pixel
  double fixed = 0;
};

// A sum of squared errors, each over the light around it, falls fastest, for equal work, where
// samples go as the standard deviation of one of them over the root of its work (Neyman
// allocation). With s_i that of a pixel's camera samples, S the variance that photons add, summed
// over pixels, and r the work of one camera sample in each of n pixels over that of a pass' photons
// and what is fixed, n_i = s_i sqrt(n / (r S)) camera samples are for the photons of a first pass.
// But a pixel has one at the least, and some work is fixed: then more photons pay, as (g sum
// s_i^2/n_i + S/m) (C + m w), with C the work of all but photons and w that of those, is least for
// m^2 = S C / (w g sum s_i^2/n_i). g: low-discrepancy samples of the camera err less than their
// deviations say. Choices are made from pass 1, 2, 4, 8, ..., when another begins, and are for the
// passes that follow: samples never judge themselves.
//
// A denoiser brings every pixel's error to the root of what it was, and dark places count as much
// as bright ones: then all pixels have `least` samples, if photons leave so many worth their work,
// before some get more.
class AdaptiveSampler {
 public:
  static constexpr double kMostMean = 8;  // see set_most_mean(): passes stay short

  void reset(int width, int height, uint32_t least, std::vector<PhotonSet> photons);
  void set_least(uint32_t least) { least_ = least; }
  // Samples of a pass over its pixels: not many more
  void set_most_mean(double most) { most_mean_ = most; }
  // Sets the samples of each pixel in the first pass
  void begin_with(uint32_t count) { count_.assign(count_.size(), static_cast<uint16_t>(count)); }

  // Those of pixel i alone
  void begin_with(size_t i, uint32_t count) { count_[i] = static_cast<uint16_t>(count); }

  // What an earlier generation has seen and chosen, as one that follows goes on from it.
  struct Known {
    // Of a pixel: moments of the camera's light and of all light, what photons add to the variance
    // of one sample, samples so far, camera's light and samples at the last choice, and samples in
    // the next pass
    enum {
      kCamera,
      kCameraSquares,
      kAll,
      kAllSquares,
      kByPhotons,
      kSamples,
      kThen,
      kSamplesThen,
      kCount,
      kNumbers
    };
    using Pixel = std::array<float, kNumbers>;
    std::vector<Pixel> pixels;
    uint32_t passes = 0;
    std::vector<double> photons;  // of each set in the next pass, over those of the first
  };
  Known seen() const;
  // Counts once begin_part() is called. std::invalid_argument for another number of pixels.
  void go_on(Known earlier);
  // What has been learnt stays, and samples begin anew, or go on where the earlier generation has
  // ended.
  void begin_part();

  // Before the samples of a pass are asked for; again does no harm.
  void begin_pass(ThreadPool& pool);
  // Samples of pixel i in pass `pass` of the film: numbers [first, first + count) of its sequence.
  uint32_t first(size_t i, uint32_t pass) const { return pass + extra_[i]; }
  uint32_t count(size_t i) const { return count_[i]; }
  double mean_count() const;                           // of all pixels, in the next pass
  bool lacks_pixels() const { return lacks_pixels_; }  // the next pass
  PhotonSet& photons(size_t set) { return photons_[set]; }
  const PhotonSet& photons(size_t set) const { return photons_[set]; }
  // Photons of the next pass over those of the first, by their work.
  double photon_count() const;
  // Fewer in the passes until the next choice: one sample of each pixel and the same part of those
  // beyond it, so that they are `mean` at most, and the same part of all photons, so that
  // photon_count() is at most `photons`. A mean below 1: a pass without some of the pixels, which
  // has to be the last, as choices and estimates do not count it.
  void limit(double mean, double photons, ThreadPool& pool);

  // The pass' film when it holds what camera paths found, and again when photons have been added.
  void see_camera(const PackedFilm& pass, ThreadPool& pool);
  // The samples of a pass are done: the next begins after them. Enough where nothing is adaptive.
  void count_pass();
  // The same, for choices to come. Noise and work of the photons are known by now.
  void end_pass(const PackedFilm& pass, const PassWork& work, ThreadPool& pool);

 private:
  // Luminance of a pass' samples, weighted by their number.
  struct Moments {
    std::vector<float> sum, squares;
    void reset(size_t pixels);
    void add(size_t i, float mean, float samples);
    float variance(size_t i, float samples, float passes) const;  // of one sample
  };
  void see(const PackedFilm& pass, Moments& moments, ThreadPool& pool) const;
  struct Rings {
    std::vector<float> near, far;
  };
  Rings rings(const std::vector<float>& values, float of_none, ThreadPool& pool) const;
  Rings variances(ThreadPool& pool) const;
  std::vector<float> deviations(const std::vector<float>& weights, ThreadPool& pool) const;
  std::vector<float> first_deviations(ThreadPool& pool) const;
  std::vector<float> weights(ThreadPool& pool) const;
  void choose(std::vector<float> deviations, const std::vector<float>& weights);
  double gain_of_order(const std::vector<float>& deviations, const std::vector<float>& weights,
                       double limit);
  void choose_photons(const std::vector<float>& weights, double limit, double camera_variance);

  int width_ = 0, height_ = 0;
  Known earlier_;
  uint32_t passes_ = 0, least_ = 1;
  double most_mean_ = kMostMean;
  bool to_choose_ = false, lacks_pixels_ = false;
  PassWork work_;  // of the last pass
  Moments camera_, all_;
  std::vector<PhotonSet> photons_;
  // Sum of the camera's samples, and their number, at the last choice
  std::vector<float> then_, samples_then_;
  std::vector<float> by_photons_;  // what they add to the variance of one sample, sums over passes
  std::vector<float> samples_;     // so far
  std::vector<uint32_t> extra_;    // samples so far beyond one a pass
  std::vector<uint16_t> count_;
};

}  // namespace photon_splat
