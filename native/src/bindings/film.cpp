// What the film holds, as arrays: means over samples, row 0 at the bottom.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

struct Source {
  using Fill = void(const Renderer& r, size_t first, size_t count, float* to);  // of `count` pixels from `first` on
  const char* name;
  size_t channels;
  Fill* fill;
};

template <class Get>
void fill_rgb(const Renderer& r, size_t first, size_t count, float* to, Get&& get) {
  for (size_t i = first; i < first + count; ++i, to += 3) {
    const Rgb c = get(r.film().pixels[i]);
    to[0] = c.x;
    to[1] = c.y;
    to[2] = c.z;
  }
}

template <Rgb Pixel::*kLight>
void fill_mean(const Renderer& r, size_t first, size_t count, float* to) {
  fill_rgb(r, first, count, to, [](const Pixel& p) { return p.*kLight * p.share(); });
}

// Diffuse light over the diffuse colour, as Cycles divides it; 0 where that is black.
template <Rgb Pixel::*kLight>
void fill_per_albedo(const Renderer& r, size_t first, size_t count, float* to) {
  const auto over = [](float light, float color) { return color > 0 ? light / color : 0; };
  fill_rgb(r, first, count, to, [&](const Pixel& p) {
    const Rgb light = p.*kLight * p.share(), color = p.diffuse_color * p.share();
    return Rgb{over(light.x, color.x), over(light.y, color.y), over(light.z, color.z)};
  });
}

template <float Pixel::*kValue>
void fill_mean(const Renderer& r, size_t first, size_t count, float* to) {
  for (size_t i = 0; i < count; ++i) to[i] = r.film().pixels[first + i].*kValue * r.film().pixels[first + i].share();
}

template <float Pixel::*kValue>
void fill_value(const Renderer& r, size_t first, size_t count, float* to) {
  for (size_t i = 0; i < count; ++i) to[i] = r.film().pixels[first + i].*kValue;
}

// All of the light, and alpha. Parts are scaled before they are added, as whoever adds the passes does.
void fill_combined(const Renderer& r, size_t first, size_t count, float* to) {
  for (size_t i = first; i < first + count; ++i, to += 4) {
    const Pixel& p = r.film().pixels[i];
    const float share = p.share();
    Rgb sum;
    for (const Rgb& light : {p.diffuse_direct, p.diffuse_indirect, p.glossy_direct, p.glossy_indirect, p.transmission_direct,
                             p.transmission_indirect, p.emission, p.environment})
      sum += light * share;
    to[0] = sum.x;
    to[1] = sum.y;
    to[2] = sum.z;
    to[3] = p.alpha * share;
  }
}

void fill_variance(const Renderer& r, size_t first, size_t count, float* to) { std::copy_n(&r.errors().variance()[first], count, to); }
void fill_error(const Renderer& r, size_t first, size_t count, float* to) { std::copy_n(&r.errors().error()[first], count, to); }

constexpr Source kSources[] = {
    {"combined", 4, &fill_combined},
    {"diffuse_direct", 3, &fill_mean<&Pixel::diffuse_direct>},
    {"diffuse_indirect", 3, &fill_mean<&Pixel::diffuse_indirect>},
    {"diffuse_direct_per_albedo", 3, &fill_per_albedo<&Pixel::diffuse_direct>},
    {"diffuse_indirect_per_albedo", 3, &fill_per_albedo<&Pixel::diffuse_indirect>},
    {"glossy_direct", 3, &fill_mean<&Pixel::glossy_direct>},
    {"glossy_indirect", 3, &fill_mean<&Pixel::glossy_indirect>},
    {"transmission_direct", 3, &fill_mean<&Pixel::transmission_direct>},
    {"transmission_indirect", 3, &fill_mean<&Pixel::transmission_indirect>},
    {"diffuse_color", 3, &fill_mean<&Pixel::diffuse_color>},
    {"albedo", 3, &fill_mean<&Pixel::albedo>},
    {"emission", 3, &fill_mean<&Pixel::emission>},
    {"environment", 3, &fill_mean<&Pixel::environment>},
    {"normal", 3, &fill_mean<&Pixel::normal>},
    {"alpha", 1, &fill_mean<&Pixel::alpha>},
    {"photon_density", 1, &fill_mean<&Pixel::photon_density>},
    {"depth", 1, &fill_value<&Pixel::depth>},
    {"surface_id", 1, &fill_value<&Pixel::surface_id>},
    {"samples", 1, &fill_value<&Pixel::samples>},
    {"variance", 1, &fill_variance},
    {"error", 1, &fill_error},
};
constexpr const char* kLightGroups = "light_groups";  // (light group, row, column, RGB)

struct Array {
  const char* name;
  size_t channels;
  Source::Fill* fill;
  std::unique_ptr<LargeArray<float>> values;
};

// Those asked for by name, or all.
nb::dict film_arrays(Renderer& r, const std::optional<std::vector<std::string>>& names) {
  const Film& film = r.film();
  const size_t width = film.width, height = film.height, groups = film.light_groups;
  const auto asked = [&](const char* name) { return !names || std::find(names->begin(), names->end(), name) != names->end(); };
  std::vector<Array> arrays;
  for (const Source& source : kSources)
    if (asked(source.name)) arrays.push_back({source.name, source.channels, source.fill, std::make_unique<LargeArray<float>>()});
  const bool with_groups = asked(kLightGroups);
  if (names && names->size() != arrays.size() + with_groups) throw std::invalid_argument("the film has no array of such a name");
  for (const Array& array : arrays) array.values->resize(width * height * array.channels);
  auto by_group = std::make_unique<LargeArray<float>>();
  by_group->resize(with_groups ? width * height * groups * 3 : 0);
  {
    nb::gil_scoped_release release;
    r.scene.pool().for_each(height, CancelFlag{}, [&](size_t row, int) {
      for (const Array& array : arrays) {
        float* to = array.values->data() + row * width * array.channels;
        if (film.passes) array.fill(r, row * width, width, to);
        else std::fill_n(to, width * array.channels, 0.0f);
      }
      for (size_t g = 0; with_groups && g < groups; ++g)
        for (size_t i = row * width; i < (row + 1) * width; ++i) {
          const Rgb light = film.passes ? film.by_group[i * groups + g] * film.pixels[i].share() : Rgb{};
          const float rgb[3] = {light.x, light.y, light.z};
          std::copy_n(rgb, 3, by_group->data() + 3 * (g * width * height + i));
        }
    });
  }
  nb::dict out;
  for (Array& array : arrays) out[array.name] = to_numpy(std::move(array.values), {height, width, array.channels});
  if (with_groups) out[kLightGroups] = to_numpy(std::move(by_group), {groups, height, width, 3});
  return out;
}

}  // namespace

void bind_film(nb::class_<Renderer>& renderer) {
  renderer.def("film", &film_arrays, "names"_a = nb::none(),
               "(height, width, channels) float32 by name: means over the film's samples, row 0 at the bottom; 0 before the first pass.");
}

}  // namespace photon_splat
