// Image textures: 8-bit pixels stay 8-bit, float pixels stay float.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sampling.h"

namespace photon_splat {

enum class Interpolation { kLinear, kClosest, kCubic };
enum class Extension { kRepeat, kExtend, kClip, kMirror };

float decode_srgb(float encoded);
float decode_srgb_byte(uint8_t encoded);

struct Texture {
  int width = 0, height = 0;
  bool srgb = false;
  Interpolation interpolation = Interpolation::kLinear;
  Extension extension = Extension::kRepeat;
  std::vector<uint8_t> bytes;   // RGBA rows from v = 0 up, or
  std::vector<float> floats;    // the same in float

  // Linear RGB at uv; black where kClip ends the image. Stored values are interpolated, then decoded, as Cycles does.
  Rgb lookup(Vec2 uv) const;
  // The same with alpha; `unassociate`: colour is divided by alpha before it is decoded.
  std::array<float, 4> lookup_rgba(Vec2 uv, bool unassociate) const;

 private:
  using Texel = std::array<float, 4>;
  Texel texel(int x, int y) const;  // as stored
  Texel interpolated(Vec2 uv) const;
};

}  // namespace photon_splat
