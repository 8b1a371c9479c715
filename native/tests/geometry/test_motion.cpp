#include "geometry/motion.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <stdexcept>

#include "math/sampling.h"
#include "support/meshes.h"

using namespace photon_splat;

namespace {

Affine turned(const Vec3& axis, float angle, const Vec3& to = {}) {
  Affine a;
  const Vec3 e[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) {  // Rodrigues' formula
    const Vec3 v = e[i] * std::cos(angle) + cross(axis, e[i]) * std::sin(angle) +
                   axis * (dot(axis, e[i]) * (1 - std::cos(angle)));
    a.m[i] = v.x, a.m[4 + i] = v.y, a.m[8 + i] = v.z;
  }
  a.m[3] = to.x, a.m[7] = to.y, a.m[11] = to.z;
  return a;
}

Affine scaled(const Affine& a, const Vec3& by) {
  Affine out = a;
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i < 3; ++i) out.m[4 * row + i] *= by[i];
  return out;
}

float difference(const Affine& a, const Affine& b) {
  float most = 0;
  for (int i = 0; i < 12; ++i) most = std::max(most, std::abs(a.m[i] - b.m[i]));
  return most;
}

std::array<double, 12> exact(const Affine& a) {
  std::array<double, 12> out;
  std::copy(a.m.begin(), a.m.end(), out.begin());
  return out;
}

uint32_t last(const Scene& scene) { return static_cast<uint32_t>(scene.instances.size() - 1); }

// A scene of one mesh that moves.
void fill_moving(Scene& scene, Mesh mesh, std::vector<Affine> steps) {
  scene.materials.resize(1);
  scene.meshes.push_back(padded(std::move(mesh)));
  scene.add_instance(0, exact(steps[steps.size() / 2]), {0});
  scene.set_motion(last(scene), steps);
  scene.shutter.set({}, -1);
  scene.build(CancelFlag());
}

Affine moved(const Vec3& to) { return turned({0, 0, 1}, 0, to); }

}  // namespace

TEST_CASE("a transform taken apart is put together again") {
  for (uint32_t i = 0; i < 500; ++i) {
    Random random(i, 3);
    Affine a;
    for (float& m : a.m) m = 4 * random.next() - 2;
    if (i % 3 == 0)
      a = scaled(turned(sample_sphere(random.next2()), 6 * random.next()), {-2, 3, 1});
    CHECK(difference(compose(decompose(a)), a) < 2e-5f);
  }
  Affine flat;
  flat.m = {1, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 4};
  CHECK(difference(compose(decompose(flat)), flat) < 1e-6f);
}

TEST_CASE("between steps turns go at constant speed, all else is linear") {
  const Vec3 axis = normalize(Vec3{1, -2, 0.5f});
  for (const float angle : {0.01f, 0.7f, 2.9f, -2.9f}) {
    const TransformMotion motion(std::vector<Affine>{
        turned(axis, 0, {1, 2, 3}), scaled(turned(axis, angle, {3, 2, -1}), {1, 3, 0.5f})});
    for (const float t : {0.0f, 0.25f, 0.5f, 0.9f, 1.0f}) {
      const Affine expected =
          scaled(turned(axis, t * angle, {1 + 2 * t, 2, 3 - 4 * t}), {1, 1 + 2 * t, 1 - 0.5f * t});
      CHECK(difference(motion.at(t), expected) < 3e-5f);
    }
  }
  // Three quarters of a turn in two steps: each is less than a half.
  const TransformMotion long_way(
      std::vector<Affine>{turned(axis, 0), turned(axis, 0.75f * kPi), turned(axis, 1.5f * kPi)});
  for (const float t : {0.1f, 0.5f, 0.6f, 1.0f})
    CHECK(difference(long_way.at(t), turned(axis, t * 1.5f * kPi)) < 3e-5f);
}

TEST_CASE("a step that is flat does not turn the others") {
  const Vec3 axis = normalize(Vec3{0, 1, 1});
  const TransformMotion motion(
      std::vector<Affine>{turned(axis, 1), turned(axis, 1), scaled(turned(axis, 0), {0, 0, 0})});
  CHECK(difference(motion.at(0.75f), scaled(turned(axis, 1), {0.5f, 0.5f, 0.5f})) < 1e-5f);
}

