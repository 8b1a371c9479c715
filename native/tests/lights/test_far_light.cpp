// Suns and worlds behind a medium that fills the world.
#include <doctest/doctest.h>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

// A floor and a wall under a sun and a sky, in a medium of that extinction everywhere.
void fill_court(Renderer& renderer, std::optional<float> density) {
  Scene& scene = renderer.scene;
  if (density) {
    ProgramWriter w;
    w.emit(nodes::Op::VolumeAbsorption, {{"weight", w.constant({1})},
                                         {"color", w.constant({0, 0, 0})},
                                         {"density", w.constant({*density})}});
    w.emit(nodes::Op::End, {});
    scene.programs = {w.program()};
    check_program(scene, scene.programs[0]);
    scene.world_volume = 0;
  }
  scene.world = {0.2f, 0.3f, 0.4f};
  scene.materials.resize(1);
  scene.materials[0].front.albedo = scene.materials[0].back.albedo = {0.7f, 0.7f, 0.7f};
  scene.meshes.push_back(padded(make_grid(2)));
  scene.add_instance(0, identity, {0});
  scene.add_instance(0, {0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0}, {0});
  LampSettings sun;
  sun.kind = LampKind::kSun;
  sun.to_world = Affine{{0.6f, 0, 0.8f, 0, 0, 1, 0, 0, -0.8f, 0, 0.6f, 5}};
  sun.strength = {3, 3, 3};
  renderer.lamps = {sun};
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 0.3f, 0, 1, 0, 0.5f, 0, 0, 1, 0.9f}};
  camera.width = camera.height = camera.region_width = camera.region_height = 8;
  renderer.options.photons_per_pass = 20000;
  renderer.options.indirect_light = IndirectLight::kPhotons;
  renderer.build();
}

Rgb indirect_of(Renderer& renderer) {
  render_passes(renderer, 40, false);
  Rgb sum{};
  for (const Pixel& p : renderer.film().unpacked().pixels)
    sum += p.diffuse_indirect * (p.share() / 64);
  return sum;
}

}  // namespace

TEST_CASE("nobody looks for suns and skies whose light a medium stops on its way") {
  Renderer open(1), fog(1);
  fill_court(open, {});
  fill_court(fog, 0.01f);
  CHECK(Lights(open.scene, open.lamps).total_power() > 0);
  const Lights hidden(fog.scene, fog.lamps);
  CHECK(hidden.total_power() == 0);
  CHECK(hidden.environment().black());
  CHECK(is_black(indirect_of(fog)));
}

TEST_CASE("a medium that fills the world with nothing lets their photons through") {
  Renderer open(1), empty(1);
  fill_court(open, {});
  fill_court(empty, 0.0f);
  const Rgb without = indirect_of(open), with = indirect_of(empty);
  CHECK(without.x > 0.01f);
  CHECK(with.x == approx(without.x).epsilon(0.02));
  CHECK(with.z == approx(without.z).epsilon(0.02));
}
