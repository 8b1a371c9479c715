// Streams of random numbers that do not depend on each other, from one seed.
#pragma once

#include "math/sampling.h"

namespace photon_splat {

// Part of every picture: another number is another picture.
enum class RandomStream : uint32_t {
  kPhotons = 1,          // photon paths of the passes
  kCamera = 2,           // camera paths
  kPilot = 3,            // photon paths that radii are learnt from
  kEmissionPilot = 4,    // photon paths that their emission is learnt from
  kCausticPhotons = 5,   // the caustic photon map, which has all of these for itself
  kViewportPhotons = 5,  // photons that serve every view of a viewport, never beside those
  // Photons in media, which have all of the first four for themselves
  kCausticBeams = 6,
  kIndirectBeams = 7,
  kBeamTrial = 8,        // camera paths that tell whether there are to be those
  kPointGrid = 0x9017u,  // where the cells of visible points begin
};

inline uint32_t stream_seed(uint32_t seed, RandomStream stream) {
  return hash_combine(seed, static_cast<uint32_t>(stream));
}

// Pairs of dimensions of a photon path's low-discrepancy sequence.
enum class PhotonDimension : uint32_t {
  kEmitter = 0,      // which light, and a coin
  kPlace = 1,        // on it
  kDirection = 2,    // from there
  kFirstBounce = 3,  // direction after it
  kGuide = 4,        // cell of the emission guide
  kTime = 5,         // in the shutter's opening, and line of the picture
};

inline SobolPair photon_numbers(PhotonDimension pair, uint32_t seed) {
  return SobolPair(static_cast<uint32_t>(pair), seed);
}

}  // namespace photon_splat
