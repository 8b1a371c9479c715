// Photons of a render's passes, kept for renders of other views: each batch by its paths, to be
// found again and splatted in turn. (ViewportPhotons is another thing: one set of photons that
// grows, and is splatted at once.)
#pragma once

#include <map>

#include "photons/photon.h"

namespace photon_splat {

class PhotonCache {
 public:
  struct Batch {
    uint64_t paths = 0;
    Photons photons;
    std::vector<int16_t> light_groups;  // of the photons, or empty
  };
  // What paths first .. first + count - 1 left; nullptr where that is not kept.
  const Batch* find(uint64_t first, uint64_t count) const {
    const auto it = batches_.find(first);
    return it == batches_.end() || it->second.paths != count ? nullptr : &it->second;
  }
  // Keeps a copy of them, if it takes no more than `most_bytes`; from the first that does not fit
  // on, none is taken. Returns the bytes taken.
  size_t add(uint64_t first, uint64_t count, const Photons& photons,
             const std::vector<int16_t>& light_groups, size_t most_bytes) {
    const size_t size = photons.size() * sizeof(Photon) + light_groups.size() * sizeof(int16_t);
    full_ = full_ || size > most_bytes;
    if (full_ || batches_.contains(first)) return 0;
    batches_[first] = {count, photons, light_groups};
    bytes_ += size;
    return size;
  }
  bool full() const { return full_; }
  size_t bytes() const { return bytes_; }

 private:
  std::map<uint64_t, Batch> batches_;  // by their first path
  size_t bytes_ = 0;
  bool full_ = false;
};

}  // namespace photon_splat
