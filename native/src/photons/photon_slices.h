// Photons of a render's passes, kept for renders of other views: slice by slice what a run of paths
// has left anywhere.
#pragma once

#include <map>

#include "photons/photons.h"

namespace photon_splat {

class PhotonSlices {
 public:
  struct Slice {
    uint64_t paths = 0;
    Photons photons;
    std::vector<int16_t> light_groups;  // of the photons, or empty
  };
  // What paths first .. first + count - 1 left; nullptr where that is not kept.
  const Slice* find(uint64_t first, uint64_t count) const {
    const auto it = slices_.find(first);
    return it == slices_.end() || it->second.paths != count ? nullptr : &it->second;
  }
  // Keeps a copy of them, if it takes no more than `most_bytes`; from the first that does not fit
  // on, none is taken.
  void add(uint64_t first, uint64_t count, const Photons& photons,
           const std::vector<int16_t>& light_groups, size_t most_bytes) {
    const size_t size = photons.size() * sizeof(Photon) + light_groups.size() * sizeof(int16_t);
    full_ = full_ || size > most_bytes;
    if (full_ || slices_.contains(first)) return;
    slices_[first] = {count, photons, light_groups};
    bytes_ += size;
  }
  bool full() const { return full_; }
  size_t bytes() const { return bytes_; }

 private:
  std::map<uint64_t, Slice> slices_;  // by their first path
  size_t bytes_ = 0;
  bool full_ = false;
};

}  // namespace photon_splat
