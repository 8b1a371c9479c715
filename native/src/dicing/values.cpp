#include "dicing/pieces.h"

namespace photon_splat {

void mix(const Pieces& pieces, std::span<const float> known, bool quads, size_t components,
         const LargeArray<uint32_t>* corners, float* out, ThreadPool& pool) {
  const size_t count = corners ? corners->size() : 3 * pieces.places.size();
  const size_t ends = quads ? 4 : 3;
  pool.for_parts(count, 1 << 14, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t corner = corners ? (*corners)[i] : i;
      const auto [x, y] = pieces.places[corner / 3][corner % 3];
      const float of_quad[4] = {(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y};
      const float of_triangle[3] = {1 - x - y, x, y};
      const float* weight = quads ? of_quad : of_triangle;
      const float* at = &known[pieces.source[corner / 3] * ends * components];
      for (size_t k = 0; k < components; ++k) {
        float sum = 0;
        for (size_t e = 0; e < ends; ++e) sum += weight[e] * at[e * components + k];
        out[i * components + k] = sum;
      }
    }
  });
}

void make_unit(std::span<Vec3> directions, ThreadPool& pool) {
  pool.for_parts(directions.size(), 1 << 14, CancelFlag{}, [&](size_t begin, size_t end) {
    for (Vec3& d : directions.subspan(begin, end - begin)) {
      const float l = length(d);
      d = l > 0 ? d / std::max(l, 1e-30f) : Vec3{0, 0, 1};
    }
  });
}

LargeArray<Vec3> normals_by_area(std::span<const Vec3> positions,
                                 std::span<const Triangle> triangles) {
  LargeArray<Place> sums(positions.size(), Place{});
  const auto place = [&](uint32_t v) {
    return Place{positions[v].x, positions[v].y, positions[v].z};
  };
  for (const Triangle& t : triangles) {
    const Place a = place(t[0]), n = cross(place(t[1]) - a, place(t[2]) - a);
    for (const uint32_t v : t) sums[v] = sums[v] + n;
  }
  LargeArray<Vec3> normals(positions.size());
  for (size_t v = 0; v < sums.size(); ++v) {
    const double l = length(sums[v]);
    const Place& sum = sums[v];
    normals[v] = l > 0 ? Place{sum.x / l, sum.y / l, sum.z / l}.rounded() : Vec3{0, 0, 1};
  }
  return normals;
}

}  // namespace photon_splat
