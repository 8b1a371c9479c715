// Passes of a renderer that has been built, as the session makes them.
#pragma once

#include "render/renderer.h"

namespace photon_splat {

inline void render_passes(Renderer& renderer, uint32_t passes, bool reference) {
  for (uint32_t pass = 0; pass < passes; ++pass) {
    if (reference) {
      renderer.trace_reference(pass);
      continue;
    }
    renderer.trace_camera(pass);
    for (size_t layer = 0; layer < renderer.layer_count(); ++layer) {
      renderer.select_layer(layer);
      renderer.make_points(pass);
      renderer.trace_photons(0, renderer.paths_per_pass());
      renderer.splat();
    }
    renderer.resolve();
  }
}

}  // namespace photon_splat
