#include "textures/texture.h"

#include <bit>

namespace photon_splat {
namespace {

constexpr float kShortUnit = 1.0f / 65535.0f;

// The value of a half float that is finite and no denormal.
float from_half(uint16_t h) {
  const float magnitude = std::bit_cast<float>(static_cast<uint32_t>(h & 0x7fff) << 13) * 0x1p112f;
  return h & 0x8000 ? -magnitude : magnitude;
}
uint16_t to_half(float x) {  // cut off, not rounded
  const uint32_t bits = std::bit_cast<uint32_t>(std::abs(x) * 0x1p-112f) >> 13;
  return static_cast<uint16_t>(bits | (std::signbit(x) ? 0x8000u : 0u));
}
bool fits_half(float x) {
  return x == 0 ||
         (std::abs(x) >= 0x1p-14f && std::abs(x) <= 65504.0f && from_half(to_half(x)) == x);
}
uint16_t to_short(float x) {
  return static_cast<uint16_t>(std::clamp(x, 0.0f, 1.0f) * 65535.0f + 0.5f);
}
bool fits_short(float x) { return static_cast<float>(to_short(x)) * kShortUnit == x; }

// Drops channels of RGBA pixels that say nothing: an alpha of `opaque` everywhere, then colours
// that are all grey.
template <class T>
int drop_channels(std::vector<T>& pixels, T opaque) {
  bool alpha = false, color = false;
  for (size_t i = 0; i < pixels.size(); i += 4) {
    alpha |= pixels[i + 3] != opaque;
    color |= pixels[i] != pixels[i + 1] || pixels[i] != pixels[i + 2];
  }
  if (alpha) return 4;
  const size_t kept = color ? 3 : 1;
  for (size_t i = 0, to = 0; i < pixels.size(); i += 4)
    for (size_t c = 0; c < kept; ++c) pixels[to++] = pixels[i + c];
  pixels.resize(pixels.size() / 4 * kept);
  pixels.shrink_to_fit();
  return static_cast<int>(kept);
}

template <class Convert>
std::vector<uint16_t> converted(std::vector<float>& floats, Convert&& convert) {
  std::vector<uint16_t> out(floats.size());
  std::transform(floats.begin(), floats.end(), out.begin(), convert);
  floats = {};
  return out;
}

int wrap(int i, int size, Extension extension) {
  switch (extension) {
    case Extension::kRepeat: {
      if (static_cast<uint32_t>(i) < static_cast<uint32_t>(size)) return i;
      return ((i % size) + size) % size;
    }
    case Extension::kMirror: {
      const int period = ((i % (2 * size)) + 2 * size) % (2 * size);
      return period < size ? period : 2 * size - 1 - period;
    }
    case Extension::kExtend: return std::clamp(i, 0, size - 1);
    case Extension::kClip:
    case Extension::kClipOpaque: return i < 0 || i >= size ? -1 : i;
  }
  return 0;
}

// A coordinate that shows the same but keeps whole pixels in the range of integers; 0 for what is
// not finite.
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
  return {s * s * s * (1.0f / 6), (4 - 6 * t2 + 3 * t3) * (1.0f / 6),
          (1 + 3 * t + 3 * t2 - 3 * t3) * (1.0f / 6), t3 * (1.0f / 6)};
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

namespace {

// Sum of size x size texels by the products of their weights. Columns and rows under 0 are outside
// of the image and black.
template <int size>
struct Window {
  int column[size], row[size];
  float across[size], up[size];

