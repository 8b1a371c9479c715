// What moves while the shutter is open.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>

#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

constexpr size_t kMostSteps = RTC_MAX_TIME_STEP_COUNT;

using Matrices = Array<double, nb::shape<-1, 4, 4>>;

void check_steps(size_t steps) {
  if (steps < 3 || steps % 2 == 0 || steps > kMostSteps)
    throw std::invalid_argument("a motion has an odd number of steps, 3 to " +
                                std::to_string(kMostSteps));
}

std::vector<Affine> relative(const Renderer& r, const Matrices& matrices) {
  check_steps(matrices.shape(0));
  std::vector<Affine> steps(matrices.shape(0));
  for (size_t i = 0; i < steps.size(); ++i)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) {
        const double value =
            matrices.data()[16 * i + 4 * row + column] - (column == 3 ? r.scene.origin[row] : 0.0);
        if (!std::isfinite(value))
          throw std::invalid_argument("a motion has a matrix that is not finite");
        steps[i].m[4 * row + column] = static_cast<float>(value);
      }
  return steps;
}

// Steps but the middle one; each has `more` elements that nobody sets beyond its own.
std::vector<LargeArray<Vec3>> steps_of(const float* values, size_t steps, size_t count,
                                       size_t more) {
  std::vector<LargeArray<Vec3>> out(steps);
  for (size_t i = 0; i < steps; ++i) {
    if (i == steps / 2) continue;
    out[i].resize(count + more);
    const Vec3* from = reinterpret_cast<const Vec3*>(values) + i * count;
    std::copy_n(from, count, out[i].begin());
    std::fill_n(out[i].begin() + static_cast<std::ptrdiff_t>(count), more, Vec3{});
  }
  return out;
}

void set_mesh_motion(Renderer& r, uint32_t index, Array<float, nb::shape<-1, -1, 3>> positions,
                     std::optional<Array<float, nb::shape<-1, -1, 3, 3>>> corner_normals,
                     std::optional<Array<float, nb::shape<-1, -1, 3>>> vertex_normals) {
  if (index >= r.scene.meshes.size())
    throw std::invalid_argument("a motion names a mesh that does not exist");
  Mesh& mesh = r.scene.meshes[index];
  if (mesh.strands) throw std::invalid_argument("a motion of a mesh names strands");
  const size_t steps = positions.shape(0), vertices = mesh.positions.size() - 1,
               triangles = mesh.triangles.size();
  check_steps(steps);
  const bool smooth = mesh.is_smooth();
  if (positions.shape(1) != vertices)
    throw std::invalid_argument("a mesh's motion does not fit its vertices");
  if ((corner_normals &&
       (corner_normals->shape(0) != steps || corner_normals->shape(1) != triangles)) ||
      (vertex_normals &&
       (vertex_normals->shape(0) != steps || vertex_normals->shape(1) != vertices)) ||
      (corner_normals && vertex_normals) || (!smooth && (corner_normals || vertex_normals)))
    throw std::invalid_argument("the normals of a mesh's motion do not fit the mesh");
  for (size_t i = 0; i < 3 * steps * vertices; ++i)
    if (!std::isfinite(positions.data()[i]))
      throw std::invalid_argument("a mesh's motion has a vertex that is not finite");
  if (corner_normals || vertex_normals) mesh.spread_normals(r.scene.pool());
  MeshMotion motion;
  motion.positions = steps_of(positions.data(), steps, vertices, 1);
  if (corner_normals)
    motion.corner_normals = steps_of(corner_normals->data(), steps, 3 * triangles, 0);
  if (vertex_normals) {
    motion.corner_normals.resize(steps);
    for (size_t i = 0; i < steps; ++i) {
      if (i == steps / 2) continue;
      const Vec3* normals = reinterpret_cast<const Vec3*>(vertex_normals->data()) + i * vertices;
      motion.corner_normals[i].reserve(3 * triangles);
      for (const Triangle& t : mesh.triangles)
        for (const uint32_t vertex : t) motion.corner_normals[i].push_back(normals[vertex]);
    }
  }
  mesh.motion = std::move(motion);
}

void set_shutter(Renderer& r, Array<float, nb::shape<-1>> curve, float rolling) {
  for (size_t i = 0; i < curve.shape(0); ++i)
    if (!std::isfinite(curve.data()[i]))
      throw std::invalid_argument("the shutter's curve is not finite");
  r.scene.shutter.set({curve.data(), curve.shape(0)}, rolling);
}

void set_camera_motion(Renderer& r, Matrices matrices, std::array<float, 2> zoom) {
  if (!std::isfinite(zoom[0]) || !std::isfinite(zoom[1]))
    throw std::invalid_argument("the camera's motion has a zoom that is not finite");
  r.camera_settings.motion = relative(r, matrices);
  r.camera_settings.zoom_before = zoom[0];
  r.camera_settings.zoom_after = zoom[1];
}

}  // namespace

void bind_motion(RendererClass& renderer) {
  renderer
      .def(
          "set_shutter", &set_shutter, "curve"_a, "rolling"_a,
          "Camera paths and, where something moves, photon paths then have a time of their own. curve: (K,) float32, how far\n"
          "open at equal steps of its time, all alike if there is none; rolling: share of its time that each line of the\n"
          "picture is exposed for, the topmost first, or -1 for all at once. Steps below are evenly spread over the time\n"
          "that the shutter is open; an odd number, of which the middle one is the mesh, instance or camera as it was added.")
      .def(
          "set_motion",
          [](Renderer& r, uint32_t instance, Matrices matrices) {
            r.scene.set_motion(instance, relative(r, matrices));
          },
          "instance"_a, "matrices"_a, "(S, 4, 4) float64, to the world.")
      .def(
          "set_mesh_motion", &set_mesh_motion, "mesh"_a, "positions"_a,
          "corner_normals"_a = nb::none(), "vertex_normals"_a = nb::none(),
          "positions: (S, V, 3) float32; (S, T, 3, 3) or (S, V, 3) normals of a smooth mesh, whose own else\n"
          "turn with its triangles. Before build().")
      .def(
          "set_camera_motion", &set_camera_motion, "matrices"_a, "zoom"_a,
          "After set_camera(). matrices: (S, 4, 4) float64; zoom: size of the frame as the shutter opens and as it closes,\n"
          "over that in the middle.");
}

}  // namespace photon_splat
