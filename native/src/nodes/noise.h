// Perlin noise in one to four dimensions and fractals of it.
#pragma once

#include "ops.h"

namespace photon_splat::nodes {

template <int N>
struct Point {
  float c[N];
};

struct FractalSettings {
  float detail, roughness, lacunarity, offset = 0, gain = 0;  // detail in 0..15, roughness >= 0
  NoiseType type = NoiseType::FBM;
  bool normalize = true;
};

template <int N>
float fractal_noise(Point<N> p, const FractalSettings& s);

}  // namespace photon_splat::nodes
