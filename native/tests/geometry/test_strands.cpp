// Curves and points as rays meet them.
#include <doctest/doctest.h>

#include <stdexcept>

#include "scene/scene.h"
#include "support/approx.h"
#include "support/meshes.h"

using namespace photon_splat;

namespace {

// Along z from `x`, thinner towards its tip.
std::vector<StrandKey> upright(float x, float radius = 0.1f) {
  std::vector<StrandKey> keys;
  for (int k = 0; k < 5; ++k) keys.push_back({{x, 0, float(k)}, radius});
  return keys;
}

Mesh strands(StrandShape shape, const std::vector<StrandKey>& keys,
             std::vector<uint32_t> first = {}) {
  Mesh mesh;
  if (first.empty() && shape != StrandShape::kPoint) first = {0, uint32_t(keys.size())};
  mesh.strands = std::make_unique<Strands>(shape, 4, keys, std::move(first));
  return mesh;
}

void put(Scene& scene, Mesh&& mesh, const std::vector<Placement>& places = {identity}) {
  if (scene.materials.empty()) scene.materials.emplace_back();
  scene.meshes.push_back(std::move(mesh));
  for (const Placement& place : places)
    scene.add_instance(uint32_t(scene.meshes.size() - 1), place, {0});
}

constexpr StrandShape kCurves[] = {StrandShape::kRibbon, StrandShape::kThick,
                                   StrandShape::kThickLinear};

}  // namespace

TEST_CASE("rays meet strands as wide as they are, and find the normals of round ones") {
  for (const StrandShape shape : kCurves) {
    CAPTURE(int(shape));
    Scene scene(1);
    put(scene, strands(shape, upright(0)));
    scene.build(CancelFlag());
    for (const float x : {-0.09f, -0.03f, 0.0f, 0.06f}) {
      Surface s;
      REQUIRE(scene.intersect({x, -5, 2.25f}, {0, 1, 0}, 0, INFINITY, false, s));
      CHECK(s.on_strand());
      CHECK_FALSE(s.back);
      CHECK(s.triangle == 2);
      CHECK(s.u == approx(0.25f).epsilon(0.01));
      const float sine = x / 0.1f, cosine = std::sqrt(1 - sine * sine);
      CHECK(s.ns.x == approx(sine).epsilon(0.02));
      CHECK(s.ns.y == approx(-cosine).epsilon(0.02));
      CHECK(std::abs(s.ns.z) < 0.01f);
      if (shape == StrandShape::kRibbon)
        CHECK(s.distance == approx(5));
      else
        CHECK(s.distance == approx(5 - 0.1f * cosine).epsilon(1e-3));
    }
    Surface s;
    for (const float x : {-0.11f, 0.11f})
      CHECK_FALSE(scene.intersect({x, -5, 2.25f}, {0, 1, 0}, 0, INFINITY, false, s));
    CHECK(scene.occluded({0, -5, 2}, {0, 1, 0}, 0, INFINITY));
    CHECK_FALSE(scene.occluded({0.2f, -5, 2}, {0, 1, 0}, 0, INFINITY));
    CHECK(length(scene.meshes[0].strands->tangent(1, 0.3f, kShutterCentre) - Vec3{0, 0, 1}) <
          1e-5f);
  }
}

TEST_CASE("round strands have far sides, points have none") {
  Scene scene(1);
  put(scene, strands(StrandShape::kThick, upright(0)));
  put(scene, strands(StrandShape::kPoint, {{{4, 0, 2}, 0.5f}}));
  scene.build(CancelFlag());
  Surface s;
  REQUIRE(scene.intersect({0, 0, 2}, {0, 1, 0}, 0, INFINITY, false, s));
  CHECK(s.distance == approx(0.1f));
  CHECK(length(s.ns - Vec3{0, -1, 0}) < 1e-3f);  // towards where the ray comes from
  CHECK_FALSE(scene.intersect({4, 0, 2}, {0, 1, 0}, 0, INFINITY, false, s));
  CHECK_FALSE(scene.occluded({4, 0, 2}, {0, 0, 1}, 0, INFINITY));
  REQUIRE(scene.intersect({4, -3, 2}, {0, 1, 0}, 0, INFINITY, false, s));
  CHECK(s.distance == approx(2.5f));
  CHECK(length(s.ns - Vec3{0, -1, 0}) < 1e-5f);
}

