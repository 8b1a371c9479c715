#include "math/sampling.h"

#include "simd/dispatch.h"

namespace photon_splat {

SobolKernel choose_sobol_kernel(const std::string& name) {
  return choose_variant<SobolKernel>(PHOTON_SPLAT_VARIANTS(sobol), name);
}

void SobolPair::fill(uint32_t first, uint32_t count, Run& out) const {
  static_assert(kMost % kSobolLanes == 0);
  static const SobolKernel kernel = choose_sobol_kernel();
  kernel({key_, x_key_, y_key_}, first, count, out.x, out.y);
}

}  // namespace photon_splat
