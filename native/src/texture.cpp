#include "texture.h"

namespace photon_splat {
namespace {

float decode_srgb(float c) {
  if (c <= 0.04045f) return c / 12.92f;
  return std::pow((c + 0.055f) / 1.055f, 2.4f);
}

int wrap(int i, int size, Extension extension) {
  switch (extension) {
    case Extension::kRepeat: return ((i % size) + size) % size;
    case Extension::kMirror: {
      const int period = ((i % (2 * size)) + 2 * size) % (2 * size);
      return period < size ? period : 2 * size - 1 - period;
    }
    case Extension::kExtend: return std::clamp(i, 0, size - 1);
    case Extension::kClip: return i < 0 || i >= size ? -1 : i;
  }
  return 0;
}

}  // namespace

Rgb Texture::texel(int x, int y) const {
  x = wrap(x, width, extension);
  y = wrap(y, height, extension);
  if (x < 0 || y < 0) return {};
  const size_t at = 4 * (static_cast<size_t>(y) * width + x);
  if (!bytes.empty()) {
    const uint8_t* p = &bytes[at];
    return Rgb{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])} * (1.0f / 255.0f);
  }
  return {floats[at], floats[at + 1], floats[at + 2]};
}

Rgb Texture::decode(const Rgb& c) const {
  return srgb ? Rgb{decode_srgb(c.x), decode_srgb(c.y), decode_srgb(c.z)} : c;
}

Rgb Texture::lookup(Vec2 uv) const {
  // Far outside the unit square floats hold no fraction worth having; this also keeps the integers below in range.
  if (!(std::abs(uv.x) < 1e6f) || !(std::abs(uv.y) < 1e6f)) uv = {0, 0};
  const float x = uv.x * static_cast<float>(width), y = uv.y * static_cast<float>(height);
  if (interpolation == Interpolation::kClosest)
    return decode(texel(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y))));
  const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
  const float s = x - 0.5f - fx, t = y - 0.5f - fy;
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  return decode((texel(ix, iy) * (1 - s) + texel(ix + 1, iy) * s) * (1 - t) +
                (texel(ix, iy + 1) * (1 - s) + texel(ix + 1, iy + 1) * s) * t);
}

}  // namespace photon_splat
