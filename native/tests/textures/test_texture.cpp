#include "textures/texture.h"

#include <doctest/doctest.h>

using namespace photon_splat;

namespace {

// Looks a texture up in many places before and after it is made compact; returns the bytes per
// pixel after.
size_t compacted(Texture texture, int width, int height) {
  texture.width = width;
  texture.height = height;
  Texture small = texture;
  small.compact();
  for (Interpolation interpolation :
       {Interpolation::kClosest, Interpolation::kLinear, Interpolation::kCubic})
    for (Extension extension : {Extension::kRepeat, Extension::kClip}) {
      texture.interpolation = small.interpolation = interpolation;
      texture.extension = small.extension = extension;
      for (int i = 0; i < 200; ++i) {
        const Vec2 uv{0.013f * static_cast<float>(i) - 0.7f, 0.029f * static_cast<float>(i) - 2.1f};
        for (bool unassociate : {false, true})
          CHECK(texture.lookup_rgba(uv, unassociate) == small.lookup_rgba(uv, unassociate));
      }
    }
  CHECK(small.memory() % static_cast<size_t>(width * height) == 0);
  return small.memory() / static_cast<size_t>(width * height);
}

template <class Value>
std::vector<float> floats(Value&& value) {
  std::vector<float> out;
  for (int i = 0; i < 4 * 20; ++i) out.push_back(i % 4 == 3 ? 1.0f : value(i));
  return out;
}

}  // namespace

TEST_CASE("pixels are kept in as many bits as they need, and look the same") {
  Texture bytes;
  for (int i = 0; i < 4 * 20; ++i) bytes.bytes.push_back(static_cast<uint8_t>(i * 37));
  CHECK(compacted(bytes, 5, 4) == 4);
  bytes.srgb = true;
  for (size_t i = 3; i < 80; i += 4) bytes.bytes[i] = 255;
  CHECK(compacted(bytes, 5, 4) == 3);
  for (size_t i = 0; i < 80; ++i)
    if (i % 4 < 3) bytes.bytes[i] = static_cast<uint8_t>(i / 4 * 11);
  CHECK(compacted(bytes, 4, 5) == 1);

  Texture deep;
  deep.floats = floats([](int i) { return 0.125f * static_cast<float>(i - 40); });
  CHECK(compacted(deep, 5, 4) == 6);
  deep.floats[7] = 0.5f;
  CHECK(compacted(deep, 5, 4) == 8);
  deep.floats = floats([](int i) { return static_cast<float>(i * 801) * (1.0f / 65535.0f); });
  CHECK(compacted(deep, 5, 4) == 6);
  for (float odd : {1e-5f, 1e6f, 0.1f, -0.3f}) {
    deep.floats = floats([odd](int i) { return i == 5 ? odd : 0.25f * static_cast<float>(i); });
    CHECK(compacted(deep, 5, 4) == 12);
  }
}
