// What a film has summed up, as arrays that can be kept and added, and a film made of them again.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/film_view.h"
#include "film/exact_sum.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

struct Member {
  const char* name;
  ChannelMask channels;
  size_t first() const { return first_of(channels); }
  size_t count() const { return channels.count(); }
};

// Sums over samples
const Member kSummed[] = {
    {"diffuse_direct", channels_of(&Pixel::diffuse_direct)},
    {"diffuse_indirect", channels_of(&Pixel::diffuse_indirect)},
    {"glossy_direct", channels_of(&Pixel::glossy_direct)},
    {"glossy_indirect", channels_of(&Pixel::glossy_indirect)},
    {"transmission_direct", channels_of(&Pixel::transmission_direct)},
    {"transmission_indirect", channels_of(&Pixel::transmission_indirect)},
    {"volume_direct", channels_of(&Pixel::volume_direct)},
    {"volume_indirect", channels_of(&Pixel::volume_indirect)},
    {"diffuse_color", channels_of(&Pixel::diffuse_color)},
    {"glossy_color", channels_of(&Pixel::glossy_color)},
    {"transmission_color", channels_of(&Pixel::transmission_color)},
    {"emission", channels_of(&Pixel::emission)},
    {"environment", channels_of(&Pixel::environment)},
    {"normal", channels_of(&Pixel::normal)},
    {"ambient_occlusion", channels_of(&Pixel::ambient_occlusion)},
    {"albedo", channels_of(&Pixel::albedo)},
    {"feature_normal", channels_of(&Pixel::feature_normal)},
    {"caught", channels_of(&Pixel::caught)},
    {"caught_alone", channels_of(&Pixel::caught_alone)},
    {"backdrop", channels_of(&Pixel::backdrop)},
    {"alpha", channels_of(&Pixel::alpha)},
    {"photon_density", channels_of(&Pixel::photon_density)},
    {"caught_alpha", channels_of(&Pixel::caught_alpha)},
    {"samples", channels_of(&Pixel::samples)},
};
// Of the first sample
const Member kFirst[] = {{"depth", channels_of(&Pixel::depth)},
                         {"surface_id", channels_of(&Pixel::surface_id)}};

template <class Work>
void for_members(Work&& work) {
  for (const Member& member : kSummed) work(member, true);
  for (const Member& member : kFirst) work(member, false);
}

nb::object plane(std::vector<float> values, size_t height, size_t width) {
  return nb::cast(to_numpy(std::move(values), {height, width, size_t{1}}));
}

// Those that are all 0 are left out.
nb::dict film_sums(Renderer& r) {
  const PackedFilm& film = r.film().sum();
  const size_t width = film.width, height = film.height, groups = film.light_groups;
  if (!film.passes) throw std::logic_error("there is no pass in the film");
  struct Out {
    const Member* member;
    bool summed;
    std::unique_ptr<LargeArray<float>> values;
    bool any = false;
  };
  std::vector<Out> outs;
  for_members([&](const Member& member, bool summed) {
    if ((member.channels & ~film.kept).any()) return;
    outs.push_back({&member, summed, std::make_unique<LargeArray<float>>()});
  });
  auto by_group = std::make_unique<LargeArray<float>>();
  ErrorSums errors;
  {
    nb::gil_scoped_release release;
    r.make_error_estimate();
    errors = r.film().errors().sums();
    for (Out& out : outs) out.values->resize(width * height * out.member->count());
    by_group->resize(groups * width * height * 3);
    PackedFilm::Tile pixels;
    for (size_t t = 0; t < film.tiles(); ++t) {
      film.get(t, pixels);
      film.each(t, [&](size_t i, size_t place) {
        const float* const from = reinterpret_cast<const float*>(&pixels[place]);
        for (Out& out : outs) {
          const size_t channels = out.member->count();
          for (size_t c = 0; c < channels; ++c) {
            const float value = from[out.member->first() + c];
            (*out.values)[i * channels + c] = value;
            out.any |= value != 0;
          }
        }
        for (size_t g = 0; g < groups; ++g) {
          const Rgb light = film.by_group[i * groups + g];
          const float rgb[3] = {light.x, light.y, light.z};
          std::copy_n(rgb, 3, by_group->data() + 3 * (g * width * height + i));
        }
      });
    }
  }
  nb::dict summed, first, error, all;
  for (Out& out : outs)
    if (out.any)
      (out.summed ? summed : first)[out.member->name] =
          to_numpy(std::move(out.values), {height, width, out.member->count()});
  error["variance"] = plane(std::move(errors.variance), height, width);
  error["square"] = plane(std::move(errors.square), height, width);
  error["square_rest"] = plane(std::move(errors.square_rest), height, width);
  error["detail"] = plane(std::move(errors.detail), height, width);
  error["detail_squares"] = plane(std::move(errors.detail_squares), height, width);
  all["summed"] = summed;
  all["first"] = first;
  all["error"] = error;
  all["light_groups"] = to_numpy(std::move(by_group), {groups, height, width, size_t{3}});
  return all;
}