  template <int channels, class T, class Value>
  std::array<float, 4> sum(const T* pixels, int width, Value&& value) const {
    std::array<float, 4> sum{};
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        if (column[i] < 0 || row[j] < 0) continue;
        const T* p = pixels + channels * (static_cast<size_t>(row[j]) * width + column[i]);
        const float weight = across[i] * up[j];
        for (size_t c = 0; c < channels; ++c) sum[c] += value(p[c]) * weight;
        if (channels < 4) sum[3] += weight;
      }
    if (channels == 1) sum[1] = sum[2] = sum[0];
    return sum;
  }
  template <class T, class Value>
  std::array<float, 4> sum_of(const Texture& kept, const std::vector<T>& pixels,
                              Value&& value) const {
    if (kept.channels == 1) return sum<1>(pixels.data(), kept.width, value);
    return kept.channels == 3 ? sum<3>(pixels.data(), kept.width, value)
                              : sum<4>(pixels.data(), kept.width, value);
  }
  std::array<float, 4> sum_of(const Texture& kept) const {
    if (!kept.bytes.empty())
      return sum_of(kept, kept.bytes,
                    [](uint8_t x) { return static_cast<float>(x) * (1.0f / 255.0f); });
    if (!kept.floats.empty()) return sum_of(kept, kept.floats, [](float x) { return x; });
    if (kept.half) return sum_of(kept, kept.shorts, from_half);
    return sum_of(kept, kept.shorts, [](uint16_t x) { return static_cast<float>(x) * kShortUnit; });
  }
};

template <int size>
Window<size> window(const Texture& texture, int x, int y, const std::array<float, size>& across,
                    const std::array<float, size>& up) {
  Window<size> w;
  for (int i = 0; i < size; ++i) {
    w.column[i] = wrap(x + i, texture.width, texture.extension);
    w.row[i] = wrap(y + i, texture.height, texture.extension);
    w.across[i] = across[static_cast<size_t>(i)];
    w.up[i] = up[static_cast<size_t>(i)];
  }
  return w;
}

}  // namespace

void Texture::compact() {
  if (channels != 4) return;
  if (!bytes.empty()) {
    channels = drop_channels<uint8_t>(bytes, 255);
    return;
  }
  channels = drop_channels(floats, 1.0f);
  if (std::all_of(floats.begin(), floats.end(), fits_half)) {
    half = true;
    shorts = converted(floats, to_half);
  } else if (std::all_of(floats.begin(), floats.end(), fits_short)) {
    shorts = converted(floats, to_short);
  }
}

Texture Texture::reading(Interpolation other_interpolation, Extension other_extension) {
  if (!pixels_of) {
    auto kept = std::make_shared<Texture>(std::move(*this));
    width = kept->width;
    height = kept->height;
    bytes = {};
    shorts = {};
    floats = {};
    pixels_of = std::move(kept);
  }
  Texture other = *this;
  other.interpolation = other_interpolation;
  other.extension = other_extension;
  return other;
}

std::array<float, 4> Texture::interpolated(Vec2 uv) const {
  const Texture& kept = pixels_of ? *pixels_of : *this;
  uv = {near_image(uv.x, extension), near_image(uv.y, extension)};
  const float x = uv.x * static_cast<float>(width), y = uv.y * static_cast<float>(height);
  if (interpolation == Interpolation::kClosest)
    return window<1>(*this, static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)), {1},
                     {1})
        .sum_of(kept);
  const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
  const float s = x - 0.5f - fx, t = y - 0.5f - fy;
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  if (interpolation == Interpolation::kCubic)
    return window<4>(*this, ix - 1, iy - 1, spline_weights(s), spline_weights(t)).sum_of(kept);
  return window<2>(*this, ix, iy, {1 - s, s}, {1 - t, t}).sum_of(kept);
}

std::array<float, 4> Texture::lookup_rgba(Vec2 uv, bool unassociate) const {
  std::array<float, 4> t = interpolated(uv);
  if (extension == Extension::kClipOpaque) t[3] = 1;
  if (unassociate && t[3] != 0 && t[3] != 1)
    for (size_t c = 0; c < 3; ++c) t[c] /= t[3];
  if (srgb)
    for (size_t c = 0; c < 3; ++c) t[c] = decode_srgb(t[c]);
  return t;
}

Rgb Texture::lookup(Vec2 uv) const {
  const std::array<float, 4> t = lookup_rgba(uv, false);
  return {t[0], t[1], t[2]};
}

}  // namespace photon_splat
