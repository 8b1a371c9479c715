// A film in tiles, each with memory for what differs between its pixels alone: most sums of a pixel
// are 0 in most tiles.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>

#include "film/film.h"

namespace photon_splat {

inline constexpr size_t kPixelChannels = sizeof(Pixel) / sizeof(float);
using ChannelMask = std::bitset<kPixelChannels>;  // bit i: the i-th float of a Pixel
static_assert(sizeof(Pixel) == kPixelChannels * sizeof(float));

inline ChannelMask all_channels() { return ~ChannelMask{}; }
// The first of some.
inline size_t first_of(const ChannelMask& channels) {
  size_t c = 0;
  while (c < kPixelChannels && !channels[c]) ++c;
  return c;
}

// The channels of members of Pixel, named as &Pixel::alpha.
template <class... Member>
ChannelMask channels_of(Member Pixel::*... members) {
  const Pixel pixel;
  ChannelMask channels;
  const auto add = [&](const auto& member) {
    const size_t first =
        (reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&pixel)) /
        sizeof(float);
    for (size_t c = 0; c < sizeof(member) / sizeof(float); ++c) channels.set(first + c);
  };
  (add(pixel.*members), ...);
  return channels;
}

// What estimates and choices ask of a pass: all light, samples, and detail.
ChannelMask channels_of_passes();

class PackedFilm {
 public:
  static constexpr int kSide = 16;  // pixels along a tile
  // Row by row; pixels beyond the film's edges are there and mean nothing
  using Tile = std::array<Pixel, kSide * kSide>;
  struct Sums {
    float luminance[kSide * kSide], samples[kSide * kSide], detail[kSide * kSide];
    float sources[kSide * kSide];  // the part of luminance that comes straight from what emits
  };

  int width = 0, height = 0;
  uint32_t passes = 0;  // in it so far
  int light_groups = 0;
  // Light of each pixel by group, sums like those of the pixel
  LargeArray<Rgb> by_group;
  ChannelMask kept = all_channels();  // of what is put; the rest is 0

  PackedFilm() = default;
  PackedFilm(const Film& film);

  // Tiles are then to be put before they are read; of a sum of no passes there need not be any.
  void reset(int new_width, int new_height, int groups = 0);
  void release();  // its memory

  size_t size() const { return static_cast<size_t>(width) * height; }  // pixels
  size_t bytes() const;
  size_t tiles() const { return tiles_.size(); }
  // Calls work(pixel's place in the film, its place in the tile) for all pixels of tile t.
  template <class Work>
  void each(size_t t, Work&& work) const {
    each_run(t, [&](size_t first, size_t count, size_t place) {
      for (size_t i = 0; i < count; ++i) work(first + i, place + i);
    });
  }
  // each() for whole rows: work(index of the first in the film, pixels, index of the first in the
  // tile).
  template <class Work>
  void each_run(size_t t, Work&& work) const {
    const size_t across = tiles_along(width), x = t % across * kSide, y = t / across * kSide;
    const size_t columns = std::min<size_t>(kSide, width - x),
                 rows = std::min<size_t>(kSide, height - y);
    for (size_t row = 0; row < rows; ++row) work((y + row) * width + x, columns, row * kSide);
  }
  // Width and height of tile t, in pixels of the film.
  std::array<int, 2> extent_of(size_t t) const {
    const auto across = static_cast<int>(tiles_along(width)), x = static_cast<int>(t) % across,
               y = static_cast<int>(t) / across;
    return {std::min(kSide, width - x * kSide), std::min(kSide, height - y * kSide)};
  }
  // The place in the film of a pixel of tile t.
  size_t pixel_of(size_t t, int x, int y) const {
    const size_t across = tiles_along(width);
    return (t / across * kSide + y) * width + t % across * kSide + x;
  }
  size_t place_in_tile(size_t pixel) const {
    return pixel / width % kSide * kSide + pixel % width % kSide;
  }

  void put(size_t t, const Tile& pixels);
  void get(size_t t, Tile& pixels) const;
  void see(size_t t, Sums& sums) const;
  void unpack(Film& film) const;
  Rgb* groups_of(size_t pixel) { return light_groups ? &by_group[pixel * light_groups] : nullptr; }

 private:
  friend void add_pass(PackedFilm& sum, PackedFilm& pass, class ThreadPool& pool);

  // Channel by channel its value in all pixels, or in each.
  struct Packed {
    ChannelMask varying;
    LargeArray<float> values;
    void resize(size_t count);
  };
  static size_t tiles_along(int pixels) {
    return static_cast<size_t>((pixels + kSide - 1) / kSide);
  }
  static void add(Packed& sum, const Packed& pass);

  std::vector<Packed> tiles_;
};

// Adds one pass' film to the sum. The first one becomes the sum, and gives depth and surface id;
// `pass` is then of no use.
void add_pass(PackedFilm& sum, PackedFilm& pass, class ThreadPool& pool);

}  // namespace photon_splat