TEST_CASE("times follow the shutter's curve") {
  Shutter shutter;
  CHECK_FALSE(shutter.blurs());
  shutter.set({}, -1);
  CHECK(shutter.blurs());
  for (const float u : {0.0f, 0.3f, 0.9999f}) CHECK(shutter.time(u, 0.2f) == approx(u));
  const float opening[] = {0, 1};
  shutter.set(opening, -1);
  for (const float u : {0.04f, 0.25f, 0.81f})
    CHECK(shutter.time(u, 0) == approx(std::sqrt(u)).epsilon(1e-3));
  const float late[] = {0, 0, 1, 1};  // a share of 1/3 while it opens
  shutter.set(late, -1);
  CHECK(shutter.time(1 / 3.0f, 0) == approx(2 / 3.0f).epsilon(1e-3));
  CHECK(shutter.time(2 / 3.0f, 0) == approx(5 / 6.0f).epsilon(1e-3));
  const float never[] = {0, 0};
  shutter.set(never, -1);
  CHECK(shutter.time(0.4f, 0) == approx(0.4f));
}

TEST_CASE("a rolling shutter exposes the lines from the top on") {
  Shutter shutter;
  shutter.set({}, 0);
  CHECK(shutter.time(0.9f, 0.25f) == approx(0.25f));
  shutter.set({}, 0.2f);
  CHECK(shutter.time(0, 0) == approx(0));
  CHECK(shutter.time(1, 0) == approx(0.2f));
  CHECK(shutter.time(0, 1) == approx(0.8f));
  shutter.set({}, 1);
  CHECK(shutter.time(0.3f, 0.9f) == approx(0.3f));
}

TEST_CASE("rays meet a turning mesh where it is at their time") {
  const Vec3 axis = normalize(Vec3{1, 1, 0.2f});
  std::vector<Affine> steps;
  for (int i = 0; i < 5; ++i)
    steps.push_back(
        scaled(turned(axis, 0.3f * static_cast<float>(i), {0.2f * static_cast<float>(i), 0, 0}),
               {1, -1.5f, 1}));
  Scene scene(1);
  fill_moving(scene, make_sphere(12, 24), steps);
  const TransformMotion motion(steps);
  REQUIRE(scene.moves(0));
  int met = 0;
  for (uint32_t i = 0; i < 400; ++i) {
    Random random(i, 1);
    const float time = random.next();
    const Vec3 towards = sample_sphere(random.next2()) * 0.7f + Vec3{0.4f, 0, 0},
               origin = sample_sphere(random.next2()) * 5.0f, way = normalize(towards - origin);
    Surface s;
    if (!scene.intersect(origin, way, 0, 100, false, s, kAllRays, time)) continue;
    ++met;
    CHECK(scene.occluded(origin, way, 0, 100, kAllRays, time));
    // On the triangle, by its own coordinates
    const Surface at = scene.surface_at(0, s.triangle, s.u, s.v, s.back, time);
    CHECK(length(at.position - s.position) < 2e-5f);
    CHECK(dot(at.ng, s.ng) > 0.99999f);
    const Mesh& mesh = scene.meshes[0];
    const Triangle& t = mesh.triangles[s.triangle];
    const Vec3 local = mesh.positions[t[0]] * (1 - s.u - s.v) + mesh.positions[t[1]] * s.u +
                       mesh.positions[t[2]] * s.v;
    CHECK(length(motion.at(time).point(local) - s.position) < 2e-5f);
    // and at rest where the middle step has it
    const PlaceAtRest rest = scene.at_rest(s, time);
    CHECK(length(steps[2].point(local) - rest.position) < 2e-5f);
    const Surface centre = scene.surface_at(0, s.triangle, s.u, s.v, s.back);
    CHECK(dot(centre.ng, rest.ng) > 0.99999f);
    CHECK(rest.area == approx(1).epsilon(1e-3));
    // What is turned keeps its angle to the normal.
    CHECK(dot(rest.turn(way), rest.ng) == approx(dot(way, s.ng)).epsilon(1e-3));
    // Packets see the same
    Scene::Rays rays{&origin.x, &origin.y, &origin.z, &way.x, &way.y, &way.z};
    alignas(64) float all[7][RayHits::kMost] = {};
    const float own[7] = {origin.x, origin.y, origin.z, way.x, way.y, way.z, time};
    for (int k = 0; k < 7; ++k) all[k][0] = own[k];
    rays = {all[0], all[1], all[2], all[3], all[4], all[5], nullptr, all[6]};
    RayHits hits;
    REQUIRE(scene.intersect(rays, 1, hits) == 1u);
    CHECK(scene.still(hits, 1) == 0);
    const Surface by_packet = scene.surface_of(hits, 0, way, time);
    CHECK(length(by_packet.position - s.position) < 1e-5f);
    CHECK(dot(by_packet.ng, s.ng) > 0.99999f);
  }
  CHECK(met > 200);
}

