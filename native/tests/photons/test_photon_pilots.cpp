// Pilots that teach where useful photons start are photons like all others.
#include <doctest/doctest.h>

#include "density/surface_filter.h"
#include "photons/photon_tracer.h"
#include "render/renderer.h"
#include "support/approx.h"
#include "support/meshes.h"
#include "support/passes.h"

using namespace photon_splat;

namespace {

// A floor of 20 m under a lamp, and two small plates above it, at x = 2 and 18.
void fill(Renderer& renderer) {
  Scene& scene = renderer.scene;
  scene.materials.resize(1);
  scene.materials[0].front.albedo = scene.materials[0].back.albedo = {0.7f, 0.7f, 0.7f};
  scene.meshes.push_back(padded(make_grid(4, 20)));
  scene.meshes.push_back(padded(make_grid(1, 1)));
  scene.add_instance(0, identity, {0});
  scene.add_instance(1, {1, 0, 0, 1.5, 0, 1, 0, 9.5, 0, 0, 1, 0.5}, {0});
  scene.add_instance(1, {1, 0, 0, 17.5, 0, 1, 0, 9.5, 0, 0, 1, 0.5}, {0});
  LampSettings lamp;
  lamp.to_world = Affine{{1, 0, 0, 10, 0, 1, 0, 10, 0, 0, 1, 3}};
  lamp.strength = {30, 30, 30};
  lamp.radius = 0.1f;
  renderer.lamps = {lamp};
  renderer.camera_settings.width = renderer.camera_settings.height = 8;
  renderer.camera_settings.region_width = renderer.camera_settings.region_height = 8;
  renderer.build();
}

struct OnPlates {
  double power[2] = {0, 0};
  uint32_t keys[2] = {0, 0};
  int count[2] = {0, 0};
};

OnPlates on_plates(const Photons& photons) {
  OnPlates found;
  for (const Photon& p : photons) {
    if (!(p.position.z > 0.25f)) continue;
    const int plate = p.position.x > 10;
    found.power[plate] += average(p.power);
    found.keys[plate] = p.key;
    ++found.count[plate];
  }
  return found;
}

}  // namespace

TEST_CASE(
    "guided photons and pilots bring what others do, and one pilot more finds what is seen by now") {
  Renderer renderer(2);
  fill(renderer);
  constexpr uint64_t kPaths = 1000000, kMany = 8000000;
  constexpr uint32_t kSeed = 5;
  SurfaceFilter all;
  all.add_all();
  CancelFlag cancel;
  const Lights lights(renderer.scene, renderer.lamps);
  PhotonTracer unguided(renderer.scene, lights, 4, PhotonStream::kIndirect);
  const OnPlates expected =
      on_plates(unguided.trace(0, kMany, double(kMany), kSeed + 1, all, cancel));

  PhotonTracer tracer(renderer.scene, lights, 4, PhotonStream::kIndirect);
  SurfaceFilter seen;
  seen.add(expected.keys[0]);
  const Photons* pilot = tracer.learn_emission(kPaths, kSeed, seen, all, nullptr, cancel);
  REQUIRE(tracer.guided());
  CHECK(!pilot);
  // To three deviations of the 2,400 unguided photons
  const OnPlates first = on_plates(tracer.trace(0, kPaths, double(kPaths), kSeed + 3, all, cancel));
  CHECK(first.power[0] == approx(expected.power[0]).epsilon(0.06));
  // Aimed at one plate
  CHECK(first.count[0] > 2 * first.count[1]);

  seen.add(expected.keys[1]);
  pilot = tracer.learn_more_emission(kPaths, kSeed, seen, all, nullptr, cancel);
  REQUIRE(pilot);
  CHECK(on_plates(*pilot).power[0] == approx(expected.power[0]).epsilon(0.06));
  const OnPlates later = on_plates(tracer.trace(0, kPaths, double(kPaths), kSeed + 2, all, cancel));
  CHECK(later.power[0] == approx(expected.power[0]).epsilon(0.06));
  CHECK(later.power[1] == approx(expected.power[1]).epsilon(0.1));
  CHECK(later.count[1] > 1.2 * first.count[1]);
  CHECK(later.count[0] > 0.5 * first.count[0]);
}
