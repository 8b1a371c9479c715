// Light in media: what photon beams bring is what paths leave out.
#include <doctest/doctest.h>

#include <cstring>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr int size = 16;

enum class Fog { kEven, kUneven };

const Program& fog_program(ProgramWriter& w, Fog fog, float density) {
  const uint32_t place = w.reg(), uneven = w.reg(1);
  if (fog == Fog::kUneven) {  // grows with x
    w.emit(nodes::Op::Geometry, {{"out", place}});
    w.emit(nodes::Op::Multiply, {{"out", uneven}, {"a", place}, {"b", w.constant({2 * density})}});
  }
  w.emit(nodes::Op::VolumeScatter,
         {{"weight", w.constant({1})},
          {"color", w.constant({1, 1, 1})},
          {"anisotropy", w.constant({0.4f})},
          {"density", fog == Fog::kUneven ? uneven : w.constant({density})}});
  w.emit(nodes::Op::End, {});
  return w.program();
}

// A closed room [0, 1]^3 full of fog that absorbs nothing, with a glass ball, or a mirror, in it.
// Its walls have albedo 1/2 and emission 1; or they are black, and a lamp hangs there.
struct Room {
  Fog fog = Fog::kEven;
  float roughness = 0, density = 1.5f;
  bool glows = true, mirror = false;
  float lamp_radius = 0.05f;
  bool soft_lamp = false;  // that faces its receivers
  bool screen = false;     // instead of the ball, between the lamp and the camera
};

void fill_room(Renderer& renderer, const Room& room) {
  Scene& scene = renderer.scene;
  ProgramWriter clear, glass, fog;
  clear.emit(nodes::Op::Transparent,
             {{"weight", clear.constant({1})}, {"color", clear.constant({1, 1, 1})}});
  clear.emit(nodes::Op::End, {});
  clear.program().features = kProgramTransparent;
  glass.emit(room.mirror ? nodes::Op::Glossy : nodes::Op::Glass,
             {{"weight", glass.constant({1})},
              {"color", glass.constant({1, 1, 1})},
              {"roughness", glass.constant({room.roughness})},
              {"ior", glass.constant({1.5f})}});
  glass.emit(nodes::Op::End, {});
  glass.program().features = kProgramSharp | kProgramRest;
  scene.programs = {clear.program(), glass.program(), fog_program(fog, room.fog, room.density)};
  scene.materials.resize(3);
  MaterialSide& wall = scene.materials[0].front;
  wall.albedo = room.glows ? Rgb{0.5f, 0.5f, 0.5f} : Rgb{};
  if (room.glows) wall.emission = {1, 1, 1};
  scene.materials[0].back = wall;
  scene.materials[1].program = 1;
  scene.materials[2].program = 0;
  scene.materials[2].volume = 2;
  scene.meshes.push_back(padded(make_cube()));
  scene.meshes.push_back(padded(make_sphere(24, 48)));
  scene.add_instance(0, identity, {0});
  if (room.screen)  // less thick than beams are wide
    scene.add_instance(0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0.004, 0.6}, {0});
  else
    scene.add_instance(1, {0.25, 0, 0, 0.5, 0, 0.25, 0, 0.5, 0, 0, 0.25, 0.4}, {1});
  scene.add_instance(0, {0.98, 0, 0, 0.01, 0, 0.98, 0, 0.01, 0, 0, 0.98, 0.01}, {2});
  for (const Program& program : scene.programs) check_program(scene, program);
  if (!room.glows) {
    LampSettings lamp;
    lamp.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.55f, 0, 0, 1, 0.85f}};
    lamp.strength = {3, 2, 1};
    lamp.radius = room.lamp_radius;
    lamp.soft_falloff = room.soft_lamp;
    renderer.lamps = {lamp};
    if (room.screen) {  // a far stronger one behind it
      lamp.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.55f, 0, 0, 1, 0.3f}};
      lamp.strength = {300, 200, 100};
      renderer.lamps.push_back(lamp);
    }
  }
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.5f, 0, 0, 1, 0.95f}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
  renderer.options.photons_per_pass = 60000;
  renderer.options.max_bounces = 256;  // nothing is absorbed in the fog
  renderer.build();
}

double light_of(Renderer& renderer, uint32_t passes, bool reference = false) {
  render_passes(renderer, passes, reference);
  double mean = 0;
  const Film film = renderer.film().unpacked();
  for (const Pixel& p : film.pixels)
    mean += double(average(p.combined() * p.share())) / double(film.pixels.size());
  CHECK(renderer.statistics().bad_samples == 0);
  return mean;
}

}  // namespace

