// What the film holds, as arrays: means over samples, row 0 at the bottom.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/film_view.h"
#include "film/shadow_catcher.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

// Where values come from: `count` pixels, the first of them the film's `first`.
struct Run {
  const FilmView& view;
  const Pixel* pixels;
  size_t first, count;
};

// What the picture's exposure does to values: nothing, or it is a factor of them once or twice.
enum class Unit { kOther, kLight, kLightSquared };

struct Source {
  const char* name;
  size_t channels;
  void (*fill)(const Run& run, float* to);
  ChannelMask needs;  // of the film
  Unit unit;
};

template <class Get>
void fill_rgb(const Run& run, float* to, Get&& get) {
  for (size_t i = 0; i < run.count; ++i, to += 3) {
    const Rgb c = get(run.pixels[i]);
    to[0] = c.x;
    to[1] = c.y;
    to[2] = c.z;
  }
}

template <Rgb Pixel::* kLight>
void fill_mean(const Run& run, float* to) {
  fill_rgb(run, to, [](const Pixel& p) { return p.*kLight * p.share(); });
}

// Light over the colour of the lobes that sent it, as Cycles divides it: a channel that the colour
// lacks has the mean of the others, so that white light on pure red is white; 0 where all is black.
Rgb divided_evenly(const Rgb& light, const Rgb& color) {
  const Rgb ratio = divided(light, color);
  const Rgb known{color.x != 0 ? 1.0f : 0, color.y != 0 ? 1.0f : 0, color.z != 0 ? 1.0f : 0};
  const float mean = dot(ratio, known) / std::max(dot(known, {1, 1, 1}), 1.0f);
  return ratio * known + (Rgb{1, 1, 1} - known) * mean;
}

template <Rgb Pixel::* kLight, Rgb Pixel::* kColor>
void fill_per_color(const Run& run, float* to) {
  fill_rgb(run, to, [](const Pixel& p) {
    return divided_evenly(p.*kLight * p.share(), p.*kColor * p.share());
  });
}

template <float Pixel::* kValue>
void fill_mean(const Run& run, float* to) {
  for (size_t i = 0; i < run.count; ++i) to[i] = run.pixels[i].*kValue * run.pixels[i].share();
}

template <float Pixel::* kValue>
void fill_value(const Run& run, float* to) {
  for (size_t i = 0; i < run.count; ++i) to[i] = run.pixels[i].*kValue;
}

// All of the light but that of shadow catchers, and alpha. Parts are scaled before they are added,
// as whoever adds the passes does.
void fill_matte(const Run& run, float* to) {
  for (const Pixel* at = run.pixels; at < run.pixels + run.count; ++at, to += 4) {
    const Pixel& p = *at;
    const float share = p.share();
    Rgb sum;
    for (const Rgb& light : {p.diffuse_direct, p.diffuse_indirect, p.glossy_direct,
                             p.glossy_indirect, p.transmission_direct, p.transmission_indirect,
                             p.emission, p.environment, p.volume_direct, p.volume_indirect})
      sum += light * share;
    to[0] = sum.x;
    to[1] = sum.y;
    to[2] = sum.z;
    to[3] = p.alpha * share;
  }
}

void fill_combined(const Run& run, float* to) {
  fill_matte(run, to);
  if (!run.view.catchers) return;
  const bool transparent = run.view.transparent;
  for (size_t i = 0; i < run.count; ++i, to += 4) {
    const Rgba shown = with_shadow(run.pixels[i], {to[0], to[1], to[2]}, transparent);
    to[0] = shown.color.x;
    to[1] = shown.color.y;
    to[2] = shown.color.z;
    to[3] = shown.alpha;
  }
}

void fill_shadow(const Run& run, float* to) { fill_rgb(run, to, &caught_shadow); }

void fill_variance(const Run& run, float* to) {
  std::copy_n(&run.view.film.errors().variance()[run.first], run.count, to);
}
void fill_error(const Run& run, float* to) {
  std::copy_n(&run.view.film.errors().error()[run.first], run.count, to);
}

