#pragma once

namespace photon_splat {

// Throws std::runtime_error unless the Embree that this process has loaded is of version 4.
void check_embree_version();

}  // namespace photon_splat
