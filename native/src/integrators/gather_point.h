#pragma once

#include "film/lobe_category.h"
#include "math/vec.h"
#include "util/large_pages.h"

namespace photon_splat {

// A place where a camera path asks for indirect irradiance E: its pixel gets throughput * E. A path
// may leave any number of gather points; nothing downstream knows the camera.
struct GatherPoint {
  Vec3 position;
  uint32_t key;
  Vec3 ng;
  float footprint;  // width of a camera sample there, m
  Rgb throughput;   // albedo / pi times what the path gathered on its way
  uint32_t pixel;
  uint32_t instance, triangle;
  uint32_t offset;  // of the normal that E is wanted on, encode_offset(); 0: none
  LobeCategory category;
  bool caustics_only = false;  // indirect light comes by the camera path itself
  bool after_gather = false;   // the path has gone on from such a place
};

using GatherPoints = LargeArray<GatherPoint>;

}  // namespace photon_splat
