#include "geometry/bent_normals.h"

#include <doctest/doctest.h>

#include "geometry/mesh.h"

using namespace photon_splat;

namespace {

// A cube's four sides, shaded as a cylinder is, and its lid, which is flat.
Mesh tube_with_lid() {
  Mesh mesh;
  for (const float z : {-1.0f, 1.0f})
    for (const auto& [x, y] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}})
      mesh.positions.push_back({x, y, z});
  const auto add = [&](Triangle t, bool smooth, uint16_t slot) {
    mesh.triangles.own().push_back(t);
    mesh.slots.push_back(slot);
    const Vec3 a = mesh.positions[t[0]];
    const Vec3 face = normalize(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
    for (const uint32_t k : t) {
      const Vec3& p = mesh.positions[k];
      mesh.corner_normals.own().push_back(smooth ? normalize(Vec3{p.x, p.y, 0}) : face);
    }
  };
  for (uint32_t k = 0; k < 4; ++k) {
    const uint32_t next = (k + 1) % 4;
    add({k, next, next + 4}, true, 0);
    add({k, next + 4, k + 4}, true, 0);
  }
  add({4, 5, 6}, false, 0);
  add({4, 6, 7}, false, 1);
  return mesh;
}

}  // namespace

TEST_CASE("the share of a mesh that is shaded as another shape is known by slot") {
  Mesh mesh = tube_with_lid();
  const std::vector<float> bent = bent_shares(mesh);
  REQUIRE(bent.size() == 2);
  CHECK(bent[0] == doctest::Approx(16.0 / 18.0));
  CHECK(bent[1] == 0);
}

TEST_CASE("normals that point inwards, or have no length, bend nothing") {
  Mesh mesh = tube_with_lid();
  mesh.corner_normals.own().clear();
  CHECK(bent_shares(mesh).empty());
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]];
    const Vec3 face = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    for (int k = 0; k < 3; ++k) mesh.corner_normals.own().push_back(-face);
  }
  CHECK(bent_shares(mesh).empty());
  for (Vec3& n : mesh.corner_normals.own()) n = {};
  CHECK(bent_shares(mesh).empty());
}
