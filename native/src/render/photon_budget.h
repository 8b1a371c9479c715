// How many photon paths are traced at once, and how many in all where a pass is short of time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>

namespace photon_splat {

struct PassLimits {
  double seconds = INFINITY;     // that the pass may take; it has one batch of photons at the least
  uint64_t paths_per_batch = 0;  // of photons; 0: as many as suit the points
};

// Photon paths of a trial, which tells how many more there is time for in the first pass if it
// wants more than twice as many.
inline constexpr uint64_t kTrialPaths = 1 << 16;
inline constexpr uint64_t kFewestPaths = 1 << 12;  // worth a batch where time is short

// How many of the `wanted` photon paths are to be traced next, `most` at once, if `left` seconds
// are left and one took `path_seconds` (none: nobody knows); 0 where there is no time for more.
// whole: no fewer than `most` or all.
uint64_t batch_that_fits(uint64_t wanted, uint64_t most, double left,
                         std::optional<double> path_seconds, bool whole);

class PassClock {
 public:
  explicit PassClock(double seconds) : seconds_(seconds), end_(now() + seconds) {}
  // Takes off the time for the end of the pass, which grows with that of the camera samples.
  void see_camera(double seconds) {
    resolving_ = kOfResolving * seconds;
    late_ = kLate * seconds;
  }
  double left() const { return std::max(end_ - now(), 0.0); }
  // Seconds that a first pass may be late by, rather than have fewer camera samples.
  double slack() const { return kSlack * seconds_; }
  // Seconds for the next of `maps` photon maps.
  double seconds_for_one_of(size_t maps) const {
    return std::max(end_ - now() - resolving_, late_) / static_cast<double>(maps);
  }
  static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

 private:
  // Seconds for the end of a pass, after all of its photons, over those of its camera samples
  static constexpr double kOfResolving = 0.15;
  // All passes count alike, and one of few photons spoils what those before have: where camera
  // samples have taken all of the time, photons have so much of theirs on top. cloudy_pool at
  // 1280x720 had 65,000 paths in a pass of 90 s.
  static constexpr double kLate = 0.1;
  static constexpr double kSlack = 0.25;
  double seconds_, end_, resolving_ = 0, late_ = 0;
};

}  // namespace photon_splat
