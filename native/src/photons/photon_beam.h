// Light on its way through media after at least one bounce: photons that light all of their flight,
// not only where it ends (Jarosz et al., A Comprehensive Theory of Volumetric Radiance Estimation
// using Photon Points and Beams, 2011).
#pragma once

#include "media/medium.h"

namespace photon_splat {

// What light of a path beams are left of, in media: the part that photons of the caustic stream
// store on surfaces, or the rest of it.
enum class BeamLight : uint8_t { kNone, kCaustic, kIndirect };

struct PhotonBeam {
  Vec3 origin, direction;  // m, relative to the scene's origin
  float length;            // m, as far as the next surface; may be infinite
  Rgb power;               // W, where it begins
  MediumStack media;       // around it
  // Normals of the surfaces between which it lies, encoded; kInside: it begins within a medium
  uint16_t begin, end;
  int16_t light_group;
  float time;

  static constexpr uint16_t kInside = 0xffff;
};

}  // namespace photon_splat
