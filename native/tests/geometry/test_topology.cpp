#include "geometry/topology.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <set>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

Topology topology_of(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  ScratchMemory scratch;
  return build_topology(positions, triangles, scratch);
}

Topology topology_of(const Mesh& mesh) { return topology_of(mesh.positions, mesh.triangles); }

size_t patches_of(const Topology& topology) { return topology.planar.size(); }

float perimeter(const Topology& topology, uint32_t patch) {
  float sum = 0;
  for (uint32_t i = topology.first_edge[patch]; i < topology.first_edge[patch + 1]; ++i)
    sum += length(topology.edges[i].b - topology.edges[i].a);
  return sum;
}

}  // namespace

TEST_CASE("a plane is one planar patch with the same boundary however it is tessellated") {
  for (int n : {1, 2, 30}) {
    const Topology topology = topology_of(make_grid(n));
    CHECK(topology.planar == std::vector<uint8_t>{1});
    CHECK(topology.edges.size() == size_t(4 * n));
    CHECK(perimeter(topology, 0) == approx(4));
    CHECK(topology.curvature.empty());
  }
}

TEST_CASE("a cube is six planar patches whose edges run counter-clockwise") {
  const Topology topology = topology_of(make_cube());
  REQUIRE(topology.planar == std::vector<uint8_t>(6, 1));
  for (uint32_t patch = 0; patch < 6; ++patch) {
    CHECK(perimeter(topology, patch) == approx(4));
    float twice_area = 0;
    for (uint32_t i = topology.first_edge[patch]; i < topology.first_edge[patch + 1]; ++i) {
      const BoundaryEdge& edge = topology.edges[i];
      CHECK(edge.patch == patch);
      twice_area +=
          dot(cross(edge.a - topology.edges[topology.first_edge[patch]].a, edge.b - edge.a),
              edge.normal);
    }
    CHECK(twice_area == approx(2));
  }
}

TEST_CASE("a smooth sphere is one patch without an end, and knows its curvature") {
  const Topology topology = topology_of(make_sphere(32, 64));
  CHECK(topology.planar == std::vector<uint8_t>{0});
  CHECK(topology.edges.empty());
  const Mesh sphere = make_sphere(32, 64);
  for (uint32_t t = 0; t < sphere.triangles.size(); ++t)
    CHECK(topology.curvature_of(t) == approx(1).epsilon(0.5));
}

TEST_CASE("a triangle and its double are no neighbours") {
  Mesh mesh = make_grid(1);
  const size_t once = mesh.triangles.size();
  for (size_t t = 0; t < once; ++t) mesh.triangles.own().push_back(mesh.triangles[t]);
  const Topology topology = topology_of(mesh);
  CHECK(std::set(topology.patch.begin(), topology.patch.end()).size() == 2 * once);
  CHECK(topology.edges.size() == 3 * 2 * once);
}

TEST_CASE("vertices at one place are one vertex") {
  Mesh mesh = make_cube(), split;
  for (const Triangle& t : mesh.triangles) {
    const uint32_t first = static_cast<uint32_t>(split.positions.size());
    for (uint32_t v : t) split.positions.push_back(mesh.positions[v]);
    split.triangles.own().push_back({first, first + 1, first + 2});
  }
  split.positions[1].x = -0.0f;
  const Topology a = topology_of(mesh), b = topology_of(split);
  CHECK(a.patch == b.patch);
  CHECK(a.first_edge == b.first_edge);
}

TEST_CASE("halves of a sphere that share places and no vertices are one patch") {
  Mesh sphere = make_sphere(32, 64);
  const uint32_t once = static_cast<uint32_t>(sphere.positions.size());
  for (uint32_t v = 0; v < once; ++v) sphere.positions.push_back(Vec3{sphere.positions[v]});
  for (Triangle& t : sphere.triangles.own()) {
    const Vec3 middle = sphere.positions[t[0]] + sphere.positions[t[1]] + sphere.positions[t[2]];
    if (middle.x > 0)
      for (uint32_t& vertex : t) vertex += once;
  }
  const Topology topology = topology_of(sphere);
  CHECK(patches_of(topology) == 1);
  CHECK(topology.edges.empty());
}