TEST_CASE("a moving square covers what lies below it as long as it is there") {
  // From x = 0 to x = 4 while the shutter is open: a trapezoid of width 1 at its sides.
  Scene scene(1);
  fill_moving(scene, make_grid(1), {moved({0, 0, 0}), moved({2, 0, 0}), moved({4, 0, 0})});
  for (int i = 0; i < 50; ++i) {
    const float x = 0.1f * static_cast<float>(i) + 0.05f;
    int covered = 0;
    constexpr int kTimes = 2000;
    for (int k = 0; k < kTimes; ++k)
      covered += scene.occluded({x, 0.5f, 1}, {0, 0, -1}, 0, 10, kAllRays,
                                (static_cast<float>(k) + 0.5f) / kTimes);
    const float expected = std::min({x, 1.0f, 5 - x}) / 4;
    CHECK(static_cast<float>(covered) / kTimes == approx(expected).epsilon(0.01));
  }
  CHECK(scene.bounds().lower.x <= 0);
  CHECK(scene.bounds().upper.x >= 5);
}

TEST_CASE("a mesh that changes its shape is met where it is") {
  for (const bool twice : {false, true}) {
    Scene scene(1);
    scene.materials.resize(1);
    Mesh mesh = padded(make_grid(2));
    for (const float height : {1.0f, 0.0f, 3.0f}) {
      mesh.motion.positions.emplace_back();
      if (height == 0) continue;
      for (Vec3 p : mesh.positions) mesh.motion.positions.back().push_back(p + Vec3{0, 0, height});
    }
    scene.meshes.push_back(std::move(mesh));
    Placement place = identity;
    place[11] = 10;
    scene.add_instance(0, place, {0});
    place[3] = 5;
    if (twice) scene.add_instance(0, place, {0});
    scene.build(CancelFlag());
    CHECK(scene.moves(0));
    for (const float time : {0.0f, 0.2f, 0.5f, 0.75f, 1.0f}) {
      const float height = 10 + (time < 0.5f ? 1 - 2 * time : 3 * (2 * time - 1));
      Surface s;
      REQUIRE(scene.intersect({0.3f, 0.4f, 20}, {0, 0, -1}, 0, 100, true, s, kAllRays, time));
      CHECK(s.position.z == approx(height).epsilon(1e-5));
      CHECK(s.ng.z == approx(1));
      const PlaceAtRest rest = scene.at_rest(s, time);
      CHECK(length(rest.position - Vec3{0.3f, 0.4f, 10}) < 1e-5f);
    }
    // Asked without a time it is as in the middle.
    Surface s;
    REQUIRE(scene.intersect({0.3f, 0.4f, 20}, {0, 0, -1}, 0, 100, true, s));
    CHECK(s.position.z == approx(10));
  }
}

