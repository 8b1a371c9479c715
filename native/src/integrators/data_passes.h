// Passes that tell what is seen instead of how it is lit, from camera rays of their own: whoever
// wants none of them pays nothing.
#pragma once

#include <array>
#include <span>

#include "integrators/motion_vectors.h"
#include "math/random_streams.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace photon_splat {

// What compositors call things. Ids are those of Cryptomatte: hashes that are floats (Friedman and
// Jones 2015).
struct DataLabels {
  // By pass of its own and material, into Scene::programs; -1: none. What run_displacement() finds.
  std::vector<std::vector<int32_t>> programs;
  std::span<const int32_t> object_index, material_index;    // by instance, by material
  std::span<const float> object_id, asset_id, material_id;  // the same
  const NeighbouringFrames* frames = nullptr;               // or null: nothing tells of motion
};

struct Mist {
  float start = 0, depth = 100, power = 2;  // m, m, of the distance's share
};

struct DataSettings {
  uint32_t samples = 32;  // of each pixel
  uint32_t levels = 0;    // ids of a pixel that each of the mattes keeps; 0: no mattes
  uint32_t seed = 0;
  float alpha_threshold = 0.5f;  // what is less opaque is no first surface
  Mist mist;
};

// By pixel, row 0 at the bottom.
struct DataPasses {
  // From the first surface of the first sample, as in Cycles
  std::vector<float> position, object_index, material_index;
  // Means over the samples: of first surfaces, of all that is seen, and of what programs find up to
  // the first surface, with how much of the pixel has such
  std::vector<float> uv, mist;
  std::vector<std::vector<float>> values;
  // Mean over the samples that see anything, the world too: x and y, from the frame before and to
  // the one after
  std::vector<float> vector;
  // Mattes of objects, assets, materials: `levels` pairs of id and coverage, the greatest first
  std::array<std::vector<float>, 3> mattes;
};

// Throws Cancelled; std::invalid_argument where labels are missing.
DataPasses trace_data_passes(Scene& scene, const Camera& camera, const DataLabels& labels,
                             const DataSettings& settings, const CancelFlag& cancel);

}  // namespace photon_splat
