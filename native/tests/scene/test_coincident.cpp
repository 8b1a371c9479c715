#include "scene/coincident.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

Placement at_height(double z) { return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, z}; }

// Looks down on [0, 1]^2 from 2 m above it; few rays meet an edge.
Camera from_above() {
  CameraSettings s;
  s.to_world = Affine{{1, 0, 0, 0.503f, 0, 1, 0, 0.498f, 0, 0, 1, 2}};
  s.left = s.bottom = -0.25f, s.right = s.top = 0.25f;
  s.width = s.height = s.region_width = s.region_height = 32;
  return Camera(s);
}

std::vector<Coincident> found(Mesh mesh, const std::vector<Placement>& places) {
  Scene scene(1);
  fill(scene, std::move(mesh), places);
  return coincident_surfaces(scene, from_above());
}

}  // namespace

TEST_CASE("surfaces that lie exactly in each other are found, neighbours and near ones are not") {
  CHECK(found(make_grid(4), {identity}).empty());
  CHECK(found(make_cube(), {identity}).empty());
  CHECK(found(make_grid(4), {identity, at_height(1e-5)}).empty());

  const std::vector<Coincident> twins = found(make_grid(4), {identity, identity});
  REQUIRE(twins.size() == 1);
  CHECK(twins[0].instance != twins[0].other);
  CHECK(twins[0].share == approx(1).epsilon(0.02));

  Mesh doubled = make_grid(4);
  const std::vector<Triangle> all(doubled.triangles.begin(), doubled.triangles.end());
  for (const Triangle& t : all) doubled.triangles.own().push_back(t);
  const std::vector<Coincident> within = found(std::move(doubled), {identity});
  REQUIRE(within.size() == 1);
  CHECK(within[0].instance == within[0].other);
  CHECK(within[0].share == approx(1).epsilon(0.02));
}

TEST_CASE("coincident surfaces count by a quarter where they only light what is in view") {
  // Two grids that coincide above the camera, beside the floor that it sees
  const std::vector<Coincident> lit = found(make_grid(4), {identity, at_height(3), at_height(3)});
  REQUIRE(lit.size() == 1);
  CHECK(lit[0].share > 0.001f);
  CHECK(lit[0].share < 0.25f);
}
