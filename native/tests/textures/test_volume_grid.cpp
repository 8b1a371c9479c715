#include "support/approx.h"
#include "textures/volume_grid.h"

#include <doctest/doctest.h>

#include <stdexcept>

#include "math/sampling.h"
#include "support/grids.h"

using namespace photon_splat;

namespace {

// Voxels are half a metre wide, and shifted.
constexpr Affine kToIndex{{2, 0, 0, 1, 0, 2, 0, -3, 0, 0, 2, 0.5f}};

Vec3 at_voxel(float x, float y, float z) { return inverse(kToIndex).point({x, y, z}); }

}  // namespace

TEST_CASE("a volume grid is what it was made of at its voxels and linear between them") {
  const auto f = [](float x, float y, float z, uint32_t c) {
    return 1 + 0.5f * x - 0.25f * y + 0.125f * z + 2 * static_cast<float>(c);
  };
  for (const uint32_t components : {1u, 3u, 4u}) {
    const VolumeGrid grid = grid_of({-5, 3, -20}, {15, 24, 1}, kToIndex, components, f);
    Random random(1, components);
    for (int i = 0; i < 2000; ++i) {
      const float x = -4 + 17 * random.next(), y = 4 + 18 * random.next(),
                  z = -19 + 17 * random.next();
      const auto linear = grid.at(at_voxel(x, y, z), GridInterpolation::kLinear),
                 cubic = grid.at(at_voxel(x, y, z), GridInterpolation::kCubic),
                 one = grid.at(at_voxel(std::round(x), std::round(y), std::round(z)),
                               GridInterpolation::kVoxel);
      for (uint32_t c = 0; c < components; ++c) {
        REQUIRE(linear[c] == approx(f(x, y, z, c)).epsilon(1e-4));
        REQUIRE(cubic[c] == approx(f(x, y, z, c)).epsilon(1e-4));
        REQUIRE(one[c] == approx(f(std::round(x), std::round(y), std::round(z), c)));
      }
      for (uint32_t c = components; c < 4; ++c) REQUIRE(linear[c] == 0);
    }
  }
}

TEST_CASE("a volume grid fades into the background over the last voxel, and holds nothing beyond") {
  const VolumeGrid grid = grid_of({0, 0, 0}, {8, 8, 8}, Affine{}, 1, [](auto...) { return 2; });
  const auto at = [&](float x, GridInterpolation how = GridInterpolation::kLinear) {
    return grid.at({x, 4, 4}, how)[0];
  };
  CHECK(at(7) == 2);
  CHECK(at(7.5f) == approx(1));
  CHECK(at(8) == 0);
  CHECK(at(-0.25f) == approx(1.5));
  CHECK(at(-1) == 0);
  CHECK(at(0, GridInterpolation::kCubic) == approx(2 * 5 / 6.0));
  for (const float far : {1e4f, -1e4f, 1e12f, INFINITY, NAN}) CHECK(at(far) == 0);
}

TEST_CASE("drawn voxels come as often as they weigh") {
  const VolumeGrid grid =
      grid_of({0, 0, 0}, {8, 8, 8}, Affine{}, 1, [](int x, auto...) { return x * x; });
  double sum = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i)
    sum += double(grid.at({3.3f, 2, 1 + float(i) / kCount}, GridInterpolation::kVoxel)[0]) / kCount;
  CHECK(sum == approx(0.7 * 9 + 0.3 * 16).epsilon(0.01));
}

TEST_CASE("a volume grid knows its largest and smallest values in a box") {
  Random values(5, 1);
  const VolumeGrid grid = grid_of({-9, -9, -9}, {15, 23, 7}, Affine{}, 1, [&](int x, auto...) {
    return x < -1 ? 0 : values.next() - 0.5f;
  });
  CHECK(!grid.extremes({-9, -9, -9}, {-2, 22, 6}));
  Random random(6, 1);
  for (int i = 0; i < 50; ++i) {
    VolumeGrid::Index from, to;
    for (size_t a = 0; a < 3; ++a) {
      from[a] = -1 + static_cast<int>(10 * random.next());
      to[a] = std::min(from[a] + static_cast<int>(12 * random.next()), 6);
      from[a] = std::min(from[a], to[a]);
    }
    float most = -1, least = 1;
    for (int x = from[0]; x <= to[0]; ++x)
      for (int y = from[1]; y <= to[1]; ++y)
        for (int z = from[2]; z <= to[2]; ++z) {
          most = std::max(most, *grid.voxel({x, y, z}));
          least = std::min(least, *grid.voxel({x, y, z}));
        }
    const auto found = grid.extremes(from, to);
    REQUIRE(found);
    CHECK(*grid.voxel(found->most) == most);
    CHECK(*grid.voxel(found->least) == least);
  }
}

TEST_CASE("volume grids that do not fit are refused") {
  const std::vector<float> brick(VolumeGrid::kVoxels, 1.0f);
  const auto make = [&](uint32_t components, VolumeGrid::Index bricks, std::vector<int32_t> table,
                        std::vector<float> values) {
    return VolumeGrid(components, Affine{}, {}, bricks, std::move(table), std::move(values), {});
  };
  CHECK_NOTHROW(make(1, {1, 1, 2}, {0, -1}, brick));
  CHECK_THROWS_AS(make(2, {1, 1, 2}, {0, -1}, brick), std::invalid_argument);
  CHECK_THROWS_AS(make(1, {1, 1, 2}, {0}, brick), std::invalid_argument);
  CHECK_THROWS_AS(make(1, {1, 1, 2}, {0, 1}, brick), std::invalid_argument);
  CHECK_THROWS_AS(make(1, {1, 1, 0}, {}, brick), std::invalid_argument);
  CHECK_THROWS_AS(make(3, {1, 1, 2}, {0, -1}, brick), std::invalid_argument);
  std::vector<float> bad = brick;
  bad[7] = NAN;
  CHECK_THROWS_AS(make(1, {1, 1, 2}, {0, -1}, bad), std::invalid_argument);
}
