// Passes that tell what is seen, as arrays.
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

using Moves = Array<double, nb::shape<-1, 2, 4, 4>>;
using Shape = std::pair<uint32_t, Array<float, nb::shape<2, -1, 3>>>;  // of which mesh

Affine relative(const Renderer& r, const double* matrix, bool both) {
  Affine out;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      double value = matrix[4 * row + column];
      if (column == 3) {
        value -= r.scene.origin[row];
        for (int k = 0; both && k < 3; ++k) value += matrix[4 * row + k] * r.scene.origin[k];
      }
      out.m[4 * row + column] = static_cast<float>(value);
    }
  return out;
}

void set_frames(Renderer& r, Array<int32_t, nb::shape<-1>> moved, Moves moves,
                const std::vector<Shape>& shapes, Array<double, nb::shape<2, 4, 4>> camera,
                std::array<float, 2> zoom) {
  auto frames = std::make_unique<NeighbouringFrames>();
  frames->of_instance.assign(r.scene.instances.size(), -1);
  frames->shapes.resize(r.scene.meshes.size());
  const auto fits = [](bool fits) {
    if (!fits) throw std::invalid_argument("the neighbouring frames do not fit the scene");
  };
  fits(moved.shape(0) == moves.shape(0));
  for (size_t i = 0; i < moved.shape(0); ++i) {
    const size_t instance = static_cast<size_t>(moved.data()[i]);
    fits(instance < r.scene.instances.size());
    frames->of_instance[instance] = static_cast<int32_t>(i);
    const double* const matrix = moves.data() + 32 * i;
    frames->moves.push_back({relative(r, matrix, true), relative(r, matrix + 16, true)});
  }
  for (const auto& [mesh, offsets] : shapes) {
    fits(mesh < r.scene.meshes.size());
    const size_t count = offsets.shape(1);
    const Vec3* const from = reinterpret_cast<const Vec3*>(offsets.data());
    frames->shapes[mesh] = {std::vector<Vec3>(from, from + count),
                            std::vector<Vec3>(from + count, from + 2 * count)};
  }
  frames->camera = {relative(r, camera.data(), false), relative(r, camera.data() + 16, false)};
  frames->zoom = zoom;
  frames->check(r.scene);
  r.frames = std::move(frames);
}

nb::dict data_passes(Renderer& r, Array<int32_t, nb::shape<-1>> object_index,
                     Array<float, nb::shape<-1>> object_id, Array<float, nb::shape<-1>> asset_id,
                     Array<int32_t, nb::shape<-1>> material_index,
                     Array<float, nb::shape<-1>> material_id, uint32_t levels,
                     std::array<float, 3> mist, float alpha_threshold,
                     std::vector<std::vector<int32_t>> programs, uint32_t samples) {
  const auto frames = std::move(r.frames);
  const auto all = [](const auto& array) { return std::span(array.data(), array.size()); };
  const DataLabels labels{std::move(programs), all(object_index), all(material_index),
                          all(object_id),      all(asset_id),     all(material_id),
                          frames.get()};
  if (levels > 32) throw std::invalid_argument("a matte has at most 32 levels");
  DataPasses passes;
  {
    nb::gil_scoped_release release;
    passes =
        r.data_passes(labels, {samples, levels, 0, alpha_threshold, {mist[0], mist[1], mist[2]}});
  }
  const size_t width = r.camera_settings.region_width, height = r.camera_settings.region_height;
  nb::dict out;
  const auto put = [&](const char* name, std::vector<float>& values, size_t channels) {
    out[name] = to_numpy(std::move(values), {height, width, channels});
  };
  put("position", passes.position, 3);
  put("uv", passes.uv, 3);
  put("mist", passes.mist, 1);
  put("object_index", passes.object_index, 1);
  put("material_index", passes.material_index, 1);
  put("vector", passes.vector, 4);
  nb::list values;
  for (auto& one : passes.values) values.append(to_numpy(std::move(one), {height, width, 4}));
  out["values"] = values;
  if (levels) {
    put("object_matte", passes.mattes[0], 2 * levels);
    put("asset_matte", passes.mattes[1], 2 * levels);
    put("material_matte", passes.mattes[2], 2 * levels);
  }
  return out;
}

}  // namespace

void bind_data_passes(RendererClass& renderer) {
  renderer.def(
      "set_frames", &set_frames, "moved"_a, "moves"_a, "shapes"_a, "camera"_a, "zoom"_a,
      "What the next data_passes() tells of motion: where things are a frame earlier and a frame later. moved: (N,) int32 which\n"
      "instances; moves: (N, 2, 4, 4) float64 from where a point of them is in the world; shapes: pairs of a mesh and\n"
      "(2, V, 3) float32, how far its vertices or keys are from where they are, in its own coordinates; camera: (2, 4, 4)\n"
      "float64 to the world; zoom: size of its frame over that of now. ValueError where it does not fit.");
  renderer.def(
      "data_passes", &data_passes, "object_index"_a, "object_id"_a, "asset_id"_a,
      "material_index"_a, "material_id"_a, "levels"_a, "mist"_a, "alpha_threshold"_a, "programs"_a,
      "samples"_a,
      "(height, width, channels) float32 by name, row 0 at the bottom, of camera rays of their own: position, uv, mist,\n"
      "object_index, material_index, and where levels is not 0 object_matte, asset_matte and material_matte, pairs of id and\n"
      "coverage; vector, 0 without set_frames(); values: a list, of each of `programs`, (height, width, 4). Labels by\n"
      "instance and by material; programs: of each pass of that kind indices of programs by material, or -1; mist: start\n"
      "and depth, m, and power; what is less opaque than alpha_threshold is no first surface. After build(). ValueError\n"
      "where labels are missing.");
}

}  // namespace photon_splat
