#include "render/photon_budget.h"

#include <algorithm>

namespace photon_splat {

uint64_t batch_that_fits(uint64_t wanted, uint64_t most, double left,
                         std::optional<double> path_seconds, bool whole) {
  const uint64_t batch = std::min(wanted, most);
  if (std::isinf(left)) return batch;
  if (!path_seconds)
    return whole || wanted <= 2 * kTrialPaths ? batch : std::min(batch, kTrialPaths);
  const double fitting = std::max(left, 0.0) / std::max(*path_seconds, 1e-12);
  if (fitting >= static_cast<double>(batch)) return batch;
  return whole || fitting < static_cast<double>(kFewestPaths) ? 0 : static_cast<uint64_t>(fitting);
}

}  // namespace photon_splat
