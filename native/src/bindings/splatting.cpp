#include <cstring>

#include "bindings/atlas.h"
#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

constexpr size_t kPhotonFloats = sizeof(Photon) / sizeof(float);

void require_blocks(const Renderer& r, size_t first, size_t count, size_t columns) {
  const size_t blocks = r.points().blocks().size();
  if (first > blocks || count > blocks - first)
    throw std::out_of_range("there are not so many blocks of points");
  if (columns < 1) throw std::invalid_argument("an atlas has at least one column");
}

nb::ndarray<nb::numpy, float> photon_rows(const Renderer& r, size_t first, size_t count,
                                          size_t rows) {
  const auto& photons = r.photons();
  if (first > photons.size() || count > photons.size() - first)
    throw std::out_of_range("there are not so many photons");
  if (rows < count) throw std::invalid_argument("fewer rows than photons");
  std::vector<float> values(rows * kPhotonFloats);
  if (count) std::memcpy(values.data(), &photons[first], count * sizeof(Photon));
  return to_numpy(std::move(values), {rows, kPhotonFloats});
}

void set_photon_rows(
    Renderer& r, nb::ndarray<const float, nb::c_contig, nb::device::cpu, nb::shape<-1, 8>> rows) {
  Photons photons(rows.shape(0));
  if (!photons.empty())
    std::memcpy(static_cast<void*>(photons.data()), rows.data(), photons.size() * sizeof(Photon));
  r.map().set_photons(std::move(photons));
}

// The lists of all blocks one after the other, cut into runs of at most `longest` photons.
nb::tuple photon_runs(Renderer& r, size_t first, size_t count, uint32_t longest) {
  if (longest < 1) throw std::invalid_argument("a run has at least one photon");
  std::vector<uint32_t> order, runs;
  {
    nb::gil_scoped_release release;
    const Splatter& splatter = r.map().find_pairs(first, count);
    order = splatter.order();
    const std::vector<uint32_t>& starts = splatter.first();
    for (uint32_t b = 0; b + 1 < starts.size(); ++b)
      for (uint32_t begin = starts[b]; begin < starts[b + 1]; begin += longest) {
        const uint32_t run[3] = {b, begin, std::min(longest, starts[b + 1] - begin)};
        runs.insert(runs.end(), run, run + 3);
      }
  }
  const size_t pairs = order.size(), run_count = runs.size() / 3;
  return nb::make_tuple(to_numpy(std::move(order), {pairs}),
                        to_numpy(std::move(runs), {run_count, 3}));
}

nb::tuple point_atlas(Renderer& r, size_t first, size_t count, size_t columns) {
  require_blocks(r, first, count, columns);
  const Atlas atlas{first, count, columns};
  const size_t width = columns * Atlas::kTile, height = atlas.rows() * Atlas::kTile;
  std::vector<float> position;
  std::vector<uint32_t> plane;
  {
    nb::gil_scoped_release release;
    position.resize(4 * atlas.texels());
    plane.resize(4 * atlas.texels());
    atlas.pack(r.map().blocks(), position.data(), plane.data(), r.scene.pool(), r.cancel_flag());
  }
  return nb::make_tuple(to_numpy(std::move(position), {height, width, 4}),
                        to_numpy(std::move(plane), {height, width, 4}));
}

void set_sums(
    Renderer& r, size_t first, size_t count, size_t columns,
    nb::ndarray<const float, nb::c_contig, nb::device::cpu, nb::shape<-1, -1, Atlas::kSums>> sums) {
  require_blocks(r, first, count, columns);
  const Atlas atlas{first, count, columns};
  if (sums.shape(0) != atlas.rows() * Atlas::kTile || sums.shape(1) != columns * Atlas::kTile)
    throw std::invalid_argument("the sums have not the shape of the atlas");
  const float* values = sums.data();
  nb::gil_scoped_release release;
  atlas.unpack(values, r.map().blocks(), r.scene.pool(), r.cancel_flag());
}

