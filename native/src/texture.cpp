#include "texture.h"

namespace photon_splat {
namespace {

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

// A coordinate that shows the same but keeps whole pixels in the range of integers; 0 for what is not finite.
float near_image(float x, Extension extension) {
  constexpr float kFar = 1e4f;
  if (std::abs(x) < kFar) return x;
  if (!std::isfinite(x)) return 0;
  if (extension == Extension::kRepeat) return x - std::floor(x);
  return extension == Extension::kMirror ? std::fmod(x, 2.0f) : std::clamp(x, -kFar, kFar);
}

// Weights of the uniform cubic B-spline for the texels -1, 0, 1, 2 around a fraction t.
std::array<float, 4> spline_weights(float t) {
  const float t2 = t * t, t3 = t2 * t, s = 1 - t;
  return {s * s * s * (1.0f / 6), (4 - 6 * t2 + 3 * t3) * (1.0f / 6), (1 + 3 * t + 3 * t2 - 3 * t3) * (1.0f / 6), t3 * (1.0f / 6)};
}

struct SrgbTable {
  float linear[256];
  SrgbTable() {
    for (int i = 0; i < 256; ++i) linear[i] = decode_srgb(static_cast<float>(i) * (1.0f / 255.0f));
  }
};

}  // namespace

float decode_srgb(float c) {
  if (c <= 0.04045f) return c < 0 ? 0 : c * (1 / 12.92f);
  return std::pow((c + 0.055f) * (1 / 1.055f), 2.4f);
}

float decode_srgb_byte(uint8_t c) {
  static const SrgbTable table;
  return table.linear[c];
}

Texture::Texel Texture::texel(int x, int y) const {
  x = wrap(x, width, extension);
  y = wrap(y, height, extension);
  if (x < 0 || y < 0) return {};
  const size_t at = 4 * (static_cast<size_t>(y) * width + x);
  Texel t;
  for (size_t c = 0; c < 4; ++c) t[c] = bytes.empty() ? floats[at + c] : static_cast<float>(bytes[at + c]) * (1.0f / 255.0f);
  return t;
}

Texture::Texel Texture::interpolated(Vec2 uv) const {
  uv = {near_image(uv.x, extension), near_image(uv.y, extension)};
  const float x = uv.x * static_cast<float>(width), y = uv.y * static_cast<float>(height);
  if (interpolation == Interpolation::kClosest) return texel(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
  const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
  const float s = x - 0.5f - fx, t = y - 0.5f - fy;
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  Texel sum{};
  const auto add = [&](int dx, int dy, float weight) {
    const Texel part = texel(ix + dx, iy + dy);
    for (size_t c = 0; c < 4; ++c) sum[c] += part[c] * weight;
  };
  if (interpolation == Interpolation::kCubic) {
    const auto wx = spline_weights(s), wy = spline_weights(t);
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) add(i - 1, j - 1, wx[i] * wy[j]);
  } else {
    add(0, 0, (1 - s) * (1 - t));
    add(1, 0, s * (1 - t));
    add(0, 1, (1 - s) * t);
    add(1, 1, s * t);
  }
  return sum;
}

std::array<float, 4> Texture::lookup_rgba(Vec2 uv, bool unassociate) const {
  Texel t = interpolated(uv);
  if (unassociate && t[3] != 0 && t[3] != 1)
    for (size_t c = 0; c < 3; ++c) t[c] /= t[3];
  if (srgb)
    for (size_t c = 0; c < 3; ++c) t[c] = decode_srgb(t[c]);
  return t;
}

Rgb Texture::lookup(Vec2 uv) const {
  const Texel t = lookup_rgba(uv, false);
  return {t[0], t[1], t[2]};
}

}  // namespace photon_splat
