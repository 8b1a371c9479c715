#include "render/renderer.h"

#include <doctest/doctest.h>

#include <cstring>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

constexpr int size = 24;

// A camera inside a closed cube whose walls have albedo 1/2 and, if `glowing`, emission 1; else a
// lamp hangs in it.
void fill_box(Renderer& renderer, bool glowing) {
  Material grey;
  grey.front.albedo = grey.back.albedo = {0.5f, 0.5f, 0.5f};
  if (glowing) grey.front.emission = grey.back.emission = {1, 1, 1};
  renderer.scene.materials = {grey};
  renderer.scene.meshes.push_back(padded(make_cube()));
  renderer.scene.add_instance(0, identity, {0});
  if (!glowing) {
    LampSettings lamp;
    lamp.to_world = Affine{{1, 0, 0, 0.6f, 0, 1, 0, 0.5f, 0, 0, 1, 0.8f}};
    lamp.strength = {10, 9, 8};
    lamp.radius = 0.05f;
    renderer.lamps = {lamp};
  }
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.5f, 0, 0, 1, 0.9f}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
  renderer.options.photons_per_pass = 20000;
  renderer.build();
}

void render_pass(Renderer& renderer, uint32_t pass) {
  renderer.trace_camera(pass);
  renderer.make_points(pass);
  const uint64_t photons = renderer.paths_per_pass();
  for (uint64_t first = 0; first < photons; first += 8192) {
    renderer.trace_photons(first, std::min<uint64_t>(8192, photons - first));
    renderer.splat();
  }
  renderer.resolve();
}

double mean_radiance(const Film& film) {
  double sum = 0;
  for (const Pixel& p : film.pixels)
    sum += average(p.diffuse_direct + p.diffuse_indirect + p.emission) * p.share();
  return sum / double(film.pixels.size());
}

}  // namespace

TEST_CASE("a closed box of albedo 1/2 and emission 1 shows 2, by photons and by paths") {
  for (bool reference : {false, true}) {
    Renderer renderer(2);
    fill_box(renderer, true);
    for (uint32_t pass = 0; pass < 16; ++pass)
      reference ? renderer.trace_reference(pass) : render_pass(renderer, pass);
    CHECK(renderer.film().passes == 16);
    CHECK(mean_radiance(renderer.film()) == doctest::Approx(2).epsilon(0.02));
    CHECK(renderer.bad_samples() == 0);
  }
}

TEST_CASE("the film is the same bit for bit for any number of threads") {
  Film first;
  for (int threads : {1, 2, 5}) {
    Renderer renderer(threads);
    fill_box(renderer, false);
    CHECK(renderer.threads() == threads);
    for (uint32_t pass = 0; pass < 3; ++pass) render_pass(renderer, pass);
    const Film& film = renderer.film();
    REQUIRE(film.pixels.size() == size_t(size) * size);
    if (threads == 1) first = film;
    CHECK(std::memcmp(film.pixels.data(), first.pixels.data(),
                      film.pixels.size() * sizeof(Pixel)) == 0);
  }
  CHECK(mean_radiance(first) > 0);
}

TEST_CASE(
    "a render that is cancelled from another thread stops soon, with Cancelled, and keeps its film") {
  Renderer renderer(3);
  fill_box(renderer, false);
  render_pass(renderer, 0);
  const double before = mean_radiance(renderer.film());
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    renderer.cancel();
  });
  const auto render_on = [&] {
    for (uint32_t pass = 1; pass < 100000; ++pass) {
      renderer.trace_camera(pass);
      renderer.make_points(pass);
      renderer.trace_photons(0, 20000);
      renderer.splat();
    }
  };
  CHECK_THROWS_AS(render_on(), Cancelled);
  canceller.join();
  CHECK(mean_radiance(renderer.film()) == before);
}
