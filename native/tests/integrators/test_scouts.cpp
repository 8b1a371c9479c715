// Tiles that tell about the whole picture before the others are traced.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "integrators/camera_tracer.h"

using namespace photon_splat;

namespace {

constexpr size_t kParts = 6;  // of the picture, along each side

struct Scouts {
  size_t all = 0, tiles = 0;
  std::array<size_t, kParts * kParts> parts{};
};

Scouts scouts_of(int width, int height) {
  PackedFilm film;
  film.reset(width, height);
  Scouts s;
  s.tiles = film.tiles();
  for (size_t t = 0; t < film.tiles(); ++t) {
    if (!CameraTracer::scouts(film, t)) continue;
    ++s.all;
    const size_t pixel = film.pixel_of(t, 0, 0);
    ++s.parts[pixel / width * kParts / height * kParts + pixel % width * kParts / width];
  }
  return s;
}

}  // namespace

TEST_CASE("scouts: an eighth of the tiles, and no more for a larger picture") {
  CHECK(scouts_of(640, 360).all == doctest::Approx(40 * 23 / 8.0).epsilon(0.02));
  for (const auto& [width, height] :
       {std::pair(960, 540), {1920, 1080}, {1080, 1920}, {3840, 2160}, {7680, 4320}, {65536, 64}}) {
    CAPTURE(width);
    const Scouts s = scouts_of(width, height);
    CHECK(s.all >= 128);
    CHECK(s.all <= std::max<size_t>(320, s.tiles / 64 + 1));
    CHECK(s.tiles >= 8 * s.all);
  }
}

TEST_CASE("scouts are all over the picture") {
  for (const auto& [width, height] :
       {std::pair(960, 540), {1920, 1080}, {2048, 2048}, {1080, 1920}}) {
    CAPTURE(width);
    const Scouts s = scouts_of(width, height);
    const auto [least, most] = std::ranges::minmax(s.parts);
    CHECK(least >= 1);
    CHECK(most <= 3 * least + 3);
  }
}
