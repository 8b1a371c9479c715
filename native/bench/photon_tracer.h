// How near the photon tracer comes to Embree alone: the same rays in the same order, flags and
// threads.
#pragma once

#include "render/renderer.h"

namespace photon_splat {

struct TracerBench {
  uint64_t rays = 0;
  double tracer_seconds = 0, intersect1_seconds = 0, intersect8_seconds = 0,
         intersect16_seconds = 0;
};

// Needs a built renderer. Traces `paths` photon paths once to warm up, once timed, once with its
// rays logged; then replays the log.
TracerBench bench_photon_tracer(Renderer& renderer, uint64_t paths);

}  // namespace photon_splat
