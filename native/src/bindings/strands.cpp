// Curves and points.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

static_assert(sizeof(StrandKey) == 4 * sizeof(float));

std::span<const StrandKey> keys_of(const float* values, size_t count) {
  return {reinterpret_cast<const StrandKey*>(values), count};
}

uint32_t add_strands(Renderer& r, Array<float, nb::shape<-1, 4>> keys,
                     std::optional<Array<uint32_t, nb::shape<-1>>> first, const std::string& shape,
                     uint32_t subdivisions, std::optional<Array<uint16_t, nb::shape<-1>>> slots,
                     std::optional<Array<float, nb::shape<-1, 2>>> uv) {
  const auto kind = named<StrandShape>(shape,
                                       {{"ribbon", StrandShape::kRibbon},
                                        {"thick", StrandShape::kThick},
                                        {"linear", StrandShape::kThickLinear},
                                        {"point", StrandShape::kPoint}},
                                       "shape of strands");
  if (subdivisions < 1 || subdivisions > 1u << 16)
    throw std::invalid_argument("a number of subdivisions of strands is out of range");
  std::vector<uint32_t> firsts;
  if (first) firsts.assign(first->data(), first->data() + first->size());
  Mesh mesh;
  mesh.strands = std::make_unique<Strands>(kind, subdivisions, keys_of(keys.data(), keys.shape(0)),
                                           std::move(firsts));
  const Strands& strands = *mesh.strands;
  if ((slots && slots->shape(0) != strands.count()) || (uv && uv->shape(0) != strands.count()))
    throw std::invalid_argument("data of strands does not fit them");
  if (slots) {
    mesh.slots.resize(strands.segments());
    for (uint32_t s = 0; s < strands.segments(); ++s)
      mesh.slots[s] = slots->data()[strands.strand(s)];
  }
  if (uv) {
    const Vec2* from = reinterpret_cast<const Vec2*>(uv->data());
    mesh.uv = LargeArray<Vec2>(from, from + strands.count());
  }
  r.scene.meshes.push_back(std::move(mesh));
  return static_cast<uint32_t>(r.scene.meshes.size() - 1);
}

void set_strand_motion(Renderer& r, uint32_t index, Array<float, nb::shape<-1, -1, 4>> keys) {
  if (index >= r.scene.meshes.size() || !r.scene.meshes[index].strands)
    throw std::invalid_argument("a motion of strands names none");
  Strands& strands = *r.scene.meshes[index].strands;
  if (keys.shape(1) != strands.key_count() || keys.shape(0) > RTC_MAX_TIME_STEP_COUNT)
    throw std::invalid_argument("steps of strands do not fit their keys");
  strands.set_motion(keys_of(keys.data(), keys.shape(0) * keys.shape(1)), keys.shape(0));
}

}  // namespace

void bind_strands(RendererClass& renderer) {
  renderer
      .def(
          "add_strands", &add_strands, "keys"_a, "first"_a.none(), "shape"_a, "subdivisions"_a = 4,
          "slots"_a = nb::none(), "uv"_a = nb::none(),
          "keys: (K, 4) float32, position, m, and radius, m; first: (C + 1,) uint32, the first key of each curve, of which\n"
          "each has two or more, and K; None: points. shape: 'ribbon', 'thick', 'linear' (round, straight between keys) or\n"
          "'point'; subdivisions: of a ribbon between two keys; slots: (C,) uint16; uv: (C, 2) float32. Returns its index\n"
          "among meshes, for add_instance() and attributes: those on points are of keys, those on faces of curves.\n"
          "ValueError for what is not finite or does not fit.")
      .def("set_strand_motion", &set_strand_motion, "mesh"_a, "keys"_a,
           "(S, K, 4) float32, at steps as for set_mesh_motion().");
}

}  // namespace photon_splat