TEST_CASE("a ray does not meet the strand that it left, but others") {
  for (const bool shared : {false, true})
    for (const StrandShape shape : kCurves) {
      std::vector<StrandKey> keys = upright(0), second = upright(1);
      keys.insert(keys.end(), second.begin(), second.end());
      Scene scene(1);
      const Placement far{1, 0, 0, 0, 0, 1, 0, 90, 0, 0, 1, 0};
      put(scene, strands(shape, keys, {0, 5, 10}),
          shared ? std::vector{identity, far} : std::vector{identity});
      scene.build(CancelFlag());
      Surface s, other;
      REQUIRE(scene.intersect({-3, 0.01f, 2.3f}, {1, 0, 0}, 0, INFINITY, false, s));
      CHECK(s.position.x < 0.1f);
      REQUIRE(scene.intersect({-3, 0.01f, 2.3f}, {1, 0, 0}, 0, INFINITY, false, other, kAllRays,
                              kShutterCentre, s.mark));
      CHECK(other.position.x > 0.8f);
      CHECK(other.mark != s.mark);
      CHECK_FALSE(
          scene.occluded({-3, 0.01f, 2.3f}, {1, 0, 0}, 0, 3.5f, kAllRays, kShutterCentre, s.mark));
      const Vec3 start{-3, 0.01f, 2.3f}, way{1, 0, 0};
      Surface together;
      REQUIRE(scene.intersect_packet(&start, &way, 1, &together) == 1);
      CHECK(together.mark == s.mark);
      CHECK(together.distance == s.distance);
      CHECK(length(together.ns - s.ns) < 1e-6f);
    }
}

