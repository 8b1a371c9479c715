#include "geometry/areas.h"

#include <doctest/doctest.h>

#include <limits>

using namespace photon_splat;

TEST_CASE("triangles without an area, or beyond all numbers, are found among many") {
  std::vector<Vec3> positions = {{0, 0, 0}, {1e-15f, 0, 0}, {0, 1e-15f, 0}, {2e-15f, 0, 0}};
  for (const size_t count : {size_t{1}, size_t{1} << 18}) {
    std::vector<Triangle> triangles(count, Triangle{0, 1, 2});
    CHECK(all_have_area(positions, triangles));
    triangles.back() = {0, 1, 3};
    CHECK_FALSE(all_have_area(positions, triangles));
    triangles.back() = {0, 1, 4};
    CHECK_THROWS_AS(all_have_area(positions, triangles), std::invalid_argument);
  }
  positions[1].x = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(all_have_area(positions, std::vector<Triangle>{{0, 1, 2}}));
  positions[1].x = positions[2].y = 1e30f;
  CHECK_FALSE(all_have_area(positions, std::vector<Triangle>{{0, 1, 2}}));
  CHECK(all_have_area(positions, {}));
}