TEST_CASE("a closed room of albedo 1/2 and emission 1 shows 2 through fog around a glass ball") {
  for (const Fog fog : {Fog::kEven, Fog::kUneven})
    for (const float density : {0.2f, 1.5f, 8.0f}) {
      CAPTURE(density);
      Renderer renderer(2);
      fill_room(renderer, {.fog = fog, .density = density});
      CHECK(light_of(renderer, 8) == approx(2).epsilon(0.01));
      CHECK(renderer.statistics().beams.stored > 1000);
    }
}

TEST_CASE("the same where beams bring all light into media, caustics among it or apart") {
  for (const bool caustics : {false, true})
    for (const float density : {0.2f, 1.5f}) {
      CAPTURE(caustics);
      CAPTURE(density);
      Renderer renderer(2);
      renderer.options.caustics = caustics;
      renderer.options.adaptive_indirect = false;
      renderer.options.indirect_light = IndirectLight::kPhotons;
      fill_room(renderer, {.density = density});
      CHECK(light_of(renderer, 48) == approx(2).epsilon(0.015));
      CHECK(renderer.statistics().beams.stored > 10000);
    }
}

TEST_CASE(
    "beams of indirect light bring what paths find, also of a lamp that faces what it lights") {
  for (const bool soft : {false, true}) {
    CAPTURE(soft);
    const Room room{.density = 1, .glows = false, .lamp_radius = 0.08f, .soft_lamp = soft};
    Renderer beams(2), paths(2);
    beams.options.caustics = paths.options.caustics = false;
    beams.options.adaptive_indirect = false;
    fill_room(beams, room);
    fill_room(paths, room);
    CHECK(light_of(beams, 48) == approx(light_of(paths, 1500, true)).epsilon(0.02));
    CHECK(beams.statistics().beams.stored > 10000);
  }
}

TEST_CASE("no light gets through a screen in the fog that is thinner than beams are wide") {
  const Room room{.density = 1, .glows = false, .screen = true};
  Renderer lit(2), dark(2);
  lit.options.caustics = dark.options.caustics = false;
  lit.options.adaptive_indirect = dark.options.adaptive_indirect = false;
  fill_room(lit, room);
  fill_room(dark, room);
  dark.lamps.resize(1);
  dark.relight();
  CHECK(light_of(lit, 64) == approx(light_of(dark, 64)).epsilon(0.02));
  CHECK(lit.statistics().beams.stored > 10000);
}

TEST_CASE("lobes that are sharp in part leave the rest of the light in media to paths") {
  Renderer beams(2), paths(2);
  const Room room{.roughness = 0.3f};  // such glass keeps some of the light
  fill_room(beams, room);
  fill_room(paths, room);
  CHECK(light_of(beams, 16) == approx(light_of(paths, 300, true)).epsilon(0.01));
}

TEST_CASE("beams bring what paths find by chance of a lamp behind glass and mirrors") {
  for (const bool mirror : {false, true}) {
    CAPTURE(mirror);
    const Fog fog = mirror ? Fog::kEven : Fog::kUneven;
    const Room room{.fog = fog, .density = 0.8f, .glows = false, .mirror = mirror};
    Renderer beams(2), paths(2);
    fill_room(beams, room);
    fill_room(paths, room);
    const double reference = light_of(paths, 1500, true);
    CHECK(light_of(beams, 48) == approx(reference).epsilon(0.02));
  }
}

TEST_CASE("beams are the same bit for bit for any number of threads") {
  std::vector<Film> films;
  for (const Fog fog : {Fog::kEven, Fog::kUneven})
    for (const int threads : {1, 3}) {
      Renderer renderer(threads);
      renderer.options.adaptive_indirect = fog == Fog::kUneven;
      fill_room(renderer, {.fog = fog, .density = 1, .glows = false});
      light_of(renderer, 3);
      films.push_back(renderer.film().unpacked());
    }
  for (const size_t i : {0, 2})
    CHECK(std::memcmp(films[i].pixels.data(), films[i + 1].pixels.data(),
                      films[i].pixels.size() * sizeof(Pixel)) == 0);
}

TEST_CASE("all of the light is in its light group, that of beams too") {
  Renderer renderer(2);
  renderer.scene.light_groups = 1;
  fill_room(renderer, {.glows = false});
  renderer.lamps[0].light_group = 0;
  renderer.relight();
  light_of(renderer, 4);
  const Film film = renderer.film().unpacked();
  for (size_t i = 0; i < film.pixels.size(); ++i)
    CHECK(average(film.by_group[i]) ==
          approx(double(average(film.pixels[i].combined()))).epsilon(1e-4));
  CHECK(renderer.statistics().beams.stored > 1000);
}

TEST_CASE("where media scatter nothing there are no beams") {
  Renderer clear(1);
  fill_room(clear, {.density = 0});
  light_of(clear, 1);
  CHECK(clear.statistics().beams.traced == 0);
}
