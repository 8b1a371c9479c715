// Surfaces that let light pass and lie in others.
#include <doctest/doctest.h>

#include "scene/scene.h"
#include "support/approx.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

// A pane over [0, 1]^2 at height 0, between others at `heights`: panes of a material of their own
// where `clear`, walls where not.
void fill(Scene& scene, const std::vector<double>& heights, bool clear) {
  for (int i = 0; i < 2; ++i) {
    ProgramWriter pane;
    pane.emit(nodes::Op::Transparent,
              {{"weight", pane.constant({1})}, {"color", pane.constant({0.5f, 0.5f, 0.5f})}});
    pane.emit(nodes::Op::End, {});
    pane.program().features = kProgramTransparent;
    scene.programs.push_back(pane.program());
  }
  scene.materials.resize(3);
  scene.materials[1].program = 0;
  scene.materials[2].program = 1;
  scene.meshes.push_back(padded(make_grid(3)));
  scene.meshes.push_back(padded(make_grid(1)));
  scene.add_instance(0, identity, {1});
  for (const double z : heights)
    scene.add_instance(1, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, z}, {clear ? 2 : 0});
  for (const Program& program : scene.programs) check_program(scene, program);
  scene.build({});
}

// How many surfaces a ray from above meets.
int met(const Scene& scene, const Vec3& origin, const Vec3& direction) {
  Surface s;
  int count = 0;
  for (bool found = scene.intersect(origin, direction, 0, INFINITY, false, s); found && count < 10;
       found = scene.intersect_past(s, origin, direction, INFINITY, false)) {
    ++count;
    if (!scene.may_be_transparent(s)) break;
  }
  return count;
}

}  // namespace

TEST_CASE("a ray that passes a pane meets the wall in which that lies") {
  const Vec3 from{0.31f, 0.43f, 2}, down = normalize(Vec3{0.1f, 0.05f, -1});
  for (const double z : {0.0, 2e-8, -2e-8, -1e-7, -1e-3}) {
    CAPTURE(z);
    Scene scene(1);
    fill(scene, {z, -1}, false);
    Surface s;
    REQUIRE(scene.intersect(from, down, 0, INFINITY, false, s));
    const bool pane_first = scene.may_be_transparent(s);
    CHECK(scene.instances[0].layered == (z > -1e-3));
    CHECK(met(scene, from, down) == (pane_first ? 2 : 1));
    RayInfo ray;
    CHECK(max_abs(scene.transmittance(from, down, 2.0005f / -down.z, ray)) ==
          approx(0.5f * (z < -1e-4)));
    CHECK(max_abs(scene.transmittance(from, down, 2.5f / -down.z, ray)) == 0);
  }
}

TEST_CASE("panes that lie in each other are passed once each") {
  const Vec3 from{0.31f, 0.43f, 2}, down = normalize(Vec3{0.1f, 0.05f, -1});
  for (const double z : {3e-7, -3e-7, -0.5}) {
    CAPTURE(z);
    Scene scene(1);
    fill(scene, {z}, true);
    CHECK((scene.instances[0].layered || scene.instances[1].layered) == (z > -0.5));
    CHECK(met(scene, from, down) == 2);
  }
  Scene alone(1);
  fill(alone, {}, true);
  CHECK(!alone.instances[0].layered);
}
