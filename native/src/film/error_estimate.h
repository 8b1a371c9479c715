// How far each pixel may be from what all passes together would show: its noise from differences
// between passes, its blur from discs of two sizes.
#pragma once

#include "film/error_sums.h"
#include "film/packed_film.h"
#include "util/parallel.h"

namespace photon_splat {

// Luminances, in the film's unit. relative_rmse = sqrt(mean of the squared errors) / mean
// luminance; standard_error and bias are its two parts, bias^2 + standard_error^2 =
// relative_rmse^2. All 0 for a black picture.
struct ErrorFigures {
  double relative_rmse = 0, standard_error = 0, bias = 0, mean_luminance = 0;
  // Of films whose sums have been added: the variance by how they differ from each other, over that
  // by what each knows of itself; 0 where there is but one.
  double between = 0;
};

// Low-discrepancy samples make the mean of n passes better than the passes' variance / n says: that
// overestimates the error of smooth edges up to eightfold. So passes are compared in aligned blocks
// of 1, 2, 4, ... of them, each a digital net of its own. Neighbouring blocks of k passes, of
// variance V(k) = c k^-a, differ by D(k) = V(k) (2 - 2^(1-a)) (half the mean squared difference;
// the two halves of a net are negatively correlated); a and c are fitted to the pixel's D at all k.
// A pass of s samples of a pixel counts as having a variance in proportion to s^(-3/2): pixels get
// many where edges and lamps are sampled, by low-discrepancy points. The mean weighs passes by s:
// its variance goes as (sum of s^(1/2)) / (sum of s)^2.
class ErrorEstimate {
 public:
  void reset(int width, int height);
  // One pass; call it for all of them.
  void add(const PackedFilm& pass, ThreadPool& pool);
  // Makes the estimate from the passes so far; after one pass alone, from how neighbouring pixels
  // differ.
  void update(ThreadPool& pool);

  // After update()
  ErrorSums sums() const;
  // Instead of passes: sums over `films` films, of that film's luminance and samples. update() then
  // has nothing to do.
  void restore(const ErrorSums& sums, const PackedFilm& film, uint32_t films, ThreadPool& pool);

  uint32_t passes() const { return passes_; }
  // Per pixel, of the last update()
  const std::vector<float>& error() const { return error_; }
  const std::vector<float>& variance() const { return variance_; }          // likewise, of the mean
  const std::vector<float>& squared_bias() const { return squared_bias_; }  // likewise
  const ErrorFigures& figures() const { return figures_; }

 private:
  void estimate_variance(ThreadPool& pool);
  std::vector<float> differences_of_neighbours(ThreadPool& pool) const;
  std::vector<float> beside_sources(ThreadPool& pool) const;
  void correct_by_group(const std::vector<std::vector<float>>& own,
                        const std::vector<float>& sources, const std::vector<float>& k,
                        const std::vector<float>& pairs, ThreadPool& pool);
  void estimate_bias(ThreadPool& pool);
  void make_figures(ThreadPool& pool);

  struct Level {
    // Sums of the block that waits for its neighbour; the last of s^(1/2)
    std::vector<float> open, open_samples, open_noise;
    // Squared differences of neighbouring blocks' means, as if each pass had one sample
    std::vector<float> squares;
    std::vector<float> weights;  // of those: passes of more samples tell more
    uint32_t pairs = 0;
  };
  int width_ = 0, height_ = 0;
  uint32_t passes_ = 0, estimated_ = 0;  // so far; at the last update()
  std::vector<Level> levels_;            // of blocks of 1, 2, 4, ... passes
  // Sums over samples; sources_: the part of luminance_ that comes straight from what emits, and in
  // how many passes there was some
  std::vector<float> luminance_, samples_, sources_, source_passes_;
  std::vector<float> noises_;                   // sum over passes of the root of their samples
  std::vector<float> detail_, detail_squares_;  // sums over passes, each its mean
  std::vector<float> error_, variance_, squared_bias_;
  ErrorFigures figures_;
};

}  // namespace photon_splat