TEST_CASE("two sheets in one another are two patches, each as it is alone") {
  Mesh sheets = make_grid(12);
  const Mesh one = make_grid(12);
  const uint32_t vertices = static_cast<uint32_t>(one.positions.size());
  for (const Vec3& p : one.positions) sheets.positions.push_back(p);
  for (const Triangle& t : one.triangles)
    sheets.triangles.own().push_back({t[0] + vertices, t[1] + vertices, t[2] + vertices});
  const Topology topology = topology_of(sheets);
  REQUIRE(patches_of(topology) == 2);
  for (uint32_t patch : {0, 1}) CHECK(perimeter(topology, patch) == approx(4));
}

TEST_CASE("a patch of a million triangles knows its area and its rim") {
  const Topology topology = topology_of(make_grid(800));
  REQUIRE(patches_of(topology) == 1);
  CHECK(topology.patch_area[0] == approx(1).epsilon(1e-4));
  CHECK(topology.patch_rim[0] == approx(4).epsilon(1e-4));
}

TEST_CASE("an edge of three triangles ends every patch there") {
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, -1, 0.01f}};
  const std::vector<Triangle> triangles{{0, 1, 2}, {1, 0, 3}, {1, 0, 4}};
  const Topology topology = topology_of(positions, triangles);
  CHECK(std::set<uint32_t>(topology.patch.begin(), topology.patch.end()).size() == 3);
}

TEST_CASE("a fan of many triangles around one vertex takes no quadratic time" *
          doctest::timeout(5)) {
  constexpr uint32_t count = 100000;
  std::vector<Vec3> positions{{0, 0, 0}};
  std::vector<Triangle> triangles;
  for (uint32_t i = 0; i < count; ++i) {
    const double phi = 2 * M_PI * i / count;
    positions.push_back({float(1000 * std::cos(phi)), float(1000 * std::sin(phi)), 0});
    triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  }
  const Topology topology = topology_of(positions, triangles);
  CHECK(topology.first_edge.size() == 2);
  CHECK(topology.edges.size() == count);
}

TEST_CASE("the edge tree finds what a search through all edges finds") {
  Mesh mesh = make_cube();
  const Mesh grid = make_grid(12);
  for (const Vec3& p : grid.positions) mesh.positions.push_back(p + Vec3{2, 0.25f, 0});
  for (const Triangle& t : grid.triangles)
    mesh.triangles.own().push_back({t[0] + 8, t[1] + 8, t[2] + 8});

  const Topology topology = topology_of(mesh);
  const EdgeTree tree(topology.edges);
  for (uint32_t i = 0; i < 200; ++i) {
    const Vec2 u = sobol_2d(i, 0, 0), w = sobol_2d(i, 1, 0);
    const Vec3 x{u.x * 4 - 0.5f, u.y * 2 - 0.5f, w.x - 0.2f};
    const float radius = w.y * 0.6f;
    for (uint32_t patch = 0; patch + 1 < topology.first_edge.size(); ++patch) {
      std::set<const BoundaryEdge*> found;
      tree.near(x, radius, patch,
                [&](const BoundaryEdge& edge) { CHECK(found.insert(&edge).second); });
      for (const BoundaryEdge& edge : topology.edges) {
        const Vec3 along = edge.b - edge.a;
        const float t = std::clamp(dot(x - edge.a, along) / length2(along), 0.0f, 1.0f);
        if (edge.patch == patch && length(edge.a + along * t - x) < radius)
          CHECK(found.count(&edge) == 1);
        if (edge.patch != patch) CHECK(found.count(&edge) == 0);
      }
    }
  }
}
