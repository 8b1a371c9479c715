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

template <class T, class... Shape>
using Array = nanobind::ndarray<const T, nanobind::c_contig, nanobind::device::cpu, Shape...>;
using Matrix = Array<double, nanobind::shape<4, 4>>;  // affine, row by row
using Rgb3 = std::array<float, 3>;

// numpy's array as one of Ts: kept where it is large, copied where it is not.
template <class T, class Source>
MeshArray<T> lent_or_copied(const Source& array) {
  constexpr size_t kLent = size_t{1} << 20;  // bytes
  const T* const first = reinterpret_cast<const T*>(array.data());
  const size_t count = array.nbytes() / sizeof(T);
  if (array.nbytes() < kLent) return LargeArray<T>(first, first + count);
  return {first, count, std::make_shared<Source>(array)};
}

inline Rgb to_rgb(const Rgb3& c) { return {c[0], c[1], c[2]}; }

// The upper three rows, relative to the renderer's origin.
inline std::array<double, 12> relative_rows(const double* matrix, const double origin[3]) {
  std::array<double, 12> rows;
  std::copy_n(matrix, 12, rows.begin());
  for (int i = 0; i < 3; ++i) rows[4 * i + 3] -= origin[i];
  return rows;
}
inline Affine relative(const Matrix& matrix, const double origin[3]) {
  const auto rows = relative_rows(matrix.data(), origin);
  Affine out;
  for (int i = 0; i < 12; ++i) out.m[i] = static_cast<float>(rows[i]);
  return out;
}

// The value that `known` gives to a name; std::invalid_argument for another one.
template <class E>
E named(const std::string& name, std::initializer_list<std::pair<const char*, E>> known,
        const char* what) {
  for (const auto& [text, value] : known)
    if (name == text) return value;
  throw std::invalid_argument("unknown " + std::string(what) + " '" + name + "'");
}

using RendererClass = nanobind::class_<Renderer>;

// Textures, materials, meshes, instances.
void bind_geometry(nanobind::module_& m, RendererClass& renderer);
void bind_strands(RendererClass& renderer);
// Volume grids.
void bind_grids(RendererClass& renderer);
void bind_instances(RendererClass& renderer);
// Lamps, light groups, world, skies and suns.
void bind_lights(nanobind::module_& m, RendererClass& renderer);
void bind_camera(RendererClass& renderer);
// The shutter, and what moves while it is open.
void bind_motion(RendererClass& renderer);
// Shader programs, what they read from meshes and instances, and their table of operations.
void bind_shading(nanobind::module_& m, RendererClass& renderer);
// Options, passes and their stages.
void bind_render(nanobind::module_& m, RendererClass& renderer);
void bind_statistics(RendererClass& renderer);
// The picture: means over the film's samples as arrays.
void bind_film(RendererClass& renderer);
// Sums of a film, which those of other machines are added to.
void bind_sums(nanobind::module_& m, RendererClass& renderer);
void bind_data_passes(RendererClass& renderer);
// What a splatter outside of the native module needs: photons, pairs, points as an atlas, sums.
void bind_splatting(RendererClass& renderer);
// What a viewport and other renders of the scene need: other cameras, other light.
void bind_viewport(RendererClass& renderer);
// Adaptive subdivision.
void bind_dicing(nanobind::module_& m);

}  // namespace photon_splat
