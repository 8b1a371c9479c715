#include "density/occlusion.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "density/bent_occlusion.h"
#include "density/kernel_mass.h"
#include "support/meshes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

// A closed box with its floor at z = 0.
Mesh make_box(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(
        {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// A sheet in the plane x = `x`, standing on z = 0.
Mesh make_sheet(float x) {
  Mesh mesh;
  mesh.positions = {{x, -1, 0}, {x, 2, 0}, {x, 2, 1}, {x, -1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

// Several meshes, each where it is.
void fill_all(Scene& scene, std::vector<Mesh> meshes) {
  scene.materials.resize(1);
  for (Mesh& mesh : meshes) {
    scene.meshes.push_back(padded(std::move(mesh)));
    scene.add_instance(static_cast<uint32_t>(scene.meshes.size() - 1), identity, {0});
  }
  scene.build(CancelFlag());
}
std::vector<Mesh> floor_and(Mesh thing) {
  std::vector<Mesh> meshes;
  meshes.push_back(make_grid(4));
  meshes.push_back(std::move(thing));
  return meshes;
}

// Of the floor at (x, y), seen from above; a mean over turns of the rays.
DiscOcclusion at_floor(Scene& scene, float x, float y, float h, float from = 0.05f) {
  Surface s;
  REQUIRE(scene.intersect({x, y, from}, {0, 0, -1}, 0, 100, true, s));
  REQUIRE(s.position.z == approx(0));
  DiscOcclusion sum{0, 0, h};
  for (uint32_t i = 0; i < 64; ++i) {
    const DiscOcclusion one =
        disc_occlusion(scene, s.instance, s.triangle, s.key, s.position, s.ng, h, i);
    sum.hidden += one.hidden / 64;
    sum.narrow_hidden += one.narrow_hidden / 64;
    sum.clear = std::min(sum.clear, one.clear);
  }
  return sum;
}

// What a straight edge `distance` from the middle cuts off the disc: the mass of the floor up to
// there is the rest.
float mass_beyond(float distance, float h) {
  Scene scene(1);
  Mesh half;
  half.positions = {{-9, -9, 0}, {distance, -9, 0}, {distance, 9, 0}, {-9, 9, 0}};
  half.triangles = {{0, 1, 2}, {0, 2, 3}};
  fill(scene, std::move(half), {identity});
  Surface s;
  REQUIRE(scene.intersect({0, 0, 1}, {0, 0, -1}, 0, 100, true, s));
  return 1 - kernel_mass(scene, s.instance, s.triangle, s.position, s.ng, h).mass;
}

// Of a unit ball about (0, -1, 0), with another one at x = `apart`; from the mean over looks.
float hidden_of_ball(float apart, float h, bool closed) {
  Scene scene(1);
  std::vector<Mesh> balls;
  balls.push_back(make_sphere(48, 96));
  balls.push_back(make_sphere(48, 96));
  if (!closed) balls[1].triangles.own().pop_back();
  for (Vec3& p : balls[1].positions) p.x += apart;
  fill_all(scene, std::move(balls));
  Surface s;
  REQUIRE(scene.intersect({-1e-3f, -5, 0.01f}, {0, 1, 0}, 0, 100, true, s));
  REQUIRE(s.instance == 0);
  float sum = 0;
  for (uint32_t i = 0; i < 1024; ++i)
    sum += over_open_share(scene, s.instance, s.triangle, s.key, s.position, s.ng, h, i).whole;
  return 1 - 1024 / sum;
}

}  // namespace

TEST_CASE("a box on the floor hides what lies under it, and no more") {
  for (const bool sunk : {false, true}) {
    Scene both(1);
    fill_all(both, floor_and(make_box({0.5f, 0.1f, sunk ? -0.2f : 0.0f}, {0.9f, 0.9f, 0.4f})));
    for (float distance : {0.01f, 0.05f, 0.1f}) {
      const DiscOcclusion o = at_floor(both, 0.5f - distance, 0.5f, 0.2f);
      CAPTURE(distance);
      CHECK(o.hidden == approx(mass_beyond(distance, 0.2f)).epsilon(0.08));
      CHECK(o.narrow_hidden == approx(mass_beyond(distance, 0.2f * kNarrow)).epsilon(0.2));
      CHECK(o.clear == 0.2f);
    }
    CHECK(at_floor(both, 0.2f, 0.5f, 0.2f).hidden == 0);
  }
}

TEST_CASE("a sheet on the floor hides nothing, and no disc reaches past it") {
  Scene scene(1);
  fill_all(scene, floor_and(make_sheet(0.5f)));
  const DiscOcclusion near = at_floor(scene, 0.45f, 0.5f, 0.2f);
  CHECK(near.hidden == 0);
  CHECK(near.clear == approx(0.05).epsilon(0.05));
  CHECK(at_floor(scene, 0.25f, 0.5f, 0.2f).clear == 0.2f);
}

TEST_CASE("a disc at the foot of a sheet steps away from it, if there is room") {
  const auto step = [](Scene& scene, float x, float y, float r, Vec3& place) {
    Surface s;
    REQUIRE(scene.intersect({x, y, 0.05f}, {0, 0, -1}, 0, 100, true, s));
    place = s.position;
    DiscOcclusion near = disc_occlusion(scene, s.instance, s.triangle, s.key, place, s.ng, 0.2f, 7);
    REQUIRE(near.clear < r);
    return step_clear_of_walls(scene, s.instance, s.triangle, s.key, place, s.ng, r, 7, near) &&
           near.clear == r;
  };
  Vec3 place;
  Scene one(1);
  fill_all(one, floor_and(make_sheet(0.5f)));
  for (const float side : {-1.0f, 1.0f}) {
    CHECK(step(one, 0.5f + side * 0.01f, 0.5f, 0.05f, place));
    CHECK(side * (place.x - 0.5f) > 0.05f);
    CHECK(length(place - Vec3{0.5f + side * 0.01f, 0.5f, 0}) < 0.1f);
    CHECK(place.z == approx(0));
  }
  Scene corridor(1);
  std::vector<Mesh> meshes = floor_and(make_sheet(0.5f));
  meshes.push_back(padded(make_sheet(0.53f)));
  fill_all(corridor, std::move(meshes));
  CHECK_FALSE(step(corridor, 0.51f, 0.5f, 0.05f, place));
  CHECK(place.x == approx(0.51f));
  Scene rim(1);  // the floor ends at x = 1
  fill_all(rim, floor_and(make_sheet(0.97f)));
  CHECK_FALSE(step(rim, 0.98f, 0.5f, 0.05f, place));
}

TEST_CASE("under an awning next to nothing is hidden: one sees its back, but not all around") {
  Scene scene(1);
  Mesh awning;  // over x < 0.5, from a wall of its own at x = 0.5 down to x = 0.1
  awning.positions = {{0.5f, 0, 0},    {0.5f, 1, 0},    {0.5f, 1, 0.3f},
                      {0.5f, 0, 0.3f}, {0.9f, 0, 0.2f}, {0.9f, 1, 0.2f}};
  awning.triangles = {{0, 2, 1}, {0, 3, 2}, {3, 4, 5}, {3, 5, 2}};
  fill_all(scene, floor_and(std::move(awning)));
  const DiscOcclusion o = at_floor(scene, 0.45f, 0.5f, 0.2f);
  CHECK(o.hidden < 0.1f * mass_beyond(0.05f, 0.2f));
  CHECK(o.clear == approx(0.05).epsilon(0.05));
}

TEST_CASE("where the floor ends at the wall there is nothing beyond") {
  Scene scene(1);
  fill_all(scene, floor_and(make_sheet(1.0f)));
  const DiscOcclusion o = at_floor(scene, 0.95f, 0.5f, 0.2f);
  CHECK(o.hidden == 0);
  CHECK(o.clear == 0.2f);
}

TEST_CASE("a board that hovers close over the floor keeps photons off it") {
  for (const float gap : {0.0f, 0.004f}) {  // lying on it, and just above
    Scene scene(1);
    fill_all(scene, floor_and(make_box({0.5f, -1, gap}, {2, 2, gap + 0.004f})));
    for (float distance : {0.02f, 0.1f}) {
      const DiscOcclusion o = at_floor(scene, 0.5f - distance, 0.5f, 0.2f);
      CAPTURE(gap);
      CAPTURE(distance);
      CHECK(o.hidden == approx(mass_beyond(distance, 0.2f)).epsilon(0.12));
      CHECK(o.narrow_hidden == approx(mass_beyond(distance, 0.2f * kNarrow)).epsilon(0.25));
      CHECK(o.clear == 0.2f);
    }
    CHECK(at_floor(scene, 0.2f, 0.5f, 0.2f).hidden == 0);
  }
}

TEST_CASE("no disc reaches under a wall that hovers close over the floor") {
  Scene scene(1);
  fill_all(scene, floor_and(make_box({0.5f, -1, 0.002f}, {0.7f, 2, 1})));
  CHECK(at_floor(scene, 0.45f, 0.5f, 0.2f).clear == approx(0.05).epsilon(0.05));
  CHECK(at_floor(scene, 0.6f, 0.5f, 0.2f, 0.001f).clear < 0.05f);  // in the gap
  Scene low(1);  // a rug, which rays over the floor meet
  fill_all(low, floor_and(make_box({0.5f, -1, 0}, {0.7f, 2, 0.01f})));
  CHECK(at_floor(low, 0.45f, 0.5f, 0.2f).clear == 0.2f);
}

TEST_CASE("light comes in under a board that hovers higher, and one that shines is no cover") {
  Scene high(1);
  fill_all(high, floor_and(make_box({0.5f, -1, 0.05f}, {2, 2, 0.06f})));
  CHECK(at_floor(high, 0.45f, 0.5f, 0.2f).hidden == 0);
  Scene shining(1);
  shining.materials.resize(1);
  shining.materials[0].front.emission = shining.materials[0].back.emission = {1, 1, 1};
  fill_all(shining, floor_and(make_box({0.5f, -1, 0.001f}, {2, 2, 0.004f})));
  CHECK(at_floor(shining, 0.45f, 0.5f, 0.2f).hidden == 0);
  // The floor below has a light of its own, and no disc reaches into it
  CHECK(at_floor(shining, 0.45f, 0.5f, 0.2f).clear == approx(0.05).epsilon(0.1));
  CHECK(at_floor(shining, 0.25f, 0.5f, 0.2f).clear == 0.2f);
}

TEST_CASE("no disc reaches below a board that hovers so high that much light is thrown in") {
  Scene scene(1);
  fill_all(scene, floor_and(make_box({0.5f, -1, 0.018f}, {2, 2, 0.021f})));
  CHECK(at_floor(scene, 0.47f, 0.5f, 0.2f).clear == approx(0.03).epsilon(0.5));
  CHECK(at_floor(scene, 0.25f, 0.5f, 0.2f).clear == 0.2f);
  Scene dark(1);  // and throws none back
  dark.materials.resize(1);
  dark.materials[0].front.albedo = dark.materials[0].back.albedo = {0, 0, 0};
  fill_all(dark, floor_and(make_box({0.5f, -1, 0.01f}, {2, 2, 0.014f})));
  CHECK(at_floor(dark, 0.47f, 0.5f, 0.2f).clear == 0.2f);
}

TEST_CASE("a sheet under a pane covers the floor, flat or bent, and the pane does not") {
  const float h = 0.2f, distance = 0.2f * h, rim = 0.4f;
  const auto hovering = [&](float z) {
    Mesh mesh;
    mesh.positions = {{rim, -1, z}, {3, -1, z}, {3, 2, z}, {rim, 2, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return padded(std::move(mesh));
  };
  for (const bool bent : {false, true})
    for (const bool sheet : {false, true}) {
      Scene scene(1);
      ProgramWriter clear;
      clear.emit(nodes::Op::Transparent,
                 {{"weight", clear.constant({1})}, {"color", clear.constant({1, 1, 1})}});
      clear.emit(nodes::Op::End, {});
      clear.program().features = kProgramTransparent;
      scene.programs = {clear.program()};
      check_program(scene, scene.programs[0]);
      scene.materials.resize(2);
      scene.materials[1].program = 0;
      Mesh floor = make_grid(16);
      if (bent)
        for (Vec3& p : floor.positions) p.z = -0.01f * (sqr(p.x - 0.5f) + sqr(p.y - 0.5f));
      scene.meshes.push_back(padded(std::move(floor)));
      scene.meshes.push_back(hovering(0.06f * h));
      scene.add_instance(0, identity, {0});
      scene.add_instance(1, identity, {1});
      if (sheet) {
        scene.meshes.push_back(hovering(0.02f * h));
        scene.add_instance(2, identity, {0});
      }
      scene.build(CancelFlag());
      Surface s;
      REQUIRE(scene.intersect({rim - distance, 0.4f, 1}, {0, 0, -1}, 0, 100, true, s));
      REQUIRE(scene.is_planar(s.instance, s.triangle) != bent);
      double hidden = 0, over = 0;
      constexpr uint32_t kTurns = 4096;
      for (uint32_t i = 0; i < kTurns; ++i) {
        hidden +=
            disc_occlusion(scene, s.instance, s.triangle, s.key, s.position, s.ng, h, i).hidden /
            kTurns;
        over +=
            over_open_share(scene, s.instance, s.triangle, s.key, s.position, s.ng, h, i).whole /
            kTurns;
      }
      if (bent) hidden = 1 - 1 / over;
      CAPTURE(bent);
      // Under the rim of what hovers a little light comes in
      CHECK(hidden == approx(sheet ? mass_beyond(distance, h) : 0).epsilon(0.1));
    }
}

TEST_CASE("of balls that run into each other what lies inside is hidden") {
  const float h = 0.3f;
  for (const float apart : {0.1f, 0.2f, 0.4f}) {
    CAPTURE(apart);
    const float expected = mass_beyond(apart / 2, h);
    CHECK(std::abs(hidden_of_ball(apart, h, true) - expected) < 0.06f);
    CHECK(hidden_of_ball(apart, h, true) > 0.6f * expected);
  }
  CHECK(hidden_of_ball(0.7f, h, true) == 0);
  // Light may come into an open one, but hardly to where the two are close to each other
  CHECK(hidden_of_ball(0.4f, h, false) < 0.8f * hidden_of_ball(0.4f, h, true));
  CHECK(hidden_of_ball(0.7f, h, false) == 0);
}

TEST_CASE("what lies on a bent board or hovers over it hides what it covers, fine or coarse") {
  const auto board = [](int n) {
    Mesh mesh = make_grid(n);
    for (Vec3& p : mesh.positions) p.z = -0.01f * (sqr(p.x - 0.5f) + sqr(p.y - 0.5f));
    return mesh;
  };
  const auto hovering = [](float x, float z) {
    Mesh mesh;
    mesh.positions = {{x, -1, z}, {3, -1, z}, {3, 2, z}, {x, 2, z}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  };
  for (const int n : {2, 16})
    for (const bool hovers : {false, true}) {
      const float h = n == 2 ? 0.05f : 0.2f, distance = 0.2f * h, rim = 0.4f;
      Scene scene(1);
      std::vector<Mesh> meshes;
      meshes.push_back(board(n));
      meshes.push_back(hovers ? hovering(rim, 0.02f * h)
                              : make_box({rim, -1, -0.1f}, {3, 2, 0.02f * h}));
      fill_all(scene, std::move(meshes));
      Surface s;
      REQUIRE(scene.intersect({rim - distance, 0.4f, 1}, {0, 0, -1}, 0, 100, true, s));
      REQUIRE(s.instance == 0);
      REQUIRE_FALSE(scene.is_planar(s.instance, s.triangle));
      float sum = 0;
      for (uint32_t i = 0; i < 16384; ++i)
        sum += over_open_share(scene, s.instance, s.triangle, s.key, s.position, s.ng, h, i).whole;
      CAPTURE(n);
      CAPTURE(hovers);
      // Under the rim of what hovers a little light comes in
      CHECK(1 - 16384 / sum == approx(mass_beyond(distance, h)).epsilon(hovers ? 0.08 : 0.03));
    }
}
