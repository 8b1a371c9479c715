#pragma once

#include "film/adaptive_sampler.h"
#include "render/options.h"
#include "render/statistics.h"

namespace photon_splat {

// What all parts of a renderer have in common; it outlives them.
struct RenderContext {
  Scene& scene;
  const RenderOptions& options;
  const CancelFlag& cancel;
  AdaptiveSampler& sampler;
  StageSeconds& seconds;
  size_t& kept_bytes;  // of the photons that all photon maps keep for other renders
  bool& gathers;       // final gathering in this view, asked for or chosen in its first pass
};

}  // namespace photon_splat
