#include "bindings/bindings.h"
#include "film/shadow_catcher.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

// (height, width, 4): mean premultiplied scene-linear RGB and alpha, row 0 at the bottom.
nb::ndarray<nb::numpy, float> picture(Renderer& r) {
  const PackedFilm& film = r.film().sum();
  std::vector<float> values(static_cast<size_t>(film.width) * film.height * 4);
  if (film.passes) {
    nb::gil_scoped_release release;
    const float exposure = r.camera_settings.exposure;
    r.scene.pool().for_each(film.tiles(), CancelFlag{}, [&](size_t t, int) {
      PackedFilm::Tile pixels;
      film.get(t, pixels);
      film.each(t, [&](size_t i, size_t place) {
        const Pixel& p = pixels[place];
        const float share = p.share();
        Rgba shown{p.combined() * share, p.alpha * share};
        if (r.scene.has_catchers())
          shown = with_shadow(p, shown.color, r.camera_settings.transparent);
        const Rgb c = shown.color * exposure;
        const float out[4] = {c.x, c.y, c.z, shown.alpha};
        std::copy(out, out + 4, &values[4 * i]);
      });
    });
  }
  return to_numpy(std::move(values),
                  {static_cast<size_t>(film.height), static_cast<size_t>(film.width), 4});
}

// Sums over the photon maps; `paths` are those of each.
nb::dict viewport_photons(Renderer& r) {
  uint64_t paths = 0, photons = 0, bytes = 0, traced = 0;
  bool full = false;
  for (const auto& map : r.maps()) {
    const auto& there = map->viewport_photons();
    if (!there) continue;
    paths = std::max(paths, there->paths());
    photons += there->photons().size();
    bytes += there->bytes();
    traced += there->counts().traced;
    full |= there->full();
  }
  nb::dict out;
  out["paths"] = paths;
  out["photons"] = photons;
  out["bytes"] = bytes;
  out["traced"] = traced;
  out["full"] = full;
  return out;
}

nb::dict light_cache(const Renderer& r) {
  nb::dict out;
  out["cells"] = r.light_cache().size();
  out["readings"] = r.cache_counts().readings;
  out["samples"] = r.cache_counts().samples;
  return out;
}

void teach_light_cache(
    Renderer& r, float pixels, float share,
    nb::ndarray<const float, nb::c_contig, nb::device::cpu, nb::shape<-1, -1, 4>> picture) {
  const PackedFilm& film = r.film().sum();
  if (picture.shape(0) != static_cast<size_t>(film.height) ||
      picture.shape(1) != static_cast<size_t>(film.width))
    throw std::invalid_argument("The picture has not the film's size.");
  nb::gil_scoped_release release;
  r.teach_light_cache(pixels, share, picture.data());
}

void clear_shading(Renderer& r) {
  r.lamps.clear();
  r.scene.materials.clear();
  r.scene.textures.clear();
  r.scene.programs.clear();
  r.scene.world_program = -1;
}

}  // namespace

void bind_viewport(RendererClass& renderer) {
  const auto released = nb::call_guard<nb::gil_scoped_release>();
  renderer
      .def(
          "set_view", &Renderer::set_view, released,
          "Takes the camera of set_camera() after build(): the film is empty then, and passes begin with 0.")
      .def(
          "clear_shading", &clear_shading,
          "Forgets lamps, materials, textures and programs, which are then added anew before relight().")
      .def(
          "relight", &Renderer::relight, released,
          "Takes other lamps, materials, textures or world on the same geometry; forgets film and photons.")
      .def(
          "begin_again", &Renderer::begin_again, released,
          "After set_camera(): another render with what build() and kept photons (options.kept_photon_bytes) give.")
      .def(
          "trace_viewport_photons", &Renderer::trace_viewport_photons, "paths"_a, "most_bytes"_a,
          released,
          "Traces so many photon paths more in each photon map that serve every view, up to so many bytes of photons.")
      .def("viewport_photons", &viewport_photons,
           "Of those: paths, photons, bytes, traced (paths, pilot included), full (no more fit).")
      .def(
          "draw_viewport", &Renderer::draw_viewport, released,
          "One camera sample per pixel of the camera of set_camera(), lit indirectly by those photons; the film then holds\n"
          "it alone. RuntimeError before trace_viewport_photons().")
      .def(
          "draw_from_cache", &Renderer::draw_from_cache, "pixels"_a, "most_samples"_a, released,
          "Like draw_viewport(), but the light of surfaces is read from a cache that pictures before have filled, and this\n"
          "one adds to: samples of so many of its pixels (0..1), and where nothing is known yet. pixels: of this picture,\n"
          "that the cache's cells are wide. Cells are forgotten by build() and relight().")
      .def(
          "teach_light_cache", &teach_light_cache, "pixels"_a, "share"_a, "picture"_a,
          "Gives that cache the light of the film that passes have made since set_view(), which stays. share: of its\n"
          "samples, that are new since it was given last; pixels: of the film, that cells are wide. picture: (height, width, 4)\n"
          "float32, what picture() gives, denoised. ValueError where its size is another.")
      .def("light_cache", &light_cache,
           "Of the cache of draw_from_cache(): cells, and of the last picture readings, samples.")
      .def(
          "picture", &picture,
          "(height, width, 4) float32 premultiplied scene-linear RGBA, mean of the film, row 0 at the bottom.");
}

}  // namespace photon_splat
