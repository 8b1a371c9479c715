// The film of a render: the sum of its passes, the pass that is being made, and how far the sum may
// be off.
#pragma once

#include "film/error_estimate.h"
#include "film/packed_film.h"

namespace photon_splat {

class RenderFilm {
 public:
  // Which channels of pixels are kept, before reset(); what passes need is among them.
  void keep_channels(const ChannelMask& channels) {
    sum_.kept = pass_.kept = channels | channels_of_passes();
  }
  // Empty, for another view.
  void reset(int width, int height, int light_groups);
  // What the next stages add to; until end_pass() the sum is that of the passes before. `channels`:
  // of those that are kept, only these.
  PackedFilm& begin_pass(const ChannelMask& channels = all_channels());
  PackedFilm& pass() { return pass_; }
  void end_pass(ThreadPool& pool);
  // Instead of passes: a sum that has been made elsewhere, of `films` films, with its errors. The
  // film has been reset to its size.
  void restore(PackedFilm sum, const ErrorSums& errors, uint32_t films, ThreadPool& pool);
  // No pass follows: gives back memory that passes alone need.
  void end_passes() { pass_.release(); }

  const PackedFilm& sum() const { return sum_; }
  // All of it at once, for tests: a copy, until it is asked for again.
  const Film& unpacked() const;
  size_t bytes() const { return sum_.bytes() + pass_.bytes(); }
  // Brought up to date by errors().update().
  ErrorEstimate& errors() { return errors_; }
  const ErrorEstimate& errors() const { return errors_; }

 private:
  PackedFilm sum_, pass_;
  mutable Film unpacked_;
  mutable bool is_unpacked_ = false;
  ErrorEstimate errors_;
};

}  // namespace photon_splat
