// Camera samples where the noise is: how many each pixel gets in a pass, from what the passes before have shown.
#pragma once

#include <vector>

#include "film.h"
#include "parallel.h"

namespace photon_splat {

// A sum of squared errors falls fastest, for equal work, where samples go as the standard deviation of one of them (Neyman
// allocation). With s_i that of a pixel's camera samples alone - lamps, emission, direct light -, S the variance that photons
// add, summed over pixels, and r the work of one camera sample in each of n pixels over that of a pass' photons,
// (sum s_i^2/n_i + S) (r sum n_i / n + 1) is least for n_i = s_i sqrt(n / (r S)). Choices are made from pass 1, 2, 4, 8, ..., when another
// begins, and are for the passes that follow: samples never judge themselves.
//
// A denoiser brings every pixel's error to the root of what it was, and dark places count as much as bright ones: then all pixels have
// `least` samples, if photons leave so many worth their work, before some get more.
class SampleChoice {
 public:
  void reset(int width, int height, uint32_t least = 1);
  void set_least(uint32_t least) { least_ = least; }

  // Before the samples of a pass are asked for; again does no harm.
  void begin_pass(ThreadPool& pool);
  // Of pixel i in pass `pass` of the film: numbers [first, first + count) of its sequence.
  uint32_t first(size_t i, uint32_t pass) const { return pass + extra_[i]; }
  uint32_t count(size_t i) const { return count_[i]; }
  double mean_count() const;  // of all pixels, in the next pass
  // Fewer in the passes until the next choice, the same part of each pixel's, so that they are at most `mean`; one at the least.
  void limit(double mean, ThreadPool& pool);

  // The pass' film when it holds what camera paths found, and again when photons have been added.
  void see_camera(const Film& pass, ThreadPool& pool);
  // `work`: r above.
  void end_pass(const Film& pass, double work, ThreadPool& pool);

 private:
  // Luminance of a pass' samples, weighted by their number.
  struct Moments {
    std::vector<float> sum, squares;
    void reset(size_t pixels);
    void add(size_t i, float mean, float samples);
    float variance(size_t i, float samples, float passes) const;  // of one sample
  };
  void see(const Film& pass, Moments& moments, ThreadPool& pool) const;
  std::vector<float> deviations(const Moments& moments, ThreadPool& pool) const;
  std::vector<float> first_deviations(const Moments& moments, ThreadPool& pool) const;
  void choose(const std::vector<float>& camera, const std::vector<float>& all);

  int width_ = 0, height_ = 0;
  uint32_t passes_ = 0, least_ = 1;
  bool to_choose_ = false;
  double work_ = 1;             // of the last pass
  Moments camera_, all_;
  std::vector<float> samples_;  // so far
  std::vector<uint32_t> extra_;  // samples so far beyond one a pass
  std::vector<uint16_t> count_;
};

}  // namespace photon_splat
