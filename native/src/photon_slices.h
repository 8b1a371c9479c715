// Photons of a render's passes, kept for renders of other views: slice by slice what a run of paths has left anywhere.
#pragma once

#include <map>

#include "photons.h"

namespace photon_splat {

class PhotonSlices {
 public:
  // What paths first .. first + count - 1 left; nullptr where that is not kept.
  const std::vector<Photon>* find(uint64_t first, uint64_t count) const {
    const auto it = slices_.find(first);
    return it == slices_.end() || it->second.paths != count ? nullptr : &it->second.photons;
  }
  // Keeps a copy of them, if it takes no more than `most_bytes`; from the first that does not fit on, none is taken.
  void add(uint64_t first, uint64_t count, const std::vector<Photon>& photons, size_t most_bytes) {
    const size_t size = photons.size() * sizeof(Photon);
    full_ = full_ || size > most_bytes;
    if (full_ || slices_.contains(first)) return;
    slices_[first] = {count, photons};
    bytes_ += size;
  }
  bool full() const { return full_; }
  size_t bytes() const { return bytes_; }

 private:
  struct Slice {
    uint64_t paths = 0;
    std::vector<Photon> photons;
  };
  std::map<uint64_t, Slice> slices_;  // by their first path
  size_t bytes_ = 0;
  bool full_ = false;
};

}  // namespace photon_splat
