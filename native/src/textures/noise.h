// Fractals of Perlin noise (Musgrave; Ebert et al., "Texturing and modeling", chapter 16), all
// octaves that wait computed at once.
#pragma once

#include "shading/ops.h"
#include "textures/noise_kernel.h"

namespace photon_splat::nodes {

struct Frame;

template <int N>
struct Point {
  float c[N];
};

struct FractalSettings {
  float roughness, lacunarity, offset, gain;  // roughness >= 0
  NoiseType type;
  bool normalize;
  int detail;        // whole octaves beyond the first, and
  float part;        // what counts of one more
  uint32_t octaves;  // that are asked for, so

  void set_detail(float octaves_beyond);  // taken as in 0..15
};

// The fractal from the noise of its octaves.
float fractal_of(const float* noise, const FractalSettings& s);

// Textures whose noise is wanted. It is computed, and their registers are set, when as many are
// there as `together` says: one call of a kernel (simd/noise_kernel.inl) for many points costs less
// than many for a few.
class NoiseQueue {
 public:
  // A texture whose octaves, of one fractal or several, are points from `first` on. finish() sets
  // its registers and reads none: others may have been written since.
  struct Texture {
    const uint32_t* w;
    FractalSettings settings;
    float carried[2];
    uint32_t first;
    void (*finish)(Frame& f, const Texture& texture, const float* noise);
  };

  uint32_t together = 0;  // textures that the next evaluation is for; 0: like 1

  // A texture to be filled in; then, if it asks for noise, add() and its octaves, of `points` in
  // all.
  Texture& next() { return waiting_[textures_]; }
  template <int N>
  void add(Frame& f, uint32_t points);
  template <int N>
  void add_octaves(Point<N> p);  // of the texture added last
  // After each texture, whether it has asked for noise or not.
  void finish_texture(Frame& f);

 private:
  void evaluate(Frame& f);
  template <int N>
  void add_point(const Point<N>& p);

  static constexpr uint32_t kMost = NoisePoints::kMost - NoisePoints::kPadding;
  uint32_t points_ = 0, textures_ = 0;
  int dimensions_ = 0;
  NoisePoints at_;
  Texture waiting_[kMost + 1];
};

}  // namespace photon_splat::nodes
