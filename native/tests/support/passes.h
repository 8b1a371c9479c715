// Passes of a renderer that has been built.
#pragma once

#include "render/renderer.h"

namespace photon_splat {

inline void render_passes(Renderer& renderer, uint32_t passes, bool reference) {
  for (uint32_t pass = 0; pass < passes; ++pass)
    reference ? renderer.trace_reference(pass) : renderer.render_pass(pass);
}

}  // namespace photon_splat