using Plane = Array<float, nb::ndim<3>>;  // (height, width, channels)

// A picture of sums, without the scene.
class SummedFilm {
 public:
  SummedFilm(int width, int height, int light_groups, float exposure, bool transparent,
             bool catchers, int threads)
      : pool_(threads), exposure_(exposure), transparent_(transparent), catchers_(catchers) {
    if (width < 1 || height < 1 || light_groups < 0)
      throw std::invalid_argument("a film has a pixel at the least");
    film_.reset(width, height, light_groups);
  }

  void set(const std::vector<std::pair<std::string, Plane>>& sums,
           const std::vector<std::pair<std::string, Plane>>& errors,
           const Array<float, nb::ndim<4>>& light_groups, uint32_t passes, uint32_t films) {
    PackedFilm sum;
    const int width = film_.sum().width, height = film_.sum().height,
              groups = film_.sum().light_groups;
    sum.reset(width, height, groups);
    sum.passes = passes;
    std::vector<std::pair<Member, const float*>> parts;
    for (const auto& [name, plane] : sums) {
      const Member member = member_of(name);
      check(plane, member.count());
      parts.push_back({member, plane.data()});
    }
    ErrorSums error;
    const size_t count = sum.size();
    for (auto [name, to] : {std::pair{"variance", &error.variance},
                            {"square", &error.square},
                            {"square_rest", &error.square_rest},
                            {"detail", &error.detail},
                            {"detail_squares", &error.detail_squares}}) {
      to->assign(count, 0.0f);
      for (const auto& [given, plane] : errors)
        if (given == name) {
          check(plane, 1);
          std::copy_n(plane.data(), count, to->data());
        }
    }
    if (light_groups.shape(0) != static_cast<size_t>(groups) ||
        (groups &&
         (light_groups.shape(1) != static_cast<size_t>(height) ||
          light_groups.shape(2) != static_cast<size_t>(width) || light_groups.shape(3) != 3)))
      throw std::invalid_argument("light_groups has another shape than the film");
    nb::gil_scoped_release release;
    PackedFilm::Tile pixels;
    for (size_t t = 0; t < sum.tiles(); ++t) {
      pixels.fill({});
      sum.each(t, [&](size_t i, size_t place) {
        float* const to = reinterpret_cast<float*>(&pixels[place]);
        for (const auto& [member, from] : parts)
          std::copy_n(from + i * member.count(), member.count(), to + member.first());
        for (int g = 0; g < groups; ++g) {
          const float* const rgb = light_groups.data() + 3 * (g * count + i);
          sum.by_group[i * groups + g] = {rgb[0], rgb[1], rgb[2]};
        }
      });
      sum.put(t, pixels);
    }
    film_.restore(std::move(sum), error, films, pool_);
  }

  FilmView view() { return {film_, pool_, exposure_, transparent_, catchers_}; }

 private:
  static Member member_of(const std::string& name) {
    std::optional<Member> found;
    for_members([&](const Member& member, bool) {
      if (name == member.name) found = member;
    });
    if (!found) throw std::invalid_argument("no film has sums of the name " + name);
    return *found;
  }
  void check(const Plane& plane, size_t channels) const {
    if (plane.shape(0) != static_cast<size_t>(film_.sum().height) ||
        plane.shape(1) != static_cast<size_t>(film_.sum().width) || plane.shape(2) != channels)
      throw std::invalid_argument("an array has another shape than the film");
  }

  ThreadPool pool_;
  RenderFilm film_;
  float exposure_;
  bool transparent_, catchers_;
};

nb::dict error_figures(SummedFilm& film) {
  const ErrorFigures& figures = film.view().film.errors().figures();
  nb::dict out;
  out["relative_rmse"] = figures.relative_rmse;
  out["standard_error"] = figures.standard_error;
  out["bias"] = figures.bias;
  out["between"] = figures.between;
  return out;
}

}  // namespace

