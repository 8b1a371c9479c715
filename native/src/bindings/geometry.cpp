// Textures, materials and meshes: numpy's arrays are copied or kept, checked by all threads.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <atomic>

#include "bindings/bindings.h"
#include "geometry/areas.h"
#include "scene/displacement.h"
#include "util/gather.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

constexpr size_t kManyTriangles = 1 << 18;  // of a mesh, for its memory to matter

// visit(element) sees each of `count` of numpy's, by all threads.
template <class T, class Source, class Visit>
void visit_in_parts(ThreadPool& pool, const Source* from, size_t count, Visit&& visit) {
  const T* source = reinterpret_cast<const T*>(from);
  pool.for_parts(count, 1 << 15, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) visit(i, source[i]);
  });
}

uint32_t add_mesh(Renderer& r, Array<float, nb::shape<-1, 3>> positions,
                  Array<uint32_t, nb::shape<-1, 3>> triangles,
                  std::optional<Array<float, nb::shape<-1, 3, 3>>> corner_normals,
                  std::optional<Array<float, nb::shape<-1, 3, 2>>> uv,
                  std::optional<Array<uint16_t, nb::shape<-1>>> slots,
                  std::optional<Array<float, nb::shape<-1, 3>>> vertex_normals) {
  const size_t vertices = positions.shape(0), count = triangles.shape(0);
  if (count >= (1u << 30))
    throw std::invalid_argument("a mesh has more triangles than the renderer can hold");
  if ((corner_normals && corner_normals->shape(0) != count) || (uv && uv->shape(0) != count) ||
      (slots && slots->shape(0) != count))
    throw std::invalid_argument("a mesh's corner data does not fit its triangles");
  if (vertex_normals && (corner_normals || vertex_normals->shape(0) != vertices))
    throw std::invalid_argument("a mesh's normals do not fit its vertices");
  Mesh mesh;
  std::atomic<bool> outside{false}, not_finite{false};
  mesh.triangles = lent_or_copied<Triangle>(triangles);
  visit_in_parts<Triangle>(r.scene.pool(), triangles.data(), count, [&](size_t, const Triangle& t) {
    if (std::max({t[0], t[1], t[2]}) >= vertices) outside.store(true, std::memory_order_relaxed);
  });
  if (outside) throw std::invalid_argument("a mesh's triangle names a vertex that does not exist");
  mesh.positions.resize(vertices + 1);
  mesh.positions.back() = {};  // Embree reads 16 bytes at the last vertex
  visit_in_parts<Vec3>(r.scene.pool(), positions.data(), vertices, [&](size_t i, const Vec3& p) {
    mesh.positions[i] = p;
    if (!is_finite(p)) not_finite.store(true, std::memory_order_relaxed);
  });
  if (not_finite) throw std::invalid_argument("a mesh has a vertex that is not finite");
  if (corner_normals) mesh.corner_normals = lent_or_copied<Vec3>(*corner_normals);
  if (vertex_normals) {
    mesh.vertex_normals = lent_or_copied<Vec3>(*vertex_normals);
    // Those of corners are found sooner, but are six times as many.
    if (count < kManyTriangles) mesh.spread_normals(r.scene.pool());
  }
  if (uv) mesh.uv = lent_or_copied<Vec2>(*uv);
  if (slots) mesh.slots.assign(slots->data(), slots->data() + count);
  r.scene.meshes.push_back(std::move(mesh));
  return static_cast<uint32_t>(r.scene.meshes.size() - 1);
}

// Vec3s as rows of numbers for numpy.
auto rows(std::vector<Vec3>&& values, std::initializer_list<size_t> shape) {
  auto kept = std::make_unique<std::vector<Vec3>>(std::move(values));
  float* const data = reinterpret_cast<float*>(kept->data());
  nb::capsule owner(kept.release(),
                    [](void* p) noexcept { delete static_cast<std::vector<Vec3>*>(p); });
  return nb::ndarray<nb::numpy, float>(data, shape, owner);
}

nb::tuple displace_mesh(Renderer& r, uint32_t instance,
                        const std::vector<std::pair<int, bool>>& slots,
                        std::optional<Array<bool, nb::shape<-1>>> smooth, bool own_corners) {
  std::vector<SlotDisplacement> of_slots;
  for (const auto& [program, bumps] : slots) of_slots.push_back({program, bumps});
  std::vector<bool> smooth_ones;
  if (smooth) smooth_ones.assign(smooth->data(), smooth->data() + smooth->size());
  DisplacedMesh moved;
  {
    nb::gil_scoped_release release;
    moved = displace(r.scene, instance, of_slots, smooth_ones, own_corners, CancelFlag{});
  }
  const size_t corners = moved.corner_normals.size(), vertices = moved.positions.size();
  const auto or_none = [](std::vector<Vec3>& normals, std::initializer_list<size_t> shape) {
    return normals.empty() ? nb::object(nb::none()) : nb::cast(rows(std::move(normals), shape));
  };
  return nb::make_tuple(rows(std::move(moved.positions), {vertices, 3}),
                        or_none(moved.corner_normals, {corners / 3, 3, 3}),
                        or_none(moved.vertex_normals, {vertices, 3}), moved.not_finite);
}