// One member of Pixel.
template <auto kMember>
Source mean_of(const char* name, Unit unit = Unit::kOther) {
  return {name, sizeof(Pixel{}.*kMember) / sizeof(float), &fill_mean<kMember>, channels_of(kMember),
          unit};
}
template <auto kMember>
Source light_of(const char* name) {
  return mean_of<kMember>(name, Unit::kLight);
}
template <Rgb Pixel::* kLight, Rgb Pixel::* kColor>
Source per_color(const char* name) {
  return {name, 3, &fill_per_color<kLight, kColor>, channels_of(kColor), Unit::kLight};
}
template <float Pixel::* kValue>
Source value_of(const char* name) {
  return {name, 1, &fill_value<kValue>, channels_of(kValue), Unit::kOther};
}

const Source kSources[] = {
    {"combined", 4, &fill_combined, {}, Unit::kLight},
    {"matte", 4, &fill_matte, {}, Unit::kLight},
    {"shadow_catcher", 3, &fill_shadow, {}, Unit::kOther},
    light_of<&Pixel::backdrop>("backdrop"),
    light_of<&Pixel::diffuse_direct>("diffuse_direct"),
    light_of<&Pixel::diffuse_indirect>("diffuse_indirect"),
    per_color<&Pixel::diffuse_direct, &Pixel::diffuse_color>("diffuse_direct_per_albedo"),
    per_color<&Pixel::diffuse_indirect, &Pixel::diffuse_color>("diffuse_indirect_per_albedo"),
    per_color<&Pixel::glossy_direct, &Pixel::glossy_color>("glossy_direct_per_color"),
    per_color<&Pixel::glossy_indirect, &Pixel::glossy_color>("glossy_indirect_per_color"),
    per_color<&Pixel::transmission_direct, &Pixel::transmission_color>(
        "transmission_direct_per_color"),
    per_color<&Pixel::transmission_indirect, &Pixel::transmission_color>(
        "transmission_indirect_per_color"),
    light_of<&Pixel::glossy_direct>("glossy_direct"),
    light_of<&Pixel::glossy_indirect>("glossy_indirect"),
    light_of<&Pixel::transmission_direct>("transmission_direct"),
    light_of<&Pixel::transmission_indirect>("transmission_indirect"),
    light_of<&Pixel::volume_direct>("volume_direct"),
    light_of<&Pixel::volume_indirect>("volume_indirect"),
    mean_of<&Pixel::diffuse_color>("diffuse_color"),
    mean_of<&Pixel::glossy_color>("glossy_color"),
    mean_of<&Pixel::transmission_color>("transmission_color"),
    mean_of<&Pixel::ambient_occlusion>("ambient_occlusion"),
    mean_of<&Pixel::albedo>("albedo"),
    mean_of<&Pixel::feature_normal>("feature_normal"),
    light_of<&Pixel::emission>("emission"),
    light_of<&Pixel::environment>("environment"),
    mean_of<&Pixel::normal>("normal"),
    mean_of<&Pixel::alpha>("alpha"),
    mean_of<&Pixel::photon_density>("photon_density"),
    value_of<&Pixel::depth>("depth"),
    value_of<&Pixel::surface_id>("surface_id"),
    value_of<&Pixel::samples>("samples"),
    {"variance", 1, &fill_variance, {}, Unit::kLightSquared},
    {"error", 1, &fill_error, {}, Unit::kLight},
};
constexpr const char* kLightGroups = "light_groups";  // (light group, row, column, RGB)

// Alpha, the fourth channel, stays as it is.
void expose(const Source& source, float exposure, size_t count, float* values) {
  if (source.unit == Unit::kOther || exposure == 1) return;
  const float factor = source.unit == Unit::kLight ? exposure : exposure * exposure;
  for (size_t i = 0; i < count * source.channels; ++i)
    if (i % source.channels < 3) values[i] *= factor;
}

