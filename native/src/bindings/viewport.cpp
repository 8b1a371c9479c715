#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

// (height, width, 4): mean premultiplied scene-linear RGB and alpha, row 0 at the bottom.
nb::ndarray<nb::numpy, float> picture(Renderer& r) {
  const PackedFilm& film = r.packed_film();
  std::vector<float> values(static_cast<size_t>(film.width) * film.height * 4);
  if (film.passes) {
    nb::gil_scoped_release release;
    r.scene.pool().for_each(film.tiles(), CancelFlag{}, [&](size_t t, int) {
      PackedFilm::Tile pixels;
      film.get(t, pixels);
      film.each(t, [&](size_t i, size_t place) {
        const Pixel& p = pixels[place];
        const float share = p.share();
        const Rgb c = p.combined() * share;
        const float out[4] = {c.x, c.y, c.z, p.alpha * share};
        std::copy(out, out + 4, &values[4 * i]);
      });
    });
  }
  return to_numpy(std::move(values),
                  {static_cast<size_t>(film.height), static_cast<size_t>(film.width), 4});
}

// Sums over the layers; `paths` are those of each.
nb::dict store_statistics(const Renderer& r) {
  uint64_t paths = 0, photons = 0, bytes = 0, traced = 0;
  bool full = false;
  for (size_t i = 0; i < r.layer_count(); ++i) {
    const auto& store = r.layer(i).store;
    if (!store) continue;
    paths = std::max(paths, store->paths());
    photons += store->photons().size();
    bytes += store->bytes();
    traced += store->counts().traced;
    full |= store->full();
  }
  nb::dict out;
  out["paths"] = paths;
  out["photons"] = photons;
  out["bytes"] = bytes;
  out["traced"] = traced;
  out["full"] = full;
  return out;
}

void clear_shading(Renderer& r) {
  r.lamps.clear();
  r.scene.materials.clear();
  r.scene.textures.clear();
  r.scene.programs.clear();
  r.scene.world_program = -1;
}

}  // namespace

void bind_viewport(nb::class_<Renderer>& renderer) {
  const auto released = nb::call_guard<nb::gil_scoped_release>();
  renderer
      .def("set_view", &Renderer::set_view, released,
           "Takes the camera of set_camera() after build(): the film is empty then.")
      .def("clear_shading", &clear_shading,
           "Forgets lamps, materials and textures, which are then added anew before relight().")
      .def("relight", &Renderer::relight, released,
           "Takes other lamps, materials, textures or world on the same geometry.")
      .def(
          "fix_radius", [](Renderer& r, float radius) { r.options.fixed_radius = radius; },
          "metres"_a, "All discs of that radius, whatever the scene; 0: chosen. For comparisons.")
      .def(
          "keep_photons",
          [](Renderer& r, size_t most_bytes) { r.options.kept_photon_bytes = most_bytes; },
          "most_bytes"_a,
          "After set_options() and before build(): every render has the same photons, of which so many are kept for the next.")
      .def("begin_again", &Renderer::begin_again, released,
           "After set_camera(): another render with what build() and kept photons give.")
      .def("trace_store", &Renderer::trace_store, "paths"_a, "most_bytes"_a, released)
      .def("draw_store", &Renderer::draw_store, released)
      .def("resume", &Renderer::resume, "Takes cancel() back; only while no stage runs.")
      .def(
          "picture", &picture,
          "(height, width, 4) float32 premultiplied scene-linear mean of the film, row 0 at the bottom.")
      .def("store_statistics", &store_statistics);
}

}  // namespace photon_splat
