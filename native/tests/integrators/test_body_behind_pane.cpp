// What a body shows through a pane that lets some rays pass and mirrors the others.
#include <doctest/doctest.h>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr int size = 16;

// A closed room [0, 1]^3 whose floor is a body, lit by a lamp, and before the camera a pane that
// only its rays meet, of which a share is a mirror and the rest lets them through.
void fill_room(Renderer& renderer, float mirror) {
  Scene& scene = renderer.scene;
  ProgramWriter body, pane;
  body.emit(nodes::Op::Subsurface, {{"weight", body.constant({1})},
                                    {"color", body.constant({0.9f, 0.8f, 0.7f})},
                                    {"radius", body.constant({1, 1, 1})},
                                    {"scale", body.constant({0.05f})},
                                    {"ior", body.constant({1.4f})}});
  body.emit(nodes::Op::End, {});
  body.program().features = kProgramGathers | kProgramSubsurface;
  pane.emit(nodes::Op::Transparent,
            {{"weight", pane.constant({1 - mirror})}, {"color", pane.constant({1, 1, 1})}});
  pane.emit(nodes::Op::Glossy,
            {{"weight", pane.constant({mirror})}, {"color", pane.constant({1, 1, 1})}});
  pane.emit(nodes::Op::End, {});
  pane.program().features = kProgramTransparent | kProgramRest | kProgramSharp;
  scene.programs = {body.program(), pane.program()};
  scene.materials.resize(3);
  scene.materials[0].front.albedo = scene.materials[0].back.albedo = {0.9f, 0.7f, 0.5f};
  scene.materials[1].program = 0;
  scene.materials[2].program = 1;
  scene.meshes.push_back(padded(make_cube()));
  scene.meshes.push_back(padded(make_grid(1)));
  scene.add_instance(0, identity, {0});
  scene.add_instance(0, {0.96, 0, 0, 0.02, 0, 0.96, 0, 0.02, 0, 0, 0.3, 0.02}, {1});
  scene.add_instance(1, {0.8, 0, 0, 0.1, 0, 0.8, 0, 0.1, 0, 0, 1, 0.6}, {2});
  scene.instances.back().seen_by = ray_bit(RayInfo::kCamera);
  for (const Program& program : scene.programs) check_program(scene, program);
  LampSettings lamp;
  lamp.to_world = Affine{{1, 0, 0, 0.1f, 0, 1, 0, 0.5f, 0, 0, 1, 0.9f}};
  lamp.strength = {3, 2, 1};
  lamp.radius = 0.05f;
  renderer.lamps = {lamp};
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.5f, 0, 0, 1, 0.75f}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
  renderer.options.photons_per_pass = 60000;
  renderer.options.indirect_light = IndirectLight::kFinalGather;
  renderer.build();
}

double light_of(float mirror, uint32_t passes, bool reference) {
  Renderer renderer(2);
  fill_room(renderer, mirror);
  render_passes(renderer, passes, reference);
  double light = 0;
  const Film film = renderer.film().unpacked();
  for (const Pixel& p : film.pixels) light += average(p.combined() * p.share());
  return light / (size * size);
}

}  // namespace

TEST_CASE("half of a mirror and half of what a body shows behind it are what both show together") {
  for (const bool reference : {true, false}) {
    CAPTURE(reference);
    const uint32_t passes = reference ? 100 : 12;
    const double body = light_of(0, passes, reference), room = light_of(1, passes, reference);
    CHECK(light_of(0.5f, 2 * passes, reference) == approx(0.5 * (body + room)).epsilon(0.02));
  }
}
