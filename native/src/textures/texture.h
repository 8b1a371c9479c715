// Image textures, kept in the depth their pixels need.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "math/sampling.h"

namespace photon_splat {

enum class Interpolation { kLinear, kClosest, kCubic };
// kClipOpaque: black outside, with an alpha of 1.
enum class Extension { kRepeat, kExtend, kClip, kMirror, kClipOpaque };

float decode_srgb(float encoded);
float decode_srgb_byte(uint8_t encoded);

struct Texture {
  int width = 0, height = 0;
  bool srgb = false;
  Interpolation interpolation = Interpolation::kLinear;
  Extension extension = Extension::kRepeat;
  // Rows from v = 0 up, in one of these.
  std::vector<uint8_t> bytes;
  std::vector<uint16_t> shorts;  // of 65535, or half floats
  std::vector<float> floats;
  bool half = false;  // what `shorts` are
  int channels = 4;   // RGBA; 3: opaque; 1: grey, opaque
  // Whose pixels these are, where an image is read in several ways: its own are empty
  std::shared_ptr<const Texture> pixels_of;

  // Keeps the same pixels in as few channels and bits as lose nothing.
  void compact();
  // Another reading of the same pixels, which are kept once.
  Texture reading(Interpolation other_interpolation, Extension other_extension);
  size_t memory() const { return bytes.size() + 2 * shorts.size() + 4 * floats.size(); }

  // Linear RGB at uv; black where the image ends for kClip. Stored values are interpolated, then
  // decoded, as Cycles does.
  Rgb lookup(Vec2 uv) const;
  // lookup() with alpha; `unassociate`: colour is divided by alpha before it is decoded.
  std::array<float, 4> lookup_rgba(Vec2 uv, bool unassociate) const;

 private:
  std::array<float, 4> interpolated(Vec2 uv) const;
};

}  // namespace photon_splat
