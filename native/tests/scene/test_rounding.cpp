// Rays that leave large triangles which stand askew.
#include <doctest/doctest.h>

#include "scene/scene.h"
#include "support/meshes.h"

using namespace photon_splat;

namespace {

// Share of rays that meet the triangle again which they leave.
double meeting_themselves(float size, bool shared, uint32_t seed) {
  Random random(seed, 1);
  const auto number = [&] { return 2 * random.next() - 1; };
  uint32_t met = 0, all = 0;
  for (int shape = 0; shape < 60; ++shape) {
    Mesh mesh;
    const Vec3 middle = Vec3{number(), number(), number()} * 3.0f;
    for (int i = 0; i < 3; ++i)
      mesh.positions.push_back(middle + Vec3{number(), number(), number()} * size);
    mesh.triangles.own().push_back({0, 1, 2});
    Scene scene(1);
    scene.materials.resize(1);
    scene.meshes.push_back(padded(std::move(mesh)));
    scene.add_instance(0, identity, {0});
    if (shared) scene.add_instance(0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 10.0 * size}, {0});
    scene.build({});
    for (int look = 0; look < 400; ++look) {
      const Vec3 from = middle + Vec3{number(), number(), number()} * 5.0f;
      Vec2 at = random.next2();
      if (at.x + at.y > 1) at = {1 - at.x, 1 - at.y};
      const Surface any = scene.surface_at(0, 0, at.x, at.y, false);
      Vec3 to = any.position;  // all over it, and what is nearest
      if (look & 1)
        to = from - any.ng * dot(from - any.position, any.ng) +
             Vec3{number(), number(), number()} * 3.0f;
      Surface s, again;
      if (!scene.intersect(from, normalize(to - from), 0, INFINITY, false, s)) continue;
      const Vec3 way = Basis(s.ng).to_world(sample_cosine_hemisphere(random.next2()));
      met += scene.intersect(leave(s, way), way, 0, 0.5f * size, false, again) &&
             again.instance == s.instance;
      ++all;
    }
  }
  REQUIRE(all > 5000);
  return double(met) / all;
}

}  // namespace

TEST_CASE("rays that leave a triangle do not meet it, whatever its size") {
  for (const bool shared : {false, true})
    for (const float size : {1.0f, 30.0f, 1000.0f, 30000.0f}) {
      CAPTURE(shared);
      CAPTURE(size);
      CHECK(meeting_themselves(size, shared, 3) == 0);
    }
}

TEST_CASE("rays that leave an instance of a mesh far from its own origin do not meet it again") {
  Random random(3, 1);
  const auto number = [&] { return 2 * random.next() - 1; };
  for (const double far : {10.0, 100.0, 1000.0, 10000.0}) {
    CAPTURE(far);
    uint32_t met = 0;
    for (int turn = 0; turn < 20; ++turn) {
      const Basis basis(normalize(Vec3{number(), number(), number()}));
      Mesh mesh;
      for (const Vec2 corner : {Vec2{-2, -2}, {2, -2}, {2, 2}, {-2, 2}})
        mesh.positions.push_back(Vec3{static_cast<float>(far), 3, -2} +
                                 basis.to_world({corner.x, corner.y, 0}));
      mesh.triangles.own() = {{0, 1, 2}, {0, 2, 3}};
      Scene scene(1);
      scene.materials.resize(1);
      scene.meshes.push_back(padded(std::move(mesh)));
      const double c = std::cos(0.3 * turn), s = std::sin(0.3 * turn);
      for (const double up : {0.0, 50.0})
        scene.add_instance(
            0, {c, -s, 0, -c * far + 3 * s, s, c, 0, -s * far - 3 * c, 0, 0, 1, up + 2}, {0});
      scene.build({});
      for (int look = 0; look < 200; ++look) {
        const Vec3 from = Vec3{number(), number(), number()} * 5.0f,
                   to = Vec3{number(), number(), number()} * 0.5f;
        Surface hit, again;
        if (!scene.intersect(from, normalize(to - from), 0, INFINITY, false, hit)) continue;
        const Vec3 way = Basis(hit.ng).to_world(sample_cosine_hemisphere(random.next2()));
        met += scene.intersect(leave(hit, way), way, 0, 2, false, again);
      }
    }
    CHECK(met == 0);
  }
}

TEST_CASE("faces that an axis stands on have no rounding of their own") {
  CHECK(rounding_of({1000, 0, 0}, {0, 1000, 0}) == 0);
  CHECK(rounding_of({1000, 300, 0}, {-20, 1000, 0}) == 0);
  CHECK(rounding_of({1000, 0, 0}, {0, 700, 700}) > 5e-5f);
  CHECK(rounding_of({}, {}) == 0);
}