// Points of the current pass as plain arrays: a copy, for tests and other splatters.
nb::dict point_arrays(const Renderer& r) {
  const auto& blocks = r.points().blocks();
  const size_t n = r.points().size();
  std::vector<float> position(3 * n), normal(3 * n), radius(n), mass(n), irradiance(3 * n),
      count(n);
  std::vector<uint32_t> key(n);
  for (size_t i = 0; i < n; ++i) {
    const PointBlock& b = blocks[i / kBlockSize];
    const size_t l = i % kBlockSize;
    const float p[3] = {b.x[l], b.y[l], b.z[l]}, d[3] = {b.nx[l], b.ny[l], b.nz[l]},
                e[3] = {b.r[l], b.g[l], b.b[l]};
    for (int c = 0; c < 3; ++c) {
      position[3 * i + c] = p[c];
      normal[3 * i + c] = d[c];
      irradiance[3 * i + c] = e[c] * b.scale[l];
    }
    radius[i] = 1 / std::sqrt(b.inverse_h2[l]);
    mass[i] = 2 * b.inverse_h2[l] / (kPi * b.scale[l]);
    count[i] = b.count[l];
    key[i] = b.key[l];
  }
  nb::dict out;
  out["position"] = to_numpy(std::move(position), {n, 3});
  out["normal"] = to_numpy(std::move(normal), {n, 3});
  out["key"] = to_numpy(std::move(key), {n});
  out["radius"] = to_numpy(std::move(radius), {n});
  out["mass"] = to_numpy(std::move(mass), {n});
  out["irradiance"] = to_numpy(std::move(irradiance), {n, 3});
  out["count"] = to_numpy(std::move(count), {n});
  return out;
}

nb::dict photon_arrays(const Renderer& r) {
  const auto& photons = r.photons();
  const size_t n = photons.size();
  std::vector<float> position(3 * n), normal(3 * n), power(3 * n);
  std::vector<uint32_t> key(n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 direction = decode_direction(photons[i].normal);
    key[i] = photons[i].key;
    for (int c = 0; c < 3; ++c) {
      position[3 * i + c] = photons[i].position[c];
      normal[3 * i + c] = direction[c];
      power[3 * i + c] = photons[i].power[c];
    }
  }
  nb::dict out;
  out["position"] = to_numpy(std::move(position), {n, 3});
  out["normal"] = to_numpy(std::move(normal), {n, 3});
  out["power"] = to_numpy(std::move(power), {n, 3});
  out["key"] = to_numpy(std::move(key), {n});
  return out;
}

}  // namespace

void bind_splatting(RendererClass& renderer) {
  renderer
      .def(
          "points", &point_arrays,
          "The selected map's visible points, by name: position (N, 3), m, relative to the origin; normal (N, 3); key (N,)\n"
          "uint32; radius (N,), m; mass (N,) of the kernel; irradiance (N, 3), W/m^2; count (N,) of photons. A copy.")
      .def(
          "photons", &photon_arrays,
          "The last batch, by name: position (N, 3), m, relative to the origin; normal (N, 3); power (N, 3), W; key (N,)\n"
          "uint32. A copy.")
      .def_prop_ro(
          "block_count", [](const Renderer& r) { return r.points().blocks().size(); },
          "Blocks of points of the pass.")
      .def_prop_ro(
          "photon_count", [](const Renderer& r) { return r.photons().size(); },
          "Photons of the last batch.")
      .def(
          "photon_rows", &photon_rows, "first"_a, "count"_a, "rows"_a,
          "(rows, 8) float32, zero from row `count` on: position, key (bits), normal and direction (bits), power.")
      .def("set_photon_rows", &set_photon_rows, "rows"_a,
           "(N, 8) float32 as photon_rows() gives them: replaces the photons of the last batch.")
      .def(
          "photon_runs", &photon_runs, "first"_a, "count"_a, "longest"_a,
          "Pairs of the photons [first, first + count) and the blocks that may catch them. Returns (P,) uint32 photons\n"
          "counted from `first`, block after block, and (R, 3) uint32 runs: block, first pair, pairs (at most `longest`).")
      .def(
          "point_atlas", &point_atlas, "first"_a, "count"_a, "columns"_a,
          "Blocks [first, first + count) as 8x8 tiles, (H, W, 4): position and 1/h^2 float32; bits of the normal and key uint32.")
      .def(
          "set_sums", &set_sums, "first"_a, "count"_a, "columns"_a, "sums"_a,
          "(H, W, 5) float32 sums of power times kernel, photons caught, and the narrow sum, of the same tiles: replaces those of the blocks.");
}

}  // namespace photon_splat