void bind_sums(nb::module_& m, RendererClass& renderer) {
  renderer
      .def(
          "film_sums", &film_sums,
          "What the film has summed up, before exposure: 'summed', name -> (height, width, channels) float32, row 0 at\n"
          "the bottom, sums over samples; 'first', the same of the first sample; 'error', sums that the error estimate is\n"
          "made of; 'light_groups' (group, height, width, 3). Arrays that are all 0 are left out of the first two.\n"
          "RuntimeError before the first pass.")
      .def_prop_ro(
          "paths_done",
          [](const Renderer& r) {
            std::vector<uint64_t> paths;
            for (const auto& map : r.maps()) paths.push_back(map->paths_done());
            return paths;
          },
          "Photon paths of each photon map in the passes of this render.")
      .def_prop_ro(
          "radii_known",
          [](const Renderer& r) {
            const size_t width = r.film().sum().width, height = r.film().sum().height;
            std::vector<nb::object> maps;
            for (const auto& map : r.maps()) {
              std::vector<float> values;
              for (const auto& known : map->radii_known())
                values.insert(values.end(), known.begin(), known.end());
              maps.push_back(nb::cast(to_numpy(std::move(values), {height, width, size_t{3}})));
            }
            return maps;
          },
          "Of each photon map what passes have found of its radii: (height, width, 3) float32, the factor on those of\n"
          "a pixel, and sums that the next choice is made from.")
      .def(
          "set_radii_known",
          [](Renderer& r, size_t map, const Array<float, nb::ndim<3>>& values) {
            std::vector<AdaptiveRadius::Known> known(values.size() / 3);
            if (values.shape(2) != 3)
              throw std::invalid_argument("three numbers are known of a pixel's radii");
            std::copy_n(values.data(), values.size(), known.data()->data());
            r.maps().at(map)->set_radii_known(std::move(known));
          },
          "map"_a, "values"_a,
          "After build(), before the first pass: those that an earlier generation has found in the passes before.\n"
          "ValueError for another size, IndexError for another map.")
      .def_prop_ro(
          "samples_known",
          [](Renderer& r) {
            const AdaptiveSampler::Known known = r.sampler().seen();
            std::vector<float> values;
            values.reserve(known.pixels.size() * AdaptiveSampler::Known::kNumbers);
            for (const auto& pixel : known.pixels)
              values.insert(values.end(), pixel.begin(), pixel.end());
            const PackedFilm& film = r.film().sum();
            const std::initializer_list<size_t> shape = {static_cast<size_t>(film.height),
                                                         static_cast<size_t>(film.width),
                                                         size_t{AdaptiveSampler::Known::kNumbers}};
            return nb::make_tuple(nb::cast(to_numpy(std::move(values), shape)), known.photons);
          },
          "What passes have seen and chosen of samples: (height, width, 9) float32, and for each photon map the photons\n"
          "of the next pass over those of the first.")
      .def(
          "set_samples_known",
          [](Renderer& r, const Array<float, nb::ndim<3>>& values, std::vector<double> photons) {
            if (values.shape(2) != AdaptiveSampler::Known::kNumbers)
              throw std::invalid_argument("nine numbers are known of a pixel's samples");
            AdaptiveSampler::Known known;
            known.pixels.resize(values.shape(0) * values.shape(1));
            std::copy_n(values.data(), values.size(), known.pixels.data()->data());
            known.passes = r.options.part.passes_before;
            known.photons = std::move(photons);
            r.sampler().go_on(std::move(known));
          },
          "values"_a, "photons"_a,
          "Likewise: what an earlier generation has seen. ValueError for another size.");
  nb::class_<SummedFilm>(m, "SummedFilm", "A film of sums, without a scene: what it shows.")
      .def(
          nb::init<int, int, int, float, bool, bool, int>(), "width"_a, "height"_a,
          "light_groups"_a, "exposure"_a, "transparent"_a, "catchers"_a, "threads"_a = 0,
          "transparent: the camera does not see the world. catchers: there are shadow catchers. threads: 0 for all.")
      .def(
          "set",
          [](SummedFilm& film, const nb::dict& sums, const nb::dict& errors,
             const Array<float, nb::ndim<4>>& light_groups, uint32_t passes, uint32_t films) {
            const auto planes = [](const nb::dict& given) {
              std::vector<std::pair<std::string, Plane>> out;
              for (const auto& [name, array] : given)
                out.emplace_back(nb::cast<std::string>(name), nb::cast<Plane>(array));
              return out;
            };
            film.set(planes(sums), planes(errors), light_groups, passes, films);
          },
          "sums"_a, "errors"_a, "light_groups"_a, "passes"_a, "films"_a,
          "Arrays as of Renderer.film_sums(): both of its first two in `sums`. films: of how many films they are the sum.\n"
          "ValueError for other names or shapes.")
      .def(
          "film",
          [](SummedFilm& film, const std::optional<std::vector<std::string>>& names) {
            return film_arrays(film.view(), names);
          },
          "names"_a = nb::none(), "As Renderer.film().")
      .def(
          "error", &error_figures,
          "relative_rmse, standard_error and bias, relative to the mean luminance; between: the variance by how the films\n"
          "differ from each other over that by what each knows of itself, 0 of one film.");
  m.def(
      "exact_sums",
      [](const Array<float, nb::ndim<2>>& terms) {
        const size_t count = terms.shape(1);
        auto out = std::make_unique<std::vector<float>>();
        {
          nb::gil_scoped_release release;
          *out = exact_sums(terms.data(), terms.shape(0), count);
        }
        const size_t components = count ? out->size() / count : 1;
        return to_numpy(std::move(out), {components, count});
      },
      "terms"_a,
      "terms: (terms, count) float32. Returns (components, count) float32: in each column numbers whose exact sum is that\n"
      "of the terms, the nearest one to it first; the same whatever the order and grouping of terms. ValueError for a\n"
      "term that is not finite.");
}

}  // namespace photon_splat