Interpolation interpolation_named(const std::string& name) {
  return named<Interpolation>(name,
                              {{"linear", Interpolation::kLinear},
                               {"closest", Interpolation::kClosest},
                               {"cubic", Interpolation::kCubic}},
                              "interpolation");
}

Extension extension_named(const std::string& name) {
  return named<Extension>(name,
                          {{"repeat", Extension::kRepeat},
                           {"extend", Extension::kExtend},
                           {"clip", Extension::kClip},
                           {"clip_opaque", Extension::kClipOpaque},
                           {"mirror", Extension::kMirror}},
                          "extension");
}

uint32_t add_texture_reading(Renderer& r, uint32_t of, const std::string& interpolation,
                             const std::string& extension) {
  if (of >= r.scene.textures.size())
    throw std::invalid_argument("a reading names a texture that does not exist");
  r.scene.textures.push_back(
      r.scene.textures[of].reading(interpolation_named(interpolation), extension_named(extension)));
  return static_cast<uint32_t>(r.scene.textures.size() - 1);
}

size_t texture_memory(const Renderer& r) {
  std::vector<const Texture*> kept;
  for (const Texture& t : r.scene.textures) kept.push_back(t.pixels_of ? t.pixels_of.get() : &t);
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  size_t sum = 0;
  for (const Texture* t : kept) sum += t->memory();
  return sum;
}

uint32_t add_texture(
    Renderer& r, nb::ndarray<nb::c_contig, nb::device::cpu, nb::shape<-1, -1, 4>, nb::ro> pixels,
    bool srgb, const std::string& interpolation, const std::string& extension) {
  Texture texture;
  texture.height = static_cast<int>(pixels.shape(0));
  texture.width = static_cast<int>(pixels.shape(1));
  if (texture.width < 1 || texture.height < 1)
    throw std::invalid_argument("a texture has no pixels");
  texture.srgb = srgb;
  texture.interpolation = interpolation_named(interpolation);
  texture.extension = extension_named(extension);
  if (pixels.dtype() == nb::dtype<uint8_t>()) {
    const auto* p = static_cast<const uint8_t*>(pixels.data());
    texture.bytes.assign(p, p + pixels.size());
  } else if (pixels.dtype() == nb::dtype<float>()) {
    const auto* p = static_cast<const float*>(pixels.data());
    texture.floats.assign(p, p + pixels.size());
    for (float& f : texture.floats)
      if (!std::isfinite(f)) f = 0;
  } else {
    throw std::invalid_argument("a texture's pixels are neither uint8 nor float32");
  }
  texture.compact();
  r.scene.textures.push_back(std::move(texture));
  return static_cast<uint32_t>(r.scene.textures.size() - 1);
}

MaterialSide make_side(const Renderer& r, const nb::tuple& t) {
  MaterialSide side;
  side.albedo = to_rgb(nb::cast<Rgb3>(t[0]));
  side.albedo_texture = nb::cast<int>(t[1]);
  side.emission = to_rgb(nb::cast<Rgb3>(t[2]));
  side.emission_texture = nb::cast<int>(t[3]);
  if (!is_finite(side.albedo) || !is_finite(side.emission))
    throw std::invalid_argument("a material has a colour that is not finite");
  side.albedo = max(side.albedo, Vec3{});
  for (int texture : {side.albedo_texture, side.emission_texture})
    if (texture >= static_cast<int>(r.scene.textures.size()))
      throw std::invalid_argument("a material names a texture that does not exist");
  return side;
}

std::vector<std::tuple<uint32_t, uint32_t, float, bool>> coincident(const Renderer& r) {
  nb::gil_scoped_release release;
  std::vector<std::tuple<uint32_t, uint32_t, float, bool>> found;
  for (const Coincident& c : r.coincident_surfaces())
    found.emplace_back(c.instance, c.other, c.share, c.passed);
  return found;
}

}  // namespace

