// How near the photon tracer comes to Embree alone, on the ways of the same photons backwards, in
// their order, with the same flags and threads.
#pragma once

#include "render/renderer.h"

namespace photon_splat {

struct TracerBench {
  uint64_t rays = 0, embree_rays = 0;
  double tracer_seconds = 0, intersect1_seconds = 0, intersect8_seconds = 0,
         intersect16_seconds = 0;
};

// Needs a built renderer. Traces `paths` photon paths once to warm up and once timed; then Embree
// traces from each photon that is left back to where it came from.
TracerBench bench_photon_tracer(Renderer& renderer, uint64_t paths);

}  // namespace photon_splat
