// Volume grids, and the objects that have them.
#include <nanobind/stl/array.h>

#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

uint32_t add_grid(Renderer& r, Matrix to_index, std::array<int, 3> lower,
                  Array<int32_t, nb::shape<-1, -1, -1>> table,
                  Array<float, nb::shape<-1, VolumeGrid::kVoxels, -1>> values,
                  std::array<float, 4> background) {
  Affine matrix;
  for (size_t i = 0; i < 12; ++i) matrix.m[i] = static_cast<float>(to_index.data()[i]);
  VolumeGrid::Index bricks;
  for (size_t a = 0; a < 3; ++a) bricks[a] = static_cast<int>(table.shape(a));
  r.scene.grids.push_back(std::make_shared<const VolumeGrid>(
      static_cast<uint32_t>(values.shape(2)), matrix, lower, bricks,
      std::vector<int32_t>(table.data(), table.data() + table.size()),
      std::vector<float>(values.data(), values.data() + values.size()), background));
  return static_cast<uint32_t>(r.scene.grids.size() - 1);
}

void add_mesh_grid(Renderer& r, uint32_t mesh, uint32_t attribute, uint32_t grid) {
  if (mesh >= r.scene.meshes.size() || grid >= r.scene.grids.size())
    throw std::invalid_argument("a volume grid or its mesh does not exist");
  r.scene.meshes[mesh].grids.push_back({attribute, r.scene.grids[grid]});
}

}  // namespace

void bind_grids(RendererClass& renderer) {
  renderer
      .def(
          "add_grid", &add_grid, "to_index"_a, "lower"_a, "table"_a, "values"_a, "background"_a,
          "A volume grid in bricks of 8 x 8 x 8 voxels. to_index: (4, 4) float64 from the object's coordinates to\n"
          "voxels; lower: voxel where the first brick begins; table: (X, Y, Z) int32, the brick at each place or -1;\n"
          "values: (B, 512, 1, 3 or 4) float32, z fastest; background: value where there is no brick. Returns the\n"
          "grid's index. ValueError for what does not fit or is not finite.")
      .def("add_mesh_grid", &add_mesh_grid, "mesh"_a, "attribute"_a, "grid"_a,
           "Programs of the medium within a mesh read this grid by that id.");
}

}  // namespace photon_splat
