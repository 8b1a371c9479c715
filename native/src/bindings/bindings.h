// Shared by the files that make up the Python module.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "render/renderer.h"

namespace photon_splat {

// Hands a vector over to numpy.
template <class T, class Memory>
nanobind::ndarray<nanobind::numpy, T> to_numpy(std::unique_ptr<std::vector<T, Memory>> values,
                                               std::initializer_list<size_t> shape) {
  T* const data = values->data();
  nanobind::capsule owner(values.release(),
                          [](void* p) noexcept { delete static_cast<std::vector<T, Memory>*>(p); });
  return nanobind::ndarray<nanobind::numpy, T>(data, shape, owner);
}
template <class T>
nanobind::ndarray<nanobind::numpy, T> to_numpy(std::vector<T>&& values,
                                               std::initializer_list<size_t> shape) {
  return to_numpy(std::make_unique<std::vector<T>>(std::move(values)), shape);
}

// Shader programs, what they read from meshes and instances, and their table of operations.
void bind_shading(nanobind::module_& m, nanobind::class_<Renderer>& renderer);

// The value that `known` gives to a name; std::invalid_argument for another one.
template <class E>
E named(const std::string& name, std::initializer_list<std::pair<const char*, E>> known,
        const char* what) {
  for (const auto& [text, value] : known)
    if (name == text) return value;
  throw std::invalid_argument("unknown " + std::string(what) + " '" + name + "'");
}

// World, skies and suns.
void bind_world(nanobind::module_& m, nanobind::class_<Renderer>& renderer);

// The picture: means over the film's samples as arrays.
void bind_film(nanobind::class_<Renderer>& renderer);

// What a splatter outside of the native module needs: photons, pairs, points as an atlas, sums.
void bind_splatting(nanobind::class_<Renderer>& renderer);

// What a viewport needs: another camera, the store of photons, the picture as it is drawn.
void bind_viewport(nanobind::class_<Renderer>& renderer);

}  // namespace photon_splat
