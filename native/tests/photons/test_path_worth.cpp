// Photon paths that scatter where they are of no use end there, and the picture stays the same.
#include "photons/path_worth.h"

#include <doctest/doctest.h>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr double kPaths = 1000;

// Stops all over [-1, 1]^3; what goes on at x > 0 brings a photon for each watt.
std::vector<PathWorth::Stop> one_sided(uint32_t count, float power) {
  std::vector<PathWorth::Stop> stops;
  for (uint32_t i = 0; i < count; ++i) {
    const Vec2 p = sobol_2d(i, 0, 1), q = sobol_2d(i, 1, 1);
    const Vec3 x = Vec3{p.x, p.y, q.x} * 2.0f - Vec3{1, 1, 1};
    stops.push_back({x, i, sqr(power), x.x > 0 ? sqr(power) : 0.0f});
  }
  return stops;
}

// A floor of 2 m under a lamp in a world full of fog that swallows nothing.
void fill_fog(Renderer& renderer) {
  Scene& scene = renderer.scene;
  ProgramWriter fog;
  fog.emit(nodes::Op::VolumeScatter, {{"weight", fog.constant({1})},
                                      {"color", fog.constant({1, 1, 1})},
                                      {"density", fog.constant({0.3f})}});
  fog.emit(nodes::Op::End, {});
  scene.programs = {fog.program()};
  scene.world_volume = 0;
  scene.materials.resize(1);
  scene.materials[0].front.albedo = {0.7f, 0.7f, 0.7f};
  scene.meshes.push_back(padded(make_grid(4, 2)));
  scene.add_instance(0, identity, {0});
  check_program(scene, scene.programs[0]);
  LampSettings lamp;
  lamp.to_world = Affine{{1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 2}};
  lamp.strength = {3, 2, 1};
  lamp.radius = 0.1f;
  renderer.lamps = {lamp};
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1}};
  camera.width = camera.height = camera.region_width = camera.region_height = 8;
  renderer.options.photons_per_pass = 60000;
  renderer.build();
}

double light_of(Renderer& renderer, uint32_t passes, bool reference) {
  render_passes(renderer, passes, reference);
  double light = 0;
  for (const Pixel& p : renderer.film().unpacked().pixels)
    light += average(p.combined() * p.share()) / 64;
  return light;
}

}  // namespace

TEST_CASE("paths go on where others have brought something, and end where they have not") {
  PathWorth worth({}, 4);
  worth.learn(one_sided(20000, 0.01f), sqr(0.01), kPaths);
  CHECK(worth.chance({0.7f, 0.5f, 0.5f}, 0.01f, kPaths) == 1);
  CHECK(worth.chance({-0.7f, 0.5f, 0.5f}, 0.01f, kPaths) < 0.15f);
  CHECK(worth.chance({-0.7f, 0.5f, 0.5f}, 0.01f, kPaths) >= 1.0f / 32);
  // Those that carry less end sooner; of a larger set each carries less
  CHECK(worth.chance({0.7f, 0.5f, 0.5f}, 0.002f, kPaths) == approx(0.4).epsilon(0.05));
  CHECK(worth.chance({0.7f, 0.5f, 0.5f}, 0.0002f, 10 * kPaths) ==
        approx(worth.chance({0.7f, 0.5f, 0.5f}, 0.002f, kPaths)));
  // Beyond all that it has seen
  CHECK(worth.chance({1e9f, -1e9f, 0}, 0.01f, kPaths) > 0);
  CHECK(worth.chance({INFINITY, NAN, 0}, 0.01f, kPaths) > 0);
}

TEST_CASE("in endless fog photons do not go astray, and bring what paths find") {
  Renderer photons(2), paths(2);
  photons.options.indirect_light = IndirectLight::kPhotons;
  fill_fog(photons);
  fill_fog(paths);
  const double light = light_of(photons, 200, false);
  CHECK(light == approx(light_of(paths, 4000, true)).epsilon(0.015));
  const PhotonMapStatistics s = photons.statistics().maps[0];
  CHECK(s.photons.stored > 10000);
  // 32 bounces each without it, and 19 rays
  CHECK(s.photons.rays < 6 * (s.photons.traced + s.pilot.traced));
}
