// Adaptive subdivision: numpy's arrays come in, and those of the pieces go out without a copy.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "bindings/bindings.h"
#include "dicing/pieces.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

using Places = Array<double, nb::shape<-1, 3>>;

Place place(const Places& places, size_t i) {
  const double* p = places.data() + 3 * i;
  return {p[0], p[1], p[2]};
}

std::array<double, 12> rows_of(const Matrix& matrix) {
  std::array<double, 12> rows;
  std::copy_n(matrix.data(), 12, rows.begin());
  return rows;
}

// Hands an array of structures of Ts over to numpy.
template <class T, class Row>
auto handed_over(LargeArray<Row>&& values, std::initializer_list<size_t> shape) {
  auto kept = std::make_unique<LargeArray<Row>>(std::move(values));
  T* const data = reinterpret_cast<T*>(kept->data());
  nb::capsule owner(kept.release(),
                    [](void* p) noexcept { delete static_cast<LargeArray<Row>*>(p); });
  return nb::ndarray<nb::numpy, T>(data, shape, owner);
}

Eye make_eye(const std::string& lens, Matrix matrix, std::array<double, 4> screen, double width,
             double height, double angle, double offscreen) {
  EyeSettings s;
  s.lens = named<EyeLens>(lens,
                          {{"perspective", EyeLens::kPerspective},
                           {"orthographic", EyeLens::kOrthographic},
                           {"panorama", EyeLens::kPanorama}},
                          "lens");
  s.to_world = rows_of(matrix);
  std::tie(s.left, s.right, s.bottom, s.top) = std::tuple_cat(screen);
  s.width = width;
  s.height = height;
  s.angle = angle;
  s.offscreen = offscreen;
  return Eye(s);
}

auto pixel_sizes(const Eye& eye, Places places) {
  std::vector<double> sizes(places.shape(0));
  for (size_t i = 0; i < sizes.size(); ++i) sizes[i] = eye.pixel_size(place(places, i));
  const size_t count = sizes.size();
  return to_numpy(std::move(sizes), {count});
}

auto edge_lengths(const WantedEdges& wanted, Places starts, Places ends) {
  const size_t count = starts.shape(0);
  if (ends.shape(0) != count) throw std::invalid_argument("edges have not as many ends as starts");
  std::vector<double> lengths(count);
  for (size_t i = 0; i < count; ++i) {
    const Place a = place(starts, i), b = place(ends, i);
    lengths[i] = wanted.length_of(a, b, wanted.size_at(a), wanted.size_at(b));
  }
  return to_numpy(std::move(lengths), {count});
}

// Pieces as Python holds them. Once sorted they have no positions and triangles of their own.
struct PieceSet {
  Pieces pieces;
  LargeArray<uint32_t> first;  // corner at each vertex
  size_t sources = 0;
  bool is_sorted = false;
  ThreadPool pool{0};

  PieceSet(Places positions, Array<uint32_t, nb::shape<-1, 3>> triangles,
           Array<uint32_t, nb::shape<-1>> source, Array<float, nb::shape<-1, 3, 2>> places) {
    const size_t vertices = positions.shape(0), count = triangles.shape(0);
    if (source.shape(0) != count || places.shape(0) != count)
      throw std::invalid_argument("sources and places of pieces do not fit their triangles");
    const auto fill = [](auto& to, const void* from, size_t rows) {
      to.resize(rows);
      if (rows) std::memcpy(static_cast<void*>(to.data()), from, rows * sizeof to[0]);
    };
    fill(pieces.positions, positions.data(), vertices);
    fill(pieces.triangles, triangles.data(), count);
    fill(pieces.source, source.data(), count);
    fill(pieces.places, places.data(), count);
    for (const Triangle& t : pieces.triangles)
      if (std::max({t[0], t[1], t[2]}) >= vertices)
        throw std::invalid_argument("a piece names a vertex that does not exist");
    for (const uint32_t s : pieces.source) sources = std::max<size_t>(sources, size_t{s} + 1);
  }
};

bool halve(PieceSet& set, const WantedEdges& wanted, unsigned rounds, size_t limit,
           const nb::callable& go_on) {
  if (set.is_sorted) throw std::invalid_argument("pieces that are sorted cannot be halved");
  nb::gil_scoped_release release;
  return set.pieces.halve(wanted, rounds, limit, set.pool, [&] {
    nb::gil_scoped_acquire acquire;
    go_on();
  });
}

nb::tuple take_mesh(PieceSet& set) {
  if (set.is_sorted) throw std::invalid_argument("the mesh of these pieces has been taken");
  LargeArray<Vec3> positions;
  {
    nb::gil_scoped_release release;
    set.first = set.pieces.sort_by_use();
    set.is_sorted = true;
    positions.reserve(set.pieces.positions.size());
    for (const Place& p : set.pieces.positions) positions.push_back(p.rounded());
    set.pieces.positions = {};
  }
  const size_t vertices = positions.size(), count = set.pieces.triangles.size();
  return nb::make_tuple(handed_over<float>(std::move(positions), {vertices, 3}),
                        handed_over<uint32_t>(std::move(set.pieces.triangles), {count, 3}));
}

LargeArray<float> mixed_values(PieceSet& set, const Array<float, nb::shape<-1, -1, -1>>& known,
                               bool of_vertices, bool unit) {
  const size_t ends = known.shape(1), components = known.shape(2);
  if (known.shape(0) < set.sources || ends < 3 || ends > 4)
    throw std::invalid_argument("values do not fit what the pieces are parts of");
  if (unit && components != 3)
    throw std::invalid_argument("only values of three components are directions");
  if (of_vertices && !set.is_sorted)
    throw std::invalid_argument("the mesh of these pieces has not been taken");
  nb::gil_scoped_release release;
  const LargeArray<uint32_t>* corners = of_vertices ? &set.first : nullptr;
  LargeArray<float> out((of_vertices ? set.first.size() : 3 * set.pieces.places.size()) *
                        components);
  mix(set.pieces, {known.data(), known.size()}, ends == 4, components, corners, out.data(),
      set.pool);
  if (unit) make_unit({reinterpret_cast<Vec3*>(out.data()), out.size() / 3}, set.pool);
  return out;
}

