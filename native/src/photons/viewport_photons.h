// Photons that are kept while the camera moves: traced without regard to any view, they serve every
// view. With them come the radii that their density asks for, so that a surface looks the same from
// wherever it is seen, and nothing flickers.
#pragma once

#include <optional>

#include "density/radius_map.h"
#include "photons/photon_tracer.h"

namespace photon_splat {

class ViewportPhotons {
 public:
  ViewportPhotons(Scene& scene, const Lights& lights, int max_bounces, PhotonStream stream,
                  uint32_t seed)
      : scene_(scene), tracer_(scene, lights, max_bounces, stream), seed_(seed) {}

  // Traces `paths` more; the first call learns where photons start that come to lie anywhere at
  // all. Photons beyond `most_bytes` of memory are not taken in, nor are the paths that left them.
  // What was there stays as it is if this is cancelled.
  void trace(uint64_t paths, size_t most_bytes, const CancelFlag& cancel);

  // Powers are those of a set of one path: divide by paths().
  const Photons& photons() const { return photons_; }
  uint64_t paths() const { return paths_; }
  bool full() const { return full_; }
  size_t bytes() const { return photons_.capacity() * sizeof(Photon); }
  // Radii by the density that the first paths showed; nullptr before.
  const RadiusMap* radii() const { return radii_ ? &*radii_ : nullptr; }
  const PhotonCounts& counts() const { return tracer_.counts(); }

 private:
  Scene& scene_;
  PhotonTracer tracer_;
  uint32_t seed_;
  Photons photons_;
  std::optional<RadiusMap> radii_;
  uint64_t paths_ = 0;
  bool full_ = false;
};

}  // namespace photon_splat
