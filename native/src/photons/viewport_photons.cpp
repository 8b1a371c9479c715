#include "photons/viewport_photons.h"

#include "math/random_streams.h"

namespace photon_splat {

void ViewportPhotons::trace(uint64_t paths, size_t most_bytes, const CancelFlag& cancel) {
  if (full_ || paths < 1) return;
  SurfaceFilter all;
  all.add_all();
  if (!paths_)
    tracer_.learn_emission(paths, stream_seed(seed_, RandomStream::kPhotons), all, all, nullptr,
                           cancel);
  const Photons& traced = tracer_.trace(paths_, paths, 1.0, seed_, all, cancel);
  if (paths_ > 0 && (photons_.size() + traced.size()) * sizeof(Photon) > most_bytes) {
    full_ = true;
    return;
  }
  photons_.reserve(photons_.size() + traced.size());
  photons_.insert(photons_.end(), traced.begin(), traced.end());
  paths_ += paths;
  if (!radii_) radii_.emplace(scene_, photons_, static_cast<double>(paths_), RadiusMap::Settings{});
}

}  // namespace photon_splat
