#include "film/packed_film.h"

#include <doctest/doctest.h>

#include <cstring>

#include "math/sampling.h"
#include "util/parallel.h"

using namespace photon_splat;

namespace {

// Of a diffuse room, as pass `pass` may leave it: edges of the picture that are no multiples of a
// tile's.
Film made(uint32_t pass, int width = 37, int height = 21) {
  Film film;
  film.reset(width, height);
  film.passes = 1;
  Random random(pass, 1);
  for (Pixel& p : film.pixels) {
    p = {};
    p.samples = 1 + float(pass % 2);
    p.alpha = p.samples;
    p.diffuse_direct = {random.next(), random.next(), random.next()};
    p.diffuse_indirect = {random.next(), 0, random.next()};
    p.depth = 3 + random.next();
    p.detail = random.next();
  }
  film.pixels[5].emission = {1, 2, 3};
  return film;
}

}  // namespace

TEST_CASE(
    "a packed film gives back what was put into it, and tells the same luminance bit for bit") {
  const Film film = made(1);
  const PackedFilm packed(film);
  Film back;
  packed.unpack(back);
  CHECK(std::memcmp(back.pixels.data(), film.pixels.data(), film.pixels.size() * sizeof(Pixel)) ==
        0);
  for (size_t t = 0; t < packed.tiles(); ++t) {
    PackedFilm::Sums sums;
    packed.see(t, sums);
    packed.each(t, [&](size_t i, size_t place) {
      CHECK(packed.place_in_tile(i) == place);
      CHECK(sums.luminance[place] == luminance(film.pixels[i].combined()));
      CHECK(sums.samples[place] == film.pixels[i].samples);
      CHECK(sums.detail[place] == film.pixels[i].detail);
    });
  }
}

TEST_CASE("passes are summed; depth and surface are those of the first") {
  ThreadPool pool(2);
  PackedFilm sum;
  sum.reset(37, 21);
  const Film first = made(0);
  std::vector<Pixel> expected(first.pixels.begin(), first.pixels.end());
  for (uint32_t pass = 0; pass < 3; ++pass) {
    const Film film = made(pass);
    PackedFilm packed(film);
    add_pass(sum, packed, pool);
    for (size_t i = 0; pass && i < expected.size(); ++i) {
      expected[i].diffuse_direct += film.pixels[i].diffuse_direct;
      expected[i].diffuse_indirect += film.pixels[i].diffuse_indirect;
      expected[i].emission += film.pixels[i].emission;
      expected[i].alpha += film.pixels[i].alpha;
      expected[i].samples += film.pixels[i].samples;
    }
  }
  CHECK(sum.passes == 3);
  Film film;
  sum.unpack(film);
  CHECK(std::memcmp(film.pixels.data(), expected.data(), expected.size() * sizeof(Pixel)) == 0);
}

TEST_CASE("what is not kept is 0, and takes no memory") {
  const Film film = made(2, 512, 512);
  PackedFilm all(film), some;
  some.kept = channels_of_passes();
  some.reset(512, 512);
  PackedFilm::Tile pixels;
  for (size_t t = 0; t < some.tiles(); ++t) {
    all.get(t, pixels);
    some.put(t, pixels);
  }
  Film back;
  back.passes = some.passes = 1;
  some.unpack(back);
  CHECK(back.pixels[7].depth == 0);
  CHECK(back.pixels[7].diffuse_direct.x == film.pixels[7].diffuse_direct.x);
  // Six of the floats that are kept vary, in one tile also the three of emission; of all it is one
  // more.
  CHECK(some.bytes() < 512 * 512 * 6 * 4 * 1.1);
  CHECK(all.bytes() > some.bytes() + 512 * 512 * 4 * 0.9);
  CHECK(all.bytes() < 512 * 512 * sizeof(Pixel) / 4);
}
