#pragma once

#include <cstdint>

namespace photon_splat {

// The light of a pixel by the first lobe of the path that brought it; kVolume: a medium scattered
// it.
enum class LobeCategory : uint8_t { kDiffuse, kGlossy, kTransmission, kVolume };

}  // namespace photon_splat