auto mixed(PieceSet& set, Array<float, nb::shape<-1, -1, -1>> known, bool of_vertices, bool unit) {
  LargeArray<float> out = mixed_values(set, known, of_vertices, unit);
  const size_t components = known.shape(2), rows = components ? out.size() / components : 0;
  return handed_over<float>(std::move(out), {rows, components});
}

auto normals_by_area_of(Array<float, nb::shape<-1, 3>> positions,
                        Array<uint32_t, nb::shape<-1, 3>> triangles) {
  const size_t vertices = positions.shape(0), count = triangles.shape(0);
  const std::span places(reinterpret_cast<const Vec3*>(positions.data()), vertices);
  const std::span all(reinterpret_cast<const Triangle*>(triangles.data()), count);
  LargeArray<Vec3> normals;
  {
    nb::gil_scoped_release release;
    for (const Triangle& t : all)
      if (std::max({t[0], t[1], t[2]}) >= vertices)
        throw std::invalid_argument("a triangle names a vertex that does not exist");
    normals = normals_by_area(places, all);
  }
  return handed_over<float>(std::move(normals), {vertices, 3});
}

}  // namespace

void bind_dicing(nb::module_& m) {
  nb::class_<Eye>(m, "Eye", "How large a pixel is at places of the world, as Cycles counts it.")
      .def(
          "__init__",
          [](Eye* self, const std::string& lens, Matrix matrix, std::array<double, 4> screen,
             double width, double height, double angle, double offscreen) {
            new (self) Eye(make_eye(lens, matrix, screen, width, height, angle, offscreen));
          },
          "lens"_a, "matrix"_a, "screen"_a, "width"_a, "height"_a, "angle"_a, "offscreen"_a,
          "lens: 'perspective', 'orthographic', 'panorama'; matrix: (4, 4) float64, camera to world; screen: left, right,\n"
          "bottom, top of the frame; width, height: its pixels; angle: rad, a panorama's pixel; offscreen: out of view\n"
          "pixels grow with the distance from it, offscreen - 1 times as fast as with that from the camera.")
      .def("pixel_sizes", &pixel_sizes, "places"_a,
           "(N,) float64, m, the width of a pixel at each of (N, 3) float64 places.");
  nb::class_<WantedEdges>(m, "WantedEdges", "How long edges are to be.")
      .def(
          "__init__",
          [](WantedEdges* self, double length, std::optional<Eye> eye, Matrix matrix) {
            if (!(length > 0))
              throw std::invalid_argument("the wanted length of edges is not positive");
            new (self) WantedEdges{length, std::move(eye), rows_of(matrix)};
          },
          "length"_a, "eye"_a.none(), "matrix"_a,
          "length: pixels of `eye` of a mesh that stands by matrix, (4, 4) float64, or else units of the mesh's own.\n"
          "ValueError where it is not positive.")
      .def("lengths", &edge_lengths, "starts"_a, "ends"_a,
           "(N,) float64 of edges between (N, 3) float64 positions of the mesh; 1: as wanted.");
  nb::class_<PieceSet>(m, "Pieces", "Parts of the triangles, or quads, of a mesh.")
      .def(
          nb::init<Places, Array<uint32_t, nb::shape<-1, 3>>, Array<uint32_t, nb::shape<-1>>,
                   Array<float, nb::shape<-1, 3, 2>>>(),
          "positions"_a, "triangles"_a, "source"_a, "places"_a,
          "positions: (V, 3) float64; triangles: (T, 3) uint32 vertices; source: (T,) uint32, the triangle or quad that\n"
          "each is part of; places: (T, 3, 2) float32, where in it the corners are. ValueError for what does not fit.")
      .def(
          "halve", &halve, "wanted"_a, "rounds"_a, "limit"_a, "go_on"_a,
          "Halves edges at most `rounds` times, until they are about as long as wanted, and tells whether they are or the\n"
          "rounds are used up: no more than `limit` triangles are made, where the longest edges are halved first.\n"
          "go_on() is called before each round; what it raises ends it.")
      .def(
          "take_mesh", &take_mesh,
          "(V, 3) float32 positions and (T, 3) uint32 triangles, which are not kept here. Vertices stand in the order in\n"
          "which triangles name them. Once; no halving after it.")
      .def(
          "mixed", &mixed, "known"_a, "of_vertices"_a, "unit"_a = false,
          "(3 T, K) float32 of all corners, or (V, K) of the mesh's vertices, between `known`: (S, 3, K) float32 at the\n"
          "corners of triangles, or (S, 4, K) at those of quads. unit: they are directions of length 1, +Z where there is\n"
          "none. ValueError for what does not fit.")
      .def_prop_ro(
          "source",
          [](PieceSet& set) {
            return nb::ndarray<nb::numpy, const uint32_t>(set.pieces.source.data(),
                                                          {set.pieces.source.size()}, nb::handle());
          },
          nb::rv_policy::reference_internal,
          "(T,) uint32, the triangle or quad that each is part of.");
  m.def(
      "normals_by_area", &normals_by_area_of, "positions"_a, "triangles"_a,
      "(V, 3) float32 unit normals of vertices: means of the triangles' by their areas, +Z where there is none.");
}

}  // namespace photon_splat
