// Image textures: 8-bit pixels stay 8-bit, float pixels stay float.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sampling.h"

namespace photon_splat {

enum class Interpolation { kLinear, kClosest };
enum class Extension { kRepeat, kExtend, kClip, kMirror };

struct Texture {
  int width = 0, height = 0;
  bool srgb = false;
  Interpolation interpolation = Interpolation::kLinear;
  Extension extension = Extension::kRepeat;
  std::vector<uint8_t> bytes;   // RGBA rows from v = 0 up, or
  std::vector<float> floats;    // the same in float

  // Linear RGB at uv; black where kClip ends the image. Stored values are interpolated, then decoded, as Cycles does.
  Rgb lookup(Vec2 uv) const;

 private:
  Rgb texel(int x, int y) const;  // as stored
  Rgb decode(const Rgb& stored) const;
};

}  // namespace photon_splat
