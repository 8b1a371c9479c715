#include "scene/scene.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <stdexcept>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

Placement moved(double x, double y, double z) { return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z}; }

constexpr Placement mirrored{-1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0};  // the unit square onto itself

}  // namespace

TEST_CASE("a ray meets the front or the back, with normals on its own side") {
  for (const Placement& place : {identity, mirrored}) {
    for (bool shared : {false, true}) {
      Scene scene(2);
      fill(scene, make_grid(1), shared ? std::vector{place, moved(0, 0, -50)} : std::vector{place});
      CHECK(scene.instances[0].shared == shared);
      Surface s;
      REQUIRE(scene.intersect({0.25f, 0.5f, 2}, {0, 0, -1}, 0, 10, true, s));
      CHECK(s.distance == approx(2));
      CHECK_FALSE(s.back);
      CHECK(length(s.ng - Vec3{0, 0, 1}) < 1e-6f);
      const uint32_t front_key = s.key;
      REQUIRE(scene.intersect({0.25f, 0.5f, -2}, {0, 0, 1}, 0, 10, false, s));
      CHECK(s.back);
      CHECK(length(s.ng - Vec3{0, 0, -1}) < 1e-6f);
      CHECK(s.key != front_key);
      CHECK(scene.occluded({0.5f, 0.5f, 2}, {0, 0, -1}, 0, 10));
      CHECK_FALSE(scene.occluded({0.5f, 0.5f, 2}, {0, 0, -1}, 0, 1));
      CHECK_FALSE(scene.intersect({3, 3, 2}, {0, 0, -1}, 0, 10, true, s));
    }
  }
}

TEST_CASE("triangles of one plane share a key, two instances of it do not") {
  Scene scene(1);
  fill(scene, make_grid(4), {moved(0, 0, 0), moved(0, 0, 5)});
  Surface a, b, other;
  REQUIRE(scene.intersect({0.1f, 0.1f, 1}, {0, 0, -1}, 0, 10, true, a));
  REQUIRE(scene.intersect({0.9f, 0.8f, 1}, {0, 0, -1}, 0, 10, true, b));
  REQUIRE(scene.intersect({0.9f, 0.8f, 6}, {0, 0, -1}, 0, 10, true, other));
  CHECK(a.key == b.key);
  CHECK(a.triangle != b.triangle);
  CHECK(a.key != other.key);
  CHECK(other.position.z == approx(5));
}

TEST_CASE("an empty scene is no error") {
  Scene scene(2);
  scene.build(CancelFlag());
  Surface s;
  CHECK_FALSE(scene.intersect({0, 0, 0}, {0, 0, 1}, 0, 10, true, s));
  CHECK(scene.bounds().empty());
  CHECK(scene.radius() > 0);
}

TEST_CASE("a cancelled build stops with Cancelled") {
  Scene scene(2);
  scene.materials.resize(1);
  scene.meshes.push_back(padded(make_sphere(200, 400)));
  scene.add_instance(0, identity, {0});
  CancelFlag cancel;
  cancel.set();
  CHECK_THROWS_AS(scene.build(cancel), Cancelled);
}

TEST_CASE("indices that point nowhere are refused") {
  Scene scene(1);
  scene.materials.resize(1);
  scene.meshes.push_back(padded(make_grid(1)));
  CHECK_THROWS_AS(scene.add_instance(1, identity, {0}), std::invalid_argument);
  CHECK_THROWS_AS(scene.add_instance(0, identity, {1}), std::invalid_argument);
  CHECK_THROWS_AS(scene.add_instance(0, identity, {}), std::invalid_argument);
}

TEST_CASE(
    "a ray that leaves a surface meets what lies as close behind it as rounding tells apart") {
  Scene scene(1);
  fill(scene, make_grid(1), {moved(0, 0, 0), moved(0, 0, -1.5e-5)});
  Surface top, below;
  const Vec3 down{0, 0, -1};
  REQUIRE(scene.intersect({0.3f, 0.6f, 10}, down, 0, 100, true, top));
  CHECK(top.position.z == approx(0).scale(1));
  REQUIRE(scene.intersect(leave(top, down), down, 0, 100, false, below));
  CHECK(below.instance != top.instance);
  CHECK_FALSE(scene.occluded(leave(top, -down), -down, 0, 100));
  REQUIRE(scene.intersect({0.3f, 0.6f, 10}, down, past(top), 100, false, below));
  CHECK(below.instance != top.instance);
}