TEST_CASE("strands stand where their instances put them") {
  // Turned about z, twice as large, moved
  const Placement place{0, -2, 0, 3, 2, 0, 0, 1, 0, 0, 2, -1};
  for (const StrandShape shape : kCurves) {
    Surface found[2];
    for (const bool shared : {false, true}) {
      Scene scene(1);
      const Placement far{1, 0, 0, 0, 0, 1, 0, 900, 0, 0, 1, 0};
      put(scene, strands(shape, upright(0)), shared ? std::vector{place, far} : std::vector{place});
      scene.build(CancelFlag());
      CHECK(scene.instances[0].shared == shared);
      REQUIRE(scene.intersect({3.1f, -4, 2.5f}, {0, 1, 0}, 0, INFINITY, false, found[shared]));
      CHECK(scene.meshes[0].strands->length(0) == approx(4));
      CHECK(scene.meshes[0].strands->length_to(1, 0.5f) == approx(1.5f));
    }
    CHECK(found[0].distance == approx(found[1].distance));
    CHECK(length(found[0].ns - found[1].ns) < 1e-3f);
    CHECK(found[0].ns.x == approx(0.5f).epsilon(0.02));
  }
  // What is stretched unevenly keeps to its own coordinates
  Scene scene(1);
  const Placement stretched{3, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  put(scene, strands(StrandShape::kPoint, {{{0, 0, 0}, 1}}), {stretched});
  scene.build(CancelFlag());
  CHECK(scene.instances[0].shared);
  Surface s;
  REQUIRE(scene.intersect({-9, 0, 0}, {1, 0, 0}, 0, INFINITY, false, s));
  CHECK(s.distance == approx(6));
  REQUIRE(scene.intersect({0, 0, 9}, {0, 0, -1}, 0, INFINITY, false, s));
  CHECK(s.distance == approx(8));
}

TEST_CASE("strands move while the shutter is open") {
  Scene scene(1);
  Mesh mesh = strands(StrandShape::kRibbon, upright(0));
  std::vector<StrandKey> steps;
  for (const float x : {-2.0f, 0.0f, 2.0f})
    for (const StrandKey& key : upright(x)) steps.push_back(key);
  mesh.strands->set_motion(steps, 3);
  put(scene, std::move(mesh));
  scene.build(CancelFlag());
  CHECK(scene.moves());
  CHECK(scene.moves(0));
  Surface s;
  for (const auto& [time, x] :
       {std::pair{0.0f, -2.0f}, {0.25f, -1.0f}, {0.5f, 0.0f}, {1.0f, 2.0f}}) {
    REQUIRE(scene.intersect({x, -5, 2.5f}, {0, 1, 0}, 0, INFINITY, false, s, kAllRays, time));
    CHECK(s.distance == approx(5));
    CHECK_FALSE(scene.occluded({x + 0.2f, -5, 2.5f}, {0, 1, 0}, 0, INFINITY, kAllRays, time));
  }
}

TEST_CASE("strands keep nothing off that photons light") {
  Scene scene(1);
  fill(scene, make_grid(1), {identity});
  Scene both(1);
  both.materials.emplace_back();
  both.meshes.push_back(padded(make_grid(1)));
  both.add_instance(0, identity, {0});
  put(both, strands(StrandShape::kRibbon, upright(0.5f)));
  both.build(CancelFlag());
  CHECK(both.has_strands());
  CHECK_FALSE(scene.has_strands());
  CHECK(scene.keeping_off(0) == ray_bit(RayInfo::kDiffuse));
  CHECK(both.occluded({0.5f, -5, 1.5f}, {0, 1, 0}, 0, INFINITY));
  CHECK_FALSE(both.occluded({0.5f, -5, 1.5f}, {0, 1, 0}, 0, INFINITY, both.keeping_off(0)));
  CHECK(both.occluded({0.3f, 0.3f, 1}, {0, 0, -1}, 0, INFINITY, both.keeping_off(0)));
}

TEST_CASE("strands without extent are no harm") {
  for (const StrandShape shape : kCurves) {
    std::vector<StrandKey> keys = upright(0, 0);
    for (int k = 0; k < 5; ++k) keys.push_back({{1, 0, 2}, 0.2f});  // no length
    for (int k = 0; k < 2; ++k) keys.push_back({{2, 0, 2}, 0});     // nothing at all
    Scene scene(1);
    put(scene, strands(shape, keys, {0, 5, 10, 12}));
    scene.build(CancelFlag());
    for (int i = 0; i < 200; ++i) {
      Surface s;
      const float x = float(i) / 80;
      if (scene.intersect({x, -5, 2}, {0, 1, 0}, 0, INFINITY, false, s)) {
        CHECK(is_finite(s.ns));
        CHECK(length(s.ns) == approx(1));
      }
    }
    CHECK(scene.meshes[0].strands->length(1) == 0);
  }
}

TEST_CASE("strands that cannot be are refused") {
  const std::vector<StrandKey> keys = upright(0);
  const auto make = [](StrandShape shape, std::vector<StrandKey> k, std::vector<uint32_t> first) {
    return Strands(shape, 4, k, std::move(first));
  };
  for (const StrandShape shape : kCurves) {
    CHECK_THROWS_AS(make(shape, keys, {0}), std::invalid_argument);
    CHECK_THROWS_AS(make(shape, keys, {0, 4, 5}), std::invalid_argument);  // one of one key
    CHECK_THROWS_AS(make(shape, keys, {0, 6}), std::invalid_argument);
    CHECK_THROWS_AS(make(shape, keys, {1, 5}), std::invalid_argument);
    CHECK_THROWS_AS(make(shape, {{{NAN, 0, 0}, 1}, {{0, 0, 1}, 1}}, {0, 2}), std::invalid_argument);
    CHECK_THROWS_AS(make(shape, {{{0, 0, 0}, NAN}, {{0, 0, 1}, 1}}, {0, 2}), std::invalid_argument);
    CHECK_THROWS_AS(make(shape, {{{0, 0, 0}, -1}, {{0, 0, 1}, 1}}, {0, 2}), std::invalid_argument);
  }
  CHECK_THROWS_AS(make(StrandShape::kPoint, keys, {0, 5}), std::invalid_argument);
  Strands sound = make(StrandShape::kRibbon, keys, {0, 5});
  CHECK_THROWS_AS(sound.set_motion(keys, 1), std::invalid_argument);
  CHECK_THROWS_AS(sound.set_motion(keys, 3), std::invalid_argument);
}
