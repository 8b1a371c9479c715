#include "lights/mesh_light.h"

#include <doctest/doctest.h>

#include "support/approx.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

// Emits its place in the mesh, (x, y, z), on its front; on its back as well, or nothing.
Program shining(bool on_back) {
  ProgramWriter w;
  const uint32_t place = w.reg(), back = w.reg(1), strength = w.reg(1);
  w.emit(nodes::Op::Geometry, {{"out", place}});
  w.emit(nodes::Op::Backfacing, {{"out", back}});
  w.emit(nodes::Op::Math, {{"a", w.constant({1})},
                           {"b", on_back ? w.constant({0}) : back},
                           {"out", strength},
                           {"operation", word_of(nodes::MathOperation::SUBTRACT)}});
  w.emit(nodes::Op::Emission, {{"weight", strength}, {"color", place}});
  w.emit(nodes::Op::End, {});
  w.program().features = kProgramEmits;
  return w.program();
}

}  // namespace

TEST_CASE("the power of meshes of few and of very many triangles is known, and where it is") {
  // 8; 60,000, asked once each; 500,000, asked once for several
  for (const int side : {2, 173, 500})
    for (const bool on_back : {false, true}) {
      CAPTURE(side);
      CAPTURE(on_back);
      Scene scene(2);
      scene.materials.resize(1);
      scene.materials[0].program = 0;
      scene.programs = {shining(on_back)};
      scene.meshes.push_back(padded(make_grid(side)));
      scene.add_instance(0, identity, {0});
      check_program(scene, scene.programs[0]);
      scene.build(CancelFlag());
      Bounds bounds;
      double power = 0;
      const MeshLight light = make_mesh_light(scene, &scene.pool(), 0, bounds, power);
      REQUIRE(light.triangles.size() == size_t(2 * side * side));
      // The integral of (x + y + z) / 3 over the square; what may be between the probes adds 4 %.
      const double expected = (on_back ? 2.0 : 1.0) / 3.0;
      CHECK(power == approx(expected * 1.04).epsilon(0.03));
      double above = 0, density = 0, fronts = 0;
      for (const EmissiveTriangle& t : light.triangles) {
        const double area = 0.5 / (double(side) * side);
        density += t.pdf * area;
        fronts += t.front_share * t.pdf * area;
        if (t.corner[0].y >= 0.5f) above += t.pdf * area;
      }
      CHECK(density == approx(1).epsilon(1e-4));
      CHECK(above == approx(0.625).epsilon(0.03));  // of (x + y) where y is above a half
      CHECK(fronts == approx(on_back ? 0.5 : 1).epsilon(0.03));
    }
}
