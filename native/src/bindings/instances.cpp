// Instances of meshes: numpy's arrays over all of them.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

template <class T>
using OfInstances = Array<T, nb::shape<-1>>;
template <class T>
using MayBe = std::optional<OfInstances<T>>;

void add_instances(Renderer& r, OfInstances<uint32_t> meshes,
                   Array<double, nb::shape<-1, 4, 4>> matrices, OfInstances<uint32_t> sets,
                   const std::vector<std::vector<int32_t>>& materials, MayBe<uint8_t> groups,
                   MayBe<uint64_t> lit_groups, MayBe<uint64_t> blockers,
                   MayBe<int16_t> light_groups, MayBe<RayMask> seen_by, MayBe<bool> holdouts,
                   MayBe<float> terminator_offsets, MayBe<bool> catchers, MayBe<float> densities) {
  const size_t count = meshes.shape(0);
  bool fits = matrices.shape(0) == count && sets.shape(0) == count;
  const auto check = [&](const auto& values) {
    fits = fits && (!values || values->shape(0) == count);
  };
  check(groups), check(lit_groups), check(blockers), check(light_groups), check(seen_by);
  check(holdouts), check(terminator_offsets), check(catchers), check(densities);
  if (!fits) throw std::invalid_argument("arrays of instances differ in length");
  const nb::gil_scoped_release release;
  r.scene.instances.reserve(r.scene.instances.size() + count);
  for (size_t i = 0; i < count; ++i) {
    const auto rows = relative_rows(matrices.data() + 16 * i, r.scene.origin);
    for (double d : rows)
      if (!std::isfinite(d))
        throw std::invalid_argument("an instance has a matrix that is not finite");
    const uint32_t set = sets.data()[i];
    if (set >= materials.size())
      throw std::invalid_argument("an instance names materials that do not exist");
    r.scene.add_instance(meshes.data()[i], rows, materials[set]);
    Instance& added = r.scene.instances.back();
    const auto take = [&](auto& to, const auto& values) {
      if (values) to = values->data()[i];
    };
    if (groups) {
      if (groups->data()[i] > 63)
        throw std::invalid_argument("an instance has a group of light linking beyond 0..63");
      added.group = uint64_t{1} << groups->data()[i];
    }
    take(added.lit_groups, lit_groups);
    take(added.blockers, blockers);
    take(added.light_group, light_groups);
    take(added.seen_by, seen_by);
    take(added.holdout, holdouts);
    take(added.terminator_offset, terminator_offsets);
    take(added.catcher, catchers);
    take(added.density, densities);
    if (!(added.density >= 0) || !std::isfinite(added.density))
      throw std::invalid_argument("an instance has a density that is negative or not finite");
  }
}

}  // namespace

void bind_instances(RendererClass& renderer) {
  renderer.def(
      "add_instances", &add_instances, "meshes"_a, "matrices"_a, "sets"_a, "materials"_a,
      "groups"_a = nb::none(), "lit_groups"_a = nb::none(), "blockers"_a = nb::none(),
      "light_groups"_a = nb::none(), "seen_by"_a = nb::none(), "holdouts"_a = nb::none(),
      "terminator_offsets"_a = nb::none(), "catchers"_a = nb::none(), "densities"_a = nb::none(),
      "After their meshes and materials. Arrays over instances; matrices: (I, 4, 4) float64, to the world; materials:\n"
      "sets of indices, one for each slot, of which `sets` names one each. For light linking: groups 0..63, and as\n"
      "emitters bits of the groups they light (lit_groups) and of those that block them (blockers). light_groups: index,\n"
      "-1 for none; seen_by: bits of the kinds of rays that meet them; holdouts: holes in the picture;\n"
      "terminator_offsets: cosine below which shadow rays start off the surface that smooth normals promise, 0: nowhere;\n"
      "catchers: show the camera what other things take from its light, and no more; densities: coefficients of media\n"
      "over what programs say. ValueError for what does not exist or is not finite.");
}

}  // namespace photon_splat
