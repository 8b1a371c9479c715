// The camera that materials see.
#pragma once

#include "math/vec.h"
#include "scene/panorama.h"

namespace photon_splat {

// The camera as the nodes Camera Data, Texture Coordinate and Vector Transform see it.
struct ShadingView {
  Affine camera_to_world;  // looks along +Z, Y up; relative to the scene's origin
  Affine world_to_camera;
  // Edges of the frame on z = 1 (perspective) or in metres
  float left = -1, right = 1, bottom = -1, top = 1;
  bool orthographic = false;
  PanoramaSettings panorama;  // kind kNone: the frame is flat
};

}  // namespace photon_splat
