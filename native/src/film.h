// Sums over camera samples, per pixel of the rendered region. Row 0 is the bottom row.
#pragma once

#include <vector>

#include "vec.h"

namespace photon_splat {

struct Pixel {
  Rgb diffuse_direct, diffuse_indirect;  // albedo included
  Rgb diffuse_color, emission, environment, normal;
  float alpha = 0, photon_density = 0;
  float detail = 0;                      // luminance that discs of half the area would take away
  float depth = 0, surface_id = 0;       // of the first sample
};

// All light of a pixel: the Combined pass.
inline Rgb radiance(const Pixel& p) { return p.diffuse_direct + p.diffuse_indirect + p.emission + p.environment; }

inline constexpr float kBackgroundDepth = 1e10f;

struct Film {
  int width = 0, height = 0;
  uint32_t samples = 0;  // camera samples per pixel so far
  std::vector<Pixel> pixels;

  void reset(int new_width, int new_height) {
    width = new_width;
    height = new_height;
    samples = 0;
    pixels.assign(static_cast<size_t>(width) * height, Pixel{});
  }
};

// Adds one sample's film to the sum; the first one gives depth and surface id.
void add_sample(Film& sum, const Film& sample, class ThreadPool& pool);

}  // namespace photon_splat