TEST_CASE("shadow rays of a coarse mesh start off it where it is at their time") {
  const auto octant = [] {
    Mesh mesh;
    mesh.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}};
    mesh.corner_normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return mesh;
  };
  const Vec3 axis = normalize(Vec3{1, 0, 2});
  const std::vector<Affine> steps{turned(axis, 0), turned(axis, 0.6f, {1, 0, 0}),
                                  turned(axis, 1.2f, {2, 1, 0})};
  const float time = 0.8f;
  Scene moving(1), still(1);
  fill_moving(moving, octant(), steps);
  fill(still, octant(), {exact(TransformMotion(steps).at(time))});
  const float third = 1 / 3.0f;
  const Surface a = moving.surface_at(0, 0, third, third, false, time),
                b = still.surface_at(0, 0, third, third, false);
  const Vec3 along = normalize(Basis(b.ng).tangent + b.ng * 0.02f);
  CHECK(length(a.position - b.position) < 1e-5f);
  CHECK(length(b.position - still.shadow_ray_origin(b, along)) > 0.1f);
  CHECK(length(moving.shadow_ray_origin(a, along, time) - still.shadow_ray_origin(b, along)) <
        1e-5f);
}

TEST_CASE("photons on what grows are as dense as where they have landed") {
  Scene scene(1);
  fill_moving(scene, make_grid(1), {scaled({}, {0.5f, 0.5f, 1}), {}, scaled({}, {3, 2, 1})});
  for (const float time : {0.0f, 1.0f}) {
    Surface s;
    REQUIRE(scene.intersect({0.2f, 0.1f, 2}, {0, 0, -1}, 0, 100, true, s, kAllRays, time));
    CHECK(scene.at_rest(s, time).area == approx(time == 0 ? 4 : 1 / 6.0));
  }
}

TEST_CASE("boxes hold the points that any of them holds") {
  CHECK_FALSE(SweptBoxes({}).hold({}));
  CHECK_FALSE(SweptBoxes({Bounds{}}).hold({}));
  std::vector<Bounds> boxes;
  for (uint32_t i = 0; i < 60; ++i) {
    Random random(i, 5);
    const Vec3 middle{10 * random.next(), 10 * random.next(), 10 * random.next()},
        half{random.next(), random.next(), random.next()};
    boxes.push_back({middle - half, middle + half});
  }
  const SweptBoxes tree(boxes);
  int held = 0;
  for (uint32_t i = 0; i < 2000; ++i) {
    Random random(i, 6);
    const Vec3 x{10 * random.next(), 10 * random.next(), 10 * random.next()};
    const bool expected = std::any_of(boxes.begin(), boxes.end(), [&](const Bounds& b) {
      const Vec3 low = x - b.lower, high = b.upper - x;
      return std::min({low.x, low.y, low.z, high.x, high.y, high.z}) >= 0;
    });
    CHECK(tree.hold(x) == expected);
    held += expected;
  }
  CHECK(held > 50);
}

TEST_CASE("still surfaces take no notice of what moves, but know that it comes by") {
  Scene scene(1);
  scene.materials.resize(1);
  scene.meshes.push_back(padded(make_grid(1)));
  Placement low = identity;
  low[11] = -1;
  scene.add_instance(0, low, {0});
  scene.add_instance(0, identity, {0});
  scene.set_motion(last(scene),
                   std::vector<Affine>{moved({-4, 0, 0}), moved({0, 0, 0}), moved({4, 0, 0})});
  scene.build(CancelFlag());
  const Vec3 above{0.5f, 0.4f, 1}, down{0, 0, -1};
  Surface s;
  REQUIRE(scene.intersect(above, down, 0, 10, false, s));
  CHECK(s.instance == 1);
  REQUIRE(scene.intersect(above, down, 0, 10, false, s, scene.keeping_off(1)));
  CHECK(s.instance == 1);
  REQUIRE(scene.intersect(above, down, 0, 10, false, s, scene.keeping_off(0)));
  CHECK(s.instance == 0);
  CHECK(scene.moves_near({-3, 0.5f, 0}));
  CHECK(scene.moves_near({5, 0.5f, 0.5f}));
  CHECK_FALSE(scene.moves_near({7, 0.5f, 0}));
  CHECK_FALSE(scene.moves_near({0, 0.5f, 2}));
}

TEST_CASE("what does not move asks for no time") {
  Scene scene(1);
  fill(scene, make_grid(1), {identity});
  CHECK_FALSE(scene.moves());
  CHECK_FALSE(scene.moves(0));
  CHECK_THROWS_AS(scene.set_motion(last(scene), std::vector<Affine>(2)), std::invalid_argument);
}