void bind_geometry(nb::module_& m, RendererClass& renderer) {
  m.def(
      "all_have_area",
      [](Array<float, nb::shape<-1, 3>> positions, Array<uint32_t, nb::shape<-1, 3>> triangles) {
        const std::span places(reinterpret_cast<const Vec3*>(positions.data()), positions.shape(0));
        const std::span all(reinterpret_cast<const Triangle*>(triangles.data()),
                            triangles.shape(0));
        nb::gil_scoped_release release;
        return all_have_area(places, all);
      },
      "positions"_a, "triangles"_a,
      "Whether all triangles, (T, 3) uint32 vertices of (V, 3) float32 positions, have an area that is more than 0 and\n"
      "finite in single precision. ValueError for vertices that do not exist.");
  m.def(
      "gather",
      [](Array<uint32_t, nb::shape<-1, -1>> values, Array<uint32_t, nb::shape<-1>> indices,
         nb::ndarray<uint32_t, nb::c_contig, nb::device::cpu, nb::shape<-1, -1>> out) {
        const std::span from(values.data(), values.size()), by(indices.data(), indices.size());
        const std::span to(out.data(), out.size());
        const auto width = static_cast<uint32_t>(values.shape(1));
        nb::gil_scoped_release release;
        gather(from, width, by, to);
      },
      "values"_a, "indices"_a, "out"_a.noconvert(),
      "out (N, W) = values (R, W) at (N,) indices, all uint32, W up to 3. ValueError for rows that do not exist.");
  renderer
      .def(
          "set_origin",
          [](Renderer& r, std::array<double, 3> o, float near) {
            std::copy(o.begin(), o.end(), r.scene.origin);
            r.scene.near = near;
          },
          "origin"_a, "near"_a = 0.0f,
          "World position (x, y, z), m, that the renderer's coordinates are relative to; before anything is added.\n"
          "near: radius, m, of what stands close to it where other things are very far off, else 0.")
      .def(
          "add_texture", &add_texture, "pixels"_a, "srgb"_a, "interpolation"_a, "extension"_a,
          "(height, width, 4) uint8 or float32, row 0 at the bottom; those of floats are scene-linear or sRGB too.\n"
          "srgb: colours are sRGB-encoded. interpolation: 'linear', 'closest', 'cubic'; extension: 'repeat', 'extend',\n"
          "'clip', 'clip_opaque' (with an alpha of 1 outside), 'mirror'. Returns the texture's index. ValueError for\n"
          "another dtype or name, or no pixels.")
      .def("add_texture_reading", &add_texture_reading, "of"_a, "interpolation"_a, "extension"_a,
           "The pixels of texture `of` read in another way; they are kept once. Returns its index.")
      .def_prop_ro("texture_memory", &texture_memory, "Bytes of all textures' pixels.")
      .def(
          "add_material",
          [](Renderer& r, nb::tuple front, nb::tuple back) {
            r.scene.materials.push_back({make_side(r, front), make_side(r, back)});
          },
          "front"_a, "back"_a,
          "A Lambertian material without a program. Each side: (albedo rgb, albedo texture or -1, emission rgb in\n"
          "W/m^2/sr, emission texture or -1). ValueError for what is not finite or a texture that is not there.")
      .def(
          "add_mesh", &add_mesh, "positions"_a, "triangles"_a, "corner_normals"_a.none(),
          "uv"_a.none(), "slots"_a.none(), "vertex_normals"_a = nb::none(),
          "positions: (V, 3) float32, m, in the mesh's own space; triangles: (T, 3) uint32 vertices; corner_normals:\n"
          "(T, 3, 3) float32 or None; uv: (T, 3, 2) float32 or None; slots: (T,) uint16 material slots or None;\n"
          "vertex_normals: (V, 3) float32 instead of corner_normals. Large arrays other than positions are not copied\n"
          "but kept: they must not change any more. Returns the mesh's index. ValueError for shapes that do not fit,\n"
          "vertices that do not exist or are not finite.")
      .def(
          "coincident_surfaces", &coincident,
          "Surfaces that lie exactly in each other, in view or beside it, in a built scene, as (instance, instance of the\n"
          "other, share of the picture, whether light passes the first), the largest share first; the two may be the same.")
      .def(
          "displace", &displace_mesh, "instance"_a, "slots"_a, "smooth"_a = nb::none(),
          "own_corners"_a = false,
          "True displacement of an instance's mesh, before build(); the mesh, which must have normals, stays as it is.\n"
          "slots: of each (program or -1, whether a bump of its material bends the normals); smooth: (T,) bool, None: all;\n"
          "own_corners: corner normals are more than those of vertices. Returns (V, 3) positions, (T, 3, 3) corner normals\n"
          "or None, (V, 3) vertex normals instead or None (neither: all is flat), and how many vertices had no finite place to go to and stay.");
}

}  // namespace photon_splat
