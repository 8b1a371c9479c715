#pragma once

namespace photon_splat {

// A splatter outside of the native module, such as one on a graphics card. It works on the selected
// photon map: reads its points, finds the pairs of the batch (Renderer::find_pairs) and writes sums
// into the blocks. Each call returns false where it cannot go on: then the photons of the map are
// traced and splatted anew by the native splatter. All calls come from the thread of the render.
class ExternalSplatter {
 public:
  virtual ~ExternalSplatter() = default;
  virtual bool begin_pass() = 0;   // the points are there
  virtual bool add_photons() = 0;  // the latest batch
  virtual bool finish_pass() = 0;  // the sums are to be in the points
};

}  // namespace photon_splat
