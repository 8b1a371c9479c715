// A film with what is known of the picture, whoever has made its sums.
#pragma once

#include <nanobind/nanobind.h>

#include <optional>

#include "bindings/bindings.h"

namespace photon_splat {

struct FilmView {
  const RenderFilm& film;
  ThreadPool& pool;
  float exposure;
  bool transparent, catchers;  // the camera does not see the world; there are shadow catchers
};

FilmView view_of(Renderer& renderer);
// Those asked for by name, or all that the film keeps.
nanobind::dict film_arrays(const FilmView& view,
                           const std::optional<std::vector<std::string>>& names);
// What the film is to keep for one of them. Throws std::invalid_argument for another name.
ChannelMask channels_of_array(const std::string& name);

}  // namespace photon_splat
