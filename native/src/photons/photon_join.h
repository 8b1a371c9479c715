// Joins what runs of paths leave that several threads trace, in the order of the runs.
#pragma once

#include <memory>
#include <mutex>

#include "photons/path_worth.h"
#include "photons/photon.h"
#include "photons/photon_beam.h"
#include "util/parallel.h"

namespace photon_splat {

// Mean square of their powers over the squared mean, 1 to 32: so many times the noise of equal
// photons is that of these.
float power_dispersion(const Photons& photons);

struct PhotonRun {
  Photons photons;
  std::vector<int16_t> groups;  // light groups of the photons, or empty
  std::vector<PhotonBeam> beams;
  std::vector<PathWorth::Stop> stops;  // in media, where those are learnt from,
  double brought = 0;                  // and squared powers of what is of use
  uint64_t rays = 0, shaded = 0;

  void clear() {
    photons.clear();
    beams.clear();
    stops.clear();
    brought = 0;
    groups.clear();
    rays = shaded = 0;
  }
};

// Runs are copied to their place as soon as those before them are there, while they are still in
// the thread's cache; their memory serves again. Where there are more photons than were expected,
// the others follow at the end.
class PhotonJoin {
 public:
  void begin(size_t runs, size_t expected_photons, bool with_groups);
  // To be called by any thread: a run to fill, and to hand one in that is full.
  std::unique_ptr<PhotonRun> take();
  void add(size_t number, std::unique_ptr<PhotonRun> run);
  // When all have been handed in.
  void finish(ThreadPool& pool, const CancelFlag& cancel);
  void clear();

  const Photons& photons() const { return photons_; }
  const std::vector<int16_t>& groups() const { return groups_; }
  const std::vector<PhotonBeam>& beams() const { return beams_; }
  const std::vector<PathWorth::Stop>& stops() const { return stops_; }
  double brought() const { return brought_; }
  uint64_t rays() const { return rays_; }
  uint64_t shaded() const { return shaded_; }

 private:
  void put(const PhotonRun& run, Photon* photons, int16_t* groups) const;
  void count(const PhotonRun& run);

  Photons photons_;
  std::vector<int16_t> groups_;
  std::vector<PhotonBeam> beams_;
  std::vector<PathWorth::Stop> stops_;
  double brought_ = 0;
  bool with_groups_ = false;
  uint64_t rays_ = 0, shaded_ = 0;
  // Guards what follows, and the sizes of what is above
  std::unique_ptr<std::mutex> mutex_ = std::make_unique<std::mutex>();
  std::vector<std::unique_ptr<PhotonRun>> runs_, spare_;
  size_t next_ = 0;  // run to be put into its place
};

}  // namespace photon_splat
