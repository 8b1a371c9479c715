// Photons that media scatter light surfaces as paths would: the picture is the path tracer's.
#include <doctest/doctest.h>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr int size = 16;

struct Room {
  bool even = true;          // else the fog grows with x
  RayMask block = kAllRays;  // rays that see the block
  RayMask fog = kAllRays;    // and those that see the fog in the middle
  bool soft_lamp = true, everywhere = false;
};

const Program& fog_program(ProgramWriter& w, const Room& room) {
  const uint32_t place = w.reg(), uneven = w.reg(1);
  if (!room.even) {
    w.emit(nodes::Op::Geometry, {{"out", place}});
    w.emit(nodes::Op::Multiply, {{"out", uneven}, {"a", place}, {"b", w.constant({2})}});
  }
  w.emit(nodes::Op::VolumeScatter, {{"weight", w.constant({1})},
                                    {"color", w.constant({0.95f, 0.9f, 0.8f})},
                                    {"anisotropy", w.constant({0.4f})},
                                    {"density", room.even ? w.constant({1}) : uneven}});
  w.emit(nodes::Op::End, {});
  return w.program();
}

// A closed room [0, 1]^3 of albedo .7 with a block in it and a lamp, all of it, or its middle, full
// of fog.
void fill_room(Renderer& renderer, const Room& room) {
  Scene& scene = renderer.scene;
  ProgramWriter clear, fog;
  clear.emit(nodes::Op::Transparent,
             {{"weight", clear.constant({1})}, {"color", clear.constant({1, 1, 1})}});
  clear.emit(nodes::Op::End, {});
  clear.program().features = kProgramTransparent;
  scene.programs = {clear.program(), fog_program(fog, room)};
  scene.materials.resize(3);
  scene.materials[0].front.albedo = scene.materials[0].back.albedo = {0.7f, 0.7f, 0.7f};
  scene.materials[1].front.albedo = scene.materials[1].back.albedo = {0.6f, 0.2f, 0.1f};
  scene.materials[2].program = 0;
  scene.materials[2].volume = 1;
  scene.meshes.push_back(padded(make_cube()));
  scene.add_instance(0, identity, {0});
  scene.add_instance(0, {0.3, 0, 0, 0.55, 0, 0.3, 0, 0.55, 0, 0, 0.4, 0}, {1});
  scene.instances.back().seen_by = room.block;
  if (room.everywhere) {
    scene.world_volume = 1;
  } else {
    scene.add_instance(0, {0.9, 0, 0, 0.02, 0, 0.9, 0, 0.02, 0, 0, 0.7, 0.1}, {2});
    scene.instances.back().seen_by = room.fog;
  }
  for (const Program& program : scene.programs) check_program(scene, program);
  LampSettings lamp;
  lamp.to_world = Affine{{1, 0, 0, 0.35f, 0, 1, 0, 0.4f, 0, 0, 1, 0.75f}};
  lamp.strength = {3, 2, 1};
  lamp.radius = 0.05f;
  lamp.soft_falloff = room.soft_lamp;
  renderer.lamps = {lamp};
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.5f, 0, 0, 1, 0.95f}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
  renderer.options.photons_per_pass = 60000;
  renderer.build();
}

// Mean light of the quarters of the picture.
std::array<double, 4> light_of(Renderer& renderer, uint32_t passes, bool reference = false) {
  render_passes(renderer, passes, reference);
  std::array<double, 4> light{};
  const Film film = renderer.film().unpacked();
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Pixel& p = film.pixels[static_cast<size_t>(y) * size + x];
      light[2 * (y / (size / 2)) + x / (size / 2)] += average(p.combined() * p.share());
    }
  for (double& quarter : light) quarter *= 4.0 / (size * size);
  CHECK(renderer.statistics().bad_samples == 0);
  return light;
}

void compare(const Room& room, IndirectLight indirect) {
  Renderer photons(2), paths(2);
  photons.options.indirect_light = indirect;
  fill_room(photons, room);
  fill_room(paths, room);
  const auto reference = light_of(paths, 800, true), light = light_of(photons, 160);
  for (int quarter = 0; quarter < 4; ++quarter)
    CHECK(light[quarter] == approx(reference[quarter]).epsilon(0.02));
  const RenderStatistics s = photons.statistics();
  CHECK_FALSE(s.all_path_traced);
  CHECK(s.maps[0].photons.stored > 50000);
}

}  // namespace

TEST_CASE("photons bring what media scatter onto surfaces") {
  compare({}, IndirectLight::kPhotons);
  compare({.even = false}, IndirectLight::kFinalGather);
}

TEST_CASE("the same of a lamp without soft falloff, in a world full of fog") {
  compare({.soft_lamp = false, .everywhere = true}, IndirectLight::kPhotons);
}

TEST_CASE("the same where rays that media scatter see other things") {
  for (const RayInfo::Kind unseen : {RayInfo::kVolume, RayInfo::kDiffuse}) {
    CAPTURE(static_cast<int>(unseen));
    compare({.block = static_cast<RayMask>(kAllRays & ~ray_bit(unseen))}, IndirectLight::kPhotons);
  }
}

TEST_CASE("what fog scatters is no light on surfaces whose rays do not see the fog") {
  compare({.block = 0, .fog = static_cast<RayMask>(kAllRays & ~ray_bit(RayInfo::kDiffuse))},
          IndirectLight::kPhotons);
}
