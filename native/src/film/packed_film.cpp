#include "film/packed_film.h"

#include <bit>
#include <cstring>

#include "util/parallel.h"

namespace photon_splat {
namespace {

constexpr size_t kPixels = PackedFilm::kSide * PackedFilm::kSide;

// Channels of the first sample of all, or of one pass alone.
ChannelMask not_summed() { return channels_of(&Pixel::depth, &Pixel::surface_id, &Pixel::detail); }

size_t size_of(const ChannelMask& varying) {
  return kPixelChannels + varying.count() * (kPixels - 1);
}

// A packed tile's channels one by one.
class Reader {
 public:
  Reader(const ChannelMask& varying, const float* values) : varying_(varying), at_(values) {}
  struct Channel {
    const float* values;
    size_t step;  // 0: one for all pixels
    float operator[](size_t i) const { return values[i * step]; }
  };
  Channel next() {
    const size_t step = varying_[channel_++];
    const Channel result{at_, step};
    at_ += step ? kPixels : 1;
    return result;
  }

 private:
  ChannelMask varying_;
  const float* at_;
  size_t channel_ = 0;
};

}  // namespace

ChannelMask channels_of_passes() {
  return channels_of(&Pixel::diffuse_direct, &Pixel::diffuse_indirect, &Pixel::glossy_direct,
                     &Pixel::glossy_indirect, &Pixel::transmission_direct,
                     &Pixel::transmission_indirect, &Pixel::emission, &Pixel::environment,
                     &Pixel::volume_direct, &Pixel::volume_indirect) |
         channels_of(&Pixel::alpha, &Pixel::samples, &Pixel::detail) |
         channels_of(&Pixel::caught, &Pixel::caught_alone, &Pixel::backdrop, &Pixel::caught_alpha);
}

PackedFilm::PackedFilm(const Film& film) {
  reset(film.width, film.height, film.light_groups);
  passes = film.passes;
  by_group = film.by_group;
  Tile pixels;
  for (size_t t = 0; t < tiles(); ++t) {
    pixels.fill({});
    each(t, [&](size_t i, size_t place) { pixels[place] = film.pixels[i]; });
    put(t, pixels);
  }
}

void PackedFilm::reset(int new_width, int new_height, int groups) {
  width = new_width;
  height = new_height;
  passes = 0;
  light_groups = groups;
  tiles_.resize(tiles_along(width) * tiles_along(height));
  by_group.clear();
  by_group.resize(size() * groups);
}

void PackedFilm::release() {
  tiles_ = {};
  by_group = {};
  width = height = light_groups = 0;
  passes = 0;
}

size_t PackedFilm::bytes() const {
  size_t sum = by_group.capacity() * sizeof(Rgb);
  for (const Packed& tile : tiles_) sum += sizeof(Packed) + tile.values.capacity() * sizeof(float);
  return sum;
}

// No more than it takes.
void PackedFilm::Packed::resize(size_t count) {
  if (values.capacity() < count) values = LargeArray<float>(), values.reserve(count);
  values.resize(count);
}

void PackedFilm::put(size_t t, const Tile& pixels) {
  using Bits = std::array<uint32_t, kPixelChannels>;
  const Bits first = std::bit_cast<Bits>(pixels[0]);
  Bits differs{};
  each_run(t, [&](size_t, size_t count, size_t place) {
    for (size_t i = place; i < place + count; ++i) {
      const Bits bits = std::bit_cast<Bits>(pixels[i]);
      for (size_t c = 0; c < kPixelChannels; ++c) differs[c] |= bits[c] ^ first[c];
    }
  });
  Packed& tile = tiles_[t];
  for (size_t c = 0; c < kPixelChannels; ++c) tile.varying[c] = differs[c] != 0;
  tile.varying &= kept;
  tile.resize(size_of(tile.varying));
  const float* const in = reinterpret_cast<const float*>(pixels.data());
  float* out = tile.values.data();
  for (size_t c = 0; c < kPixelChannels; ++c) {
    if (tile.varying[c])
      for (size_t i = 0; i < kPixels; ++i) *out++ = in[i * kPixelChannels + c];
    else
      *out++ = kept[c] ? in[c] : 0;
  }
}

void PackedFilm::get(size_t t, Tile& pixels) const {
  Reader reader(tiles_[t].varying, tiles_[t].values.data());
  float* const out = reinterpret_cast<float*>(pixels.data());
  for (size_t c = 0; c < kPixelChannels; ++c) {
    const Reader::Channel channel = reader.next();
    for (size_t i = 0; i < kPixels; ++i) out[i * kPixelChannels + c] = channel[i];
  }
}

// The sums of light in the order of Pixel::combined(), so that they are the same bit for bit, and
// what catchers send: the noise of their shadows is about its own.
void PackedFilm::see(size_t t, Sums& sums) const {
  std::array<Reader::Channel, kPixelChannels> channels;
  Reader reader(tiles_[t].varying, tiles_[t].values.data());
  for (Reader::Channel& channel : channels) channel = reader.next();
  const auto channel_of = [&](auto member) { return first_of(channels_of(member)); };
  Rgb light[kPixels];
  bool begun = false;
  for (const size_t c : {channel_of(&Pixel::diffuse_direct), channel_of(&Pixel::diffuse_indirect),
                         channel_of(&Pixel::glossy_direct), channel_of(&Pixel::glossy_indirect),
                         channel_of(&Pixel::transmission_direct),
                         channel_of(&Pixel::transmission_indirect), channel_of(&Pixel::emission),
                         channel_of(&Pixel::environment), channel_of(&Pixel::volume_direct),
                         channel_of(&Pixel::volume_indirect), channel_of(&Pixel::caught)}) {
    const Reader::Channel r = channels[c], g = channels[c + 1], b = channels[c + 2];
    if (begun && !r.step && !g.step && !b.step && r[0] == 0 && g[0] == 0 && b[0] == 0) continue;
    for (size_t i = 0; i < kPixels; ++i) {
      const Rgb part{r[i], g[i], b[i]};
      light[i] = begun ? light[i] + part : part;
    }
    begun = true;
  }
  const Reader::Channel samples = channels[channel_of(&Pixel::samples)],
                        detail = channels[channel_of(&Pixel::detail)];
  const size_t emission = channel_of(&Pixel::emission),
               environment = channel_of(&Pixel::environment);
  const auto seen = [&](size_t c, size_t i) {
    return luminance(Rgb{channels[c][i], channels[c + 1][i], channels[c + 2][i]});
  };
  for (size_t i = 0; i < kPixels; ++i) {
    sums.luminance[i] = luminance(light[i]);
    sums.samples[i] = samples[i];
    sums.detail[i] = detail[i];
    sums.sources[i] = seen(emission, i) + seen(environment, i);
  }
}

void PackedFilm::unpack(Film& film) const {
  film.reset(width, height, light_groups);
  film.passes = passes;
  film.by_group = by_group;
  Tile pixels;
  for (size_t t = 0; passes && t < tiles(); ++t) {
    get(t, pixels);
    each(t, [&](size_t i, size_t place) { film.pixels[i] = pixels[place]; });
  }
}

void PackedFilm::add(Packed& sum, const Packed& pass) {
  const ChannelMask first = not_summed(), varying = sum.varying | (pass.varying & ~first);
  LargeArray<float> wider;
  if (varying != sum.varying) wider.reserve(size_of(varying)), wider.resize(size_of(varying));
  float* out = wider.empty() ? sum.values.data() : wider.data();
  Reader of_sum(sum.varying, sum.values.data()), of_pass(pass.varying, pass.values.data());
  for (size_t c = 0; c < kPixelChannels; ++c) {
    const Reader::Channel to = of_sum.next(), from = of_pass.next();
    const size_t count = varying[c] ? kPixels : 1;
    if (first[c])
      for (size_t i = 0; i < count; ++i) out[i] = to[i];
    else if (from.step || from[0] != 0 || count != (to.step ? kPixels : 1))
      for (size_t i = 0; i < count; ++i) out[i] = to[i] + from[i];
    else if (out != to.values)
      for (size_t i = 0; i < count; ++i) out[i] = to[i];
    out += count;
  }
  if (!wider.empty()) sum.values.swap(wider);
  sum.varying = varying;
}

void add_pass(PackedFilm& sum, PackedFilm& pass, ThreadPool& pool) {
  if (++sum.passes == 1) {
    sum.tiles_.swap(pass.tiles_);
    sum.by_group.swap(pass.by_group);
    return;
  }
  const CancelFlag never;  // a sum is never left half done
  pool.for_each(sum.tiles(), never, [&](size_t t, int) {
    PackedFilm::add(sum.tiles_[t], pass.tiles_[t]);
    sum.each(t, [&](size_t i, size_t) {
      for (int g = 0; g < sum.light_groups; ++g)
        sum.groups_of(i)[g] += pass.by_group[i * sum.light_groups + g];
    });
  });
}

}  // namespace photon_splat
