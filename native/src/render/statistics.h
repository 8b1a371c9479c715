// What a render tells of itself: seconds by stage, photons, rays, how the indirect light was
// brought.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "density/visible_points.h"
#include "film/error_estimate.h"
#include "photons/photon_tracer.h"

namespace photon_splat {

struct StageSeconds {
  double acceleration = 0, camera = 0, photons = 0, splat = 0, boundary = 0, error = 0;
  double pilot = 0;  // of those: what a render's first pass does beyond any other
  double with_photons() const { return photons + splat; }
};

// Adds the seconds of its life to a sum.
class Timer {
 public:
  explicit Timer(double& sum) : sum_(sum) {}
  ~Timer() {
    sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  double& sum_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

inline PhotonCounts since(const PhotonCounts& before, const PhotonCounts& now) {
  return {now.traced - before.traced, now.stored - before.stored, now.rays - before.rays,
          now.shaded - before.shaded};
}

// Counts of one photon map in this render.
struct PhotonMapStatistics {
  PhotonStream stream = PhotonStream::kAll;
  // Without the pilot, whose photons only choose radii; rays are all rays
  PhotonCounts photons{};
  PhotonCounts pilot{};
  bool guided = false;            // photons start where a pilot has found it useful, or are aimed
  uint64_t used = 0, reused = 0;  // photons handed to the splatter; those of them that were kept
  VisiblePoints::Counts discs{};
};

struct RenderStatistics {
  StageSeconds seconds;
  std::vector<PhotonMapStatistics> maps;  // indirect light, then caustics if they have their own
  PhotonCounts beams{};                   // caustic photons in media: paths, beams
  size_t kept_photon_bytes = 0;           // of all maps: photons that other renders find again
  uint64_t rays = 0;                      // of the camera and of photons
  int threads = 0, threads_wanted = 0;    // working; asked for
  std::string kernel;                     // of the splatter
  size_t visible_points = 0;              // of the selected photon map in the last pass
  uint64_t bad_samples = 0;  // left out as their light was not finite: 0 unless something is wrong
  ErrorFigures error;        // of the last estimate
  // Places where indirect light was wanted, and those where camera paths went on for it
  uint64_t places = 0, path_traced = 0;
  bool all_path_traced = false;    // paths bring all of the indirect light, caustics excepted
  bool gathers_after_all = false;  // final gathering, which has not been asked for
  bool world_path_traced = false;  // paths bring all of the world's light
};

}  // namespace photon_splat
