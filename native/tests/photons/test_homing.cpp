// Heavy photons far from what is seen are sent there, and bring the light that is due.
#include <doctest/doctest.h>

#include "photons/photon_tracer.h"
#include "photons/seen_places.h"
#include "render/renderer.h"
#include "support/approx.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr float kHalf = 500, kAlbedo = 0.5f, kSun = 4;
const Vec3 kMiddle{0, 0, 0.75f};  // of the plate

Program diffuse() {
  ProgramWriter w;
  w.emit(nodes::Op::Diffuse,
         {{"weight", w.constant({1})}, {"color", w.constant({kAlbedo, kAlbedo, kAlbedo})}});
  w.emit(nodes::Op::End, {});
  return w.program();
}

// A plate of a square metre stands upright over a plane of a square kilometre, under a sun in the
// zenith that it hides nothing of.
void fill(Renderer& renderer, bool by_program) {
  Scene& scene = renderer.scene;
  scene.materials.resize(1);
  scene.materials[0].front.albedo = scene.materials[0].back.albedo = {kAlbedo, kAlbedo, kAlbedo};
  if (by_program) scene.programs = {diffuse()}, scene.materials[0].program = 0;
  scene.meshes.push_back(padded(make_grid(4, 2 * kHalf)));
  scene.meshes.push_back(padded(make_grid(1, 1)));
  scene.add_instance(0, {1, 0, 0, -kHalf, 0, 1, 0, -kHalf, 0, 0, 1, 0}, {0});
  scene.add_instance(1, {0, 0, 1, 0, 1, 0, 0, -0.5, 0, 1, 0, 0.25}, {0});
  LampSettings sun;
  sun.kind = LampKind::kSun;
  sun.strength = {kSun, kSun, kSun};
  renderer.lamps = {sun};
  renderer.camera_settings.width = renderer.camera_settings.height = 8;
  renderer.camera_settings.region_width = renderer.camera_settings.region_height = 8;
  renderer.build();
}

struct OnPlate {
  double power = 0, heaviest = 0;
  std::vector<uint32_t> sides;
};

OnPlate on_plate(const Photons& photons) {
  OnPlate found;
  for (const Photon& p : photons) {
    if (!(p.position.z > 0.1f)) continue;
    found.power += double(p.power.x);
    found.heaviest = std::max(found.heaviest, double(p.power.x));
    if (std::find(found.sides.begin(), found.sides.end(), p.key) == found.sides.end())
      found.sides.push_back(p.key);
  }
  return found;
}

}  // namespace

TEST_CASE("a wall over a sunny plane gets half of what that sends up, by photons of like power") {
  for (const bool by_program : {false, true}) {
    CAPTURE(by_program);
    Renderer renderer(2);
    fill(renderer, by_program);
    Lights lights(renderer.scene, renderer.lamps);
    lights.focus(kMiddle, 0.4f);
    REQUIRE(lights.focused());
    constexpr uint64_t kPilot = 40000, kPaths = 2000000;
    SurfaceFilter all;
    all.add_all();
    CancelFlag cancel;
    PhotonTracer tracer(renderer.scene, lights, 1, PhotonStream::kIndirect);
    const OnPlate before = on_plate(tracer.trace(0, kPaths, double(kPaths), 3, all, cancel));
    REQUIRE(before.sides.size() == 2);

    SurfaceFilter seen;
    SeenPlaces places(kMiddle, 0.4f);
    for (const uint32_t side : before.sides) {
      seen.add(side);
      for (int k = 0; k < 1024; ++k)
        places.add(side, {0, float(k % 32) / 31 - 0.5f, 0.25f + float(k / 32) / 31});
    }
    tracer.learn_emission(kPilot, 4, seen, seen, &places, cancel);
    const OnPlate after = on_plate(tracer.trace(0, kPaths, double(kPaths), 5, seen, cancel));
    // Both sides together: half of the plane is above the horizon of each
    CHECK(after.power == approx(kAlbedo * kSun).epsilon(0.02));
    CHECK(after.heaviest < 0.01 * after.power);
  }
}
