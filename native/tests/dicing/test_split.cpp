#include <doctest/doctest.h>

#include <map>
#include <numeric>

#include "dicing/pieces.h"
#include "support/approx.h"

using namespace photon_splat;

namespace {

// Two triangles, whose places in it are those of a square of side 1.
Pieces square() {
  Pieces p;
  p.positions = {Place{0, 0, 0}, Place{1, 0, 0}, Place{1, 1, 0}, Place{0, 1, 0}};
  p.triangles = {Triangle{0, 1, 2}, Triangle{0, 2, 3}};
  p.source = {0, 0};
  p.places = {PlacesOfCorners{Vec2{0, 0}, {1, 0}, {1, 1}},
              PlacesOfCorners{Vec2{0, 0}, {1, 1}, {0, 1}}};
  return p;
}

WantedEdges of_length(double length) { return {length, std::nullopt, {}}; }

// Triangles at each edge.
std::map<std::pair<uint32_t, uint32_t>, int> edges(const Pieces& p) {
  std::map<std::pair<uint32_t, uint32_t>, int> out;
  for (const Triangle& t : p.triangles)
    for (int k = 0; k < 3; ++k) ++out[std::minmax(t[k], t[(k + 1) % 3])];
  return out;
}

double longest(const Pieces& p) {
  double out = 0;
  for (const Triangle& t : p.triangles)
    for (int k = 0; k < 3; ++k)
      out = std::max(out, length(p.positions[t[k]] - p.positions[t[(k + 1) % 3]]));
  return out;
}

double area(const Pieces& p) {
  double out = 0;
  for (const Triangle& t : p.triangles) {
    const double twice =
        cross(p.positions[t[1]] - p.positions[t[0]], p.positions[t[2]] - p.positions[t[0]]).z;
    CHECK(twice > 0);
    out += 0.5 * twice;
  }
  return out;
}

}  // namespace

TEST_CASE("edges are halved until they are short, and no crack opens") {
  ThreadPool pool(2);
  Pieces p = square();
  p.positions[2] = {3, 2, 0};  // edges of many lengths
  const double before = area(p);
  CHECK(p.halve(of_length(0.07), 20, 1u << 30, pool, [] {}));
  CHECK(longest(p) <= 0.07 * Pieces::kHalvedAbove);
  CHECK(area(p) == approx(before));
  size_t rim = 0;
  double around = 0;
  for (const auto& [ends, uses] : edges(p)) {
    CHECK(uses <= 2);
    if (uses == 2) continue;
    ++rim;
    around += length(p.positions[ends.first] - p.positions[ends.second]);
  }
  CHECK(rim > 80);
  CHECK(around == approx(2 + std::sqrt(8.0) + std::sqrt(10.0)));
}

TEST_CASE("rounds and triangles are bounded") {
  ThreadPool pool(1);
  Pieces few = square(), bounded = square(), full = square();
  CHECK(few.halve(of_length(1e-3), 3, 1u << 30, pool, [] {}));
  CHECK(few.triangles.size() == 2 * 64);
  CHECK_FALSE(bounded.halve(of_length(1e-3), 20, 1000, pool, [] {}));
  CHECK(bounded.triangles.size() > 500);
  CHECK(bounded.triangles.size() <= 1000);
  CHECK_FALSE(full.halve(of_length(1e-3), 20, 2, pool, [] {}));
  CHECK(full.triangles.size() == 2);
}

TEST_CASE("who wants no more ends it") {
  ThreadPool pool(1);
  Pieces p = square();
  int rounds = 0;
  CHECK_THROWS_AS(p.halve(of_length(1e-3), 20, 1u << 30, pool,
                          [&] {
                            if (++rounds == 4) throw Cancelled();
                          }),
                  Cancelled);
  CHECK(p.triangles.size() == 2 * 64);
}

TEST_CASE("vertices stand as triangles name them, and places stay where they are") {
  ThreadPool pool(2);
  Pieces p = square();
  p.positions.push_back({9, 9, 9});  // which no triangle has
  CHECK(p.halve(of_length(0.02), 20, 1u << 30, pool, [] {}));
  const LargeArray<uint32_t> first = p.sort_by_use();
  REQUIRE(first.size() == p.positions.size());
  uint32_t next = 0;
  for (size_t c = 0; c < 3 * p.triangles.size(); ++c) {
    const uint32_t v = p.triangles[c / 3][c % 3];
    CHECK(v <= next);
    if (v == next) CHECK(first[next++] == c);
    CHECK(p.places[c / 3][c % 3].x == approx(p.positions[v].x));
    CHECK(p.places[c / 3][c % 3].y == approx(p.positions[v].y));
  }
  CHECK(next == p.positions.size());

  // Of a quad: x + 10 y + x y
  const float known[] = {0, 1, 12, 10};
  std::vector<float> of_vertices(first.size()), of_corners(3 * p.triangles.size());
  mix(p, known, true, 1, &first, of_vertices.data(), pool);
  mix(p, known, true, 1, nullptr, of_corners.data(), pool);
  for (size_t v = 0; v < first.size(); ++v) {
    const Place& at = p.positions[v];
    CHECK(of_vertices[v] == approx(at.x + 10 * at.y + at.x * at.y));
    CHECK(of_corners[first[v]] == of_vertices[v]);
  }
}

TEST_CASE("an edge that comes near the eye counts where pixels are smallest") {
  EyeSettings s;
  s.to_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  s.width = s.height = 100;
  WantedEdges wanted{1, Eye(s), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
  const Place a{-8, 0, -1}, b{8, 0, -1};
  const double found = wanted.length_of(a, b, wanted.size_at(a), wanted.size_at(b));
  CHECK(found == approx(16 / 0.02).epsilon(1e-3));  // its middle is 1 m off
}

TEST_CASE("normals are means by area") {
  const Vec3 positions[] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 1}, {5, 5, 5}};
  const Triangle triangles[] = {{0, 1, 2}, {0, 2, 3}};
  const LargeArray<Vec3> normals = normals_by_area(positions, triangles);
  CHECK(length(normals[0] - Vec3{1, 0, 2} / std::sqrt(5.0f)) < 1e-6f);
  CHECK(length(normals[1] - Vec3{0, 0, 1}) < 1e-6f);
  CHECK(length(normals[3] - Vec3{1, 0, 0}) < 1e-6f);
  CHECK(length(normals[4] - Vec3{0, 0, 1}) == 0);  // of no triangle
}
