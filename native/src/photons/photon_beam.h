// Light on its way through media after at least one bounce: photons that light all of their flight,
// not only where it ends (Jarosz et al., A Comprehensive Theory of Volumetric Radiance Estimation
// using Photon Points and Beams, 2011).
#pragma once

#include "media/medium.h"

namespace photon_splat {

struct PhotonBeam {
  Vec3 origin, direction;  // m, relative to the scene's origin
  float length;            // m, as far as the next surface; may be infinite
  Rgb power;               // W, where it begins
  MediumStack media;       // around it
  uint16_t begin, end;     // normals of the surfaces between which it lies, encoded
  int16_t light_group;
  float time;
};

}  // namespace photon_splat
