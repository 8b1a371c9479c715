// What is seen through a medium that is the same everywhere has no noise of its own.
#include <doctest/doctest.h>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr float kDensity = 0.3f;
constexpr int size = 4;

Program fog() {
  ProgramWriter w;
  w.emit(nodes::Op::VolumeScatter, {{"weight", w.constant({1})},
                                    {"color", w.constant({1, 0.5f, 1})},
                                    {"density", w.constant({kDensity})}});
  w.emit(nodes::Op::End, {});
  return w.program();
}

void look_down(Renderer& renderer, float from) {
  for (const Program& program : renderer.scene.programs) check_program(renderer.scene, program);
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.5f, 0, 0, 1, from}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
  camera.orthographic = true;
  camera.left = camera.bottom = -0.2f;
  camera.right = camera.top = 0.2f;
  renderer.options.photons_per_pass = 1000;
  renderer.build();
  render_passes(renderer, 1, false);
}

}  // namespace

TEST_CASE("every sample shows what shines in fog, as much as that lets through") {
  Renderer renderer(1);
  Scene& scene = renderer.scene;
  scene.programs = {fog()};
  scene.world_volume = 0;
  scene.materials.resize(1);
  scene.materials[0].front.emission = {1, 1, 1};
  scene.meshes.push_back(padded(make_grid(1)));
  scene.add_instance(0, identity, {0});
  look_down(renderer, 2);
  for (const Pixel& p : renderer.film().unpacked().pixels) {
    CHECK(p.emission.x * p.share() == approx(std::exp(-2 * kDensity)).epsilon(1e-4));
    CHECK(p.emission.y * p.share() == approx(std::exp(-kDensity)).epsilon(1e-4));
    CHECK(p.alpha * p.share() == 1);
    // As seldom as a path gets there that takes the channels as they scatter, as in Cycles
    CHECK(p.normal.z * p.share() ==
          approx((4 * std::exp(-2 * kDensity) + std::exp(-kDensity)) / 5).epsilon(1e-4));
  }
}

TEST_CASE("before a transparent film fog is as opaque as it is") {
  Renderer renderer(1);
  Scene& scene = renderer.scene;
  ProgramWriter clear;
  clear.emit(nodes::Op::Transparent,
             {{"weight", clear.constant({1})}, {"color", clear.constant({1, 1, 1})}});
  clear.emit(nodes::Op::End, {});
  clear.program().features = kProgramTransparent;
  scene.programs = {fog(), clear.program()};
  scene.materials.resize(1);
  scene.materials[0].program = 1;
  scene.materials[0].volume = 0;
  scene.meshes.push_back(padded(make_cube()));
  scene.add_instance(0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0}, {0});
  renderer.camera_settings.transparent = true;
  look_down(renderer, 5);
  const double through = (2 * std::exp(-3 * kDensity) + std::exp(-1.5 * kDensity)) / 3;
  for (const Pixel& p : renderer.film().unpacked().pixels)
    CHECK(p.alpha * p.share() == approx(1 - through).epsilon(1e-4));
}