const Source& source_of(const std::string& name) {
  for (const Source& source : kSources)
    if (name == source.name) return source;
  throw std::invalid_argument("the film has no array of such a name");
}

struct FilmArray {
  const Source* source;
  std::unique_ptr<LargeArray<float>> values;
};

}  // namespace

FilmView view_of(Renderer& r) {
  const CameraSettings& camera = r.camera_settings;
  return {r.film(), r.scene.pool(), camera.exposure, camera.transparent, r.scene.has_catchers()};
}

nb::dict film_arrays(const FilmView& view, const std::optional<std::vector<std::string>>& names) {
  const PackedFilm& film = view.film.sum();
  const size_t width = film.width, height = film.height, groups = film.light_groups;
  const float exposure = view.exposure;
  std::vector<FilmArray> arrays;
  bool with_groups = !names;
  const auto add = [&](const Source& source) {
    arrays.push_back({&source, std::make_unique<LargeArray<float>>()});
  };
  if (!names)
    for (const Source& source : kSources)
      if ((source.needs & ~film.kept).none()) add(source);
  for (const std::string& name : names.value_or(std::vector<std::string>{})) {
    if (name == kLightGroups) {
      with_groups = true;
      continue;
    }
    const Source& source = source_of(name);
    if ((source.needs & ~film.kept).any())
      throw std::invalid_argument("the film has not been told to keep " + name);
    add(source);
  }
  for (const FilmArray& array : arrays)
    array.values->resize(width * height * array.source->channels);
  auto by_group = std::make_unique<LargeArray<float>>();
  by_group->resize(with_groups ? width * height * groups * 3 : 0);
  {
    nb::gil_scoped_release release;
    view.pool.for_each(film.tiles(), CancelFlag{}, [&](size_t t, int) {
      PackedFilm::Tile pixels;
      if (film.passes) film.get(t, pixels);
      film.each_run(t, [&](size_t first, size_t count, size_t place) {
        for (const FilmArray& array : arrays) {
          float* to = array.values->data() + first * array.source->channels;
          if (film.passes) {
            array.source->fill({view, &pixels[place], first, count}, to);
            expose(*array.source, exposure, count, to);
          } else {
            std::fill_n(to, count * array.source->channels, 0.0f);
          }
        }
        for (size_t g = 0; with_groups && g < groups; ++g)
          for (size_t i = 0; i < count; ++i) {
            const Rgb light = film.passes ? film.by_group[(first + i) * groups + g] *
                                                (pixels[place + i].share() * exposure)
                                          : Rgb{};
            const float rgb[3] = {light.x, light.y, light.z};
            std::copy_n(rgb, 3, by_group->data() + 3 * (g * width * height + first + i));
          }
      });
    });
  }
  nb::dict out;
  for (FilmArray& array : arrays)
    out[array.source->name] =
        to_numpy(std::move(array.values), {height, width, array.source->channels});
  if (with_groups) out[kLightGroups] = to_numpy(std::move(by_group), {groups, height, width, 3});
  return out;
}

ChannelMask channels_of_array(const std::string& name) {
  return name == kLightGroups ? ChannelMask{} : source_of(name).needs;
}

void bind_film(RendererClass& renderer) {
  renderer.def(
      "keep_film",
      [](Renderer& r, const std::vector<std::string>& names) {
        ChannelMask channels;
        for (const std::string& name : names) channels |= channels_of_array(name);
        r.film().keep_channels(channels);
      },
      "names"_a,
      "Of which arrays film() is to be able to tell; all if this is not called. Before build(), set_view() or begin_again().");
  renderer.def(
      "film",
      [](Renderer& r, const std::optional<std::vector<std::string>>& names) {
        return film_arrays(view_of(r), names);
      },
      "names"_a = nb::none(),
      "(height, width, channels) float32 by name: means over the film's samples, row 0 at the bottom; 0 before the first pass.\n"
      "Light is multiplied by the camera's exposure.");
}

}  // namespace photon_splat
