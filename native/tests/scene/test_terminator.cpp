#include <doctest/doctest.h>

#include <cmath>

#include "scene/scene.h"
#include "support/meshes.h"

using namespace photon_splat;

namespace {

// An octant of the unit sphere as one triangle, with the sphere's normals.
Mesh make_octant() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  mesh.corner_normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return padded(std::move(mesh));
}

constexpr Placement doubled{2, 0, 0, 3, 0, 2, 0, 0, 0, 0, 2, 0};

Vec3 lift(const Scene& scene, uint32_t instance, float u, float v, bool back, const Vec3& light) {
  const Surface s = scene.surface_at(instance, 0, u, v, back);
  return scene.shadow_ray_origin(s, light) - s.position;
}

}  // namespace

TEST_CASE("a grazing shadow ray of a coarse sphere starts near the sphere") {
  const float third = 1 / 3.0f;
  for (const std::vector<Placement>& places : {std::vector{identity}, {identity, doubled}}) {
    Scene scene(1);
    fill(scene, make_octant(), places);
    const Vec3 up = normalize({1, 1, 1}), along = normalize(Vec3{1, -1, 0} + up * 0.02f);
    const uint32_t last = static_cast<uint32_t>(places.size() - 1);
    const float size = last ? 2 : 1;
    // The sphere is 1 - 1 / sqrt(3) beyond the middle; the planes at the vertices meet where the
    // normals' sum is the middle of a cube's corner.
    const float height = dot(lift(scene, last, third, third, false, along), up);
    CHECK(height > size * (1 - 1 / std::sqrt(3.0f)) * 0.5f);
    CHECK(height < size * (std::sqrt(3.0f) - 1 / std::sqrt(3.0f)));
    CHECK(length(lift(scene, last, 0, 0, false, along)) < 1e-6f);
    CHECK(length(lift(scene, last, third, third, false, up)) == 0);
    // Half way to the cut-off
    const Vec3 slanting = normalize(along + up * 0.06f);
    const float less = dot(lift(scene, last, third, third, false, slanting), up);
    CHECK(less > 0);
    CHECK(less < height);
    // Light from within passes where the sphere is hollow: inwards or not at all
    const Vec3 within = normalize(Vec3{1, -1, 0} - up * 0.02f);
    CHECK(dot(lift(scene, last, third, third, true, within), up) <= 0);
  }
}

TEST_CASE("normals on the other side of their triangle move shadow rays to the side that is lit") {
  const float third = 1 / 3.0f;
  const Vec3 up = normalize({1, 1, 1}), below = normalize(Vec3{1, -1, 0} - up * 0.02f);
  for (const std::vector<Placement>& places : {std::vector{identity}, {identity, doubled}}) {
    Mesh turned = make_octant();
    for (Vec3& n : turned.corner_normals.own()) n = -n;
    Scene proper(1), scene(1);
    fill(proper, make_octant(), places);
    fill(scene, std::move(turned), places);
    const uint32_t last = static_cast<uint32_t>(places.size() - 1);
    // As far as the sphere's own
    const Vec3 along = normalize(Vec3{1, -1, 0} + up * 0.02f);
    const float height = dot(lift(proper, last, third, third, false, along), up);
    CHECK(dot(lift(scene, last, third, third, false, below), up) == doctest::Approx(height));
    // And seen from behind, where the normals are those of the hollow, inwards
    CHECK(dot(lift(scene, last, third, third, true, along), up) ==
          doctest::Approx(dot(lift(proper, last, third, third, true, below), up)));
  }
}

TEST_CASE("shadow rays start on the surface itself where it is flat or the object says so") {
  Scene scene(1);
  fill(scene, make_octant(), {identity});
  scene.instances[0].terminator_offset = 0;
  const Vec3 along = normalize({1, -1, 0});
  CHECK(length(lift(scene, 0, 0.3f, 0.3f, false, along)) == 0);
  Scene flat(1);
  fill(flat, make_grid(1), {identity});
  CHECK(length(lift(flat, 0, 0.3f, 0.3f, false, {1, 0, 0})) == 0);
  CHECK_FALSE(flat.bent(flat.surface_at(0, 0, 0.3f, 0.3f, false)));
}

TEST_CASE("normals of vertices do what those of corners do") {
  // Once in the world, mirrored, and once in its own coordinates
  constexpr Placement mirrored{-1, 0, 0, 1, 0, 1, 0, 2, 0, 0, 3, 0};
  for (const std::vector<Placement>& places : {std::vector{mirrored}, {mirrored, doubled}}) {
    Scene by_corner(1), by_vertex(1);
    Mesh mesh = make_octant();
    mesh.corner_normals.own().clear();
    mesh.vertex_normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    fill(by_corner, make_octant(), places);
    fill(by_vertex, std::move(mesh), places);
    const Vec3 along = normalize({1, -1, 0.1f});
    for (uint32_t i = 0; i < places.size(); ++i)
      for (const auto& [u, v] : {std::pair{0.2f, 0.3f}, {0.7f, 0.1f}}) {
        const Surface a = by_corner.surface_at(i, 0, u, v, false),
                      b = by_vertex.surface_at(i, 0, u, v, false);
        CHECK(length(a.ns - a.ng) > 0.1f);
        CHECK(length(a.ns - b.ns) == 0);
        CHECK(length(lift(by_corner, i, u, v, false, along) -
                     lift(by_vertex, i, u, v, false, along)) == 0);
      }
  }
}
