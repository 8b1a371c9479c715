#include "render/renderer.h"
#include "support/approx.h"

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
      reference ? renderer.trace_reference(pass)
                : renderer.render_pass(pass, {.paths_per_batch = 8192});
    CHECK(renderer.film().sum().passes == 16);
    CHECK(mean_radiance(renderer.film().unpacked()) == approx(2).epsilon(0.02));
    CHECK(renderer.statistics().bad_samples == 0);
  }
}

TEST_CASE("the film is the same bit for bit for any number of threads") {
  Film first;
  for (int threads : {1, 2, 5}) {
    Renderer renderer(threads);
    fill_box(renderer, false);
    CHECK(renderer.statistics().threads == threads);
    for (uint32_t pass = 0; pass < 3; ++pass) renderer.render_pass(pass);
    const Film& film = renderer.film().unpacked();
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
  renderer.render_pass(0);
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    renderer.cancel();
  });
  const auto render_on = [&] {
    for (uint32_t pass = 1; pass < 100000; ++pass) renderer.render_pass(pass);
  };
  CHECK_THROWS_AS(render_on(), Cancelled);
  canceller.join();
  // Of whole passes: that which was cancelled has left nothing in it.
  Renderer whole(3);
  fill_box(whole, false);
  const uint32_t passes = renderer.film().sum().passes;
  for (uint32_t pass = 0; pass < passes; ++pass) whole.render_pass(pass);
  CHECK(mean_radiance(renderer.film().unpacked()) == mean_radiance(whole.film().unpacked()));
}

namespace {

// Splats like the native one as long as it works.
struct Elsewhere : ExternalSplatter {
  Renderer& renderer;
  int batches_until_failure;
  int begun = 0;
  Elsewhere(Renderer& r, int batches) : renderer(r), batches_until_failure(batches) {}
  bool begin_pass() override {
    ++begun;
    return batches_until_failure > 0;
  }
  bool add_photons() override {
    if (--batches_until_failure == 0) return false;
    waiting.insert(waiting.end(), renderer.photons().begin(), renderer.photons().end());
    return true;
  }
  bool finish_pass() override {
    renderer.map().set_photons(std::move(waiting));
    renderer.map().splat();
    waiting = {};
    return true;
  }
  Photons waiting;
};

}  // namespace

TEST_CASE(
    "a splatter elsewhere is handed all photons, and where it fails the native one does them") {
  Renderer native(2);
  native.options.adaptive_samples = false;  // which goes by the work of batches
  fill_box(native, false);
  for (uint32_t pass = 0; pass < 3; ++pass) native.render_pass(pass);
  const double expected = mean_radiance(native.film().unpacked());
  for (int batches : {1000, 3, 1, 0}) {
    Renderer renderer(2);
    renderer.options.adaptive_samples = false;
    fill_box(renderer, false);
    Elsewhere elsewhere(renderer, batches);
    for (uint32_t pass = 0; pass < 3; ++pass) renderer.render_pass(pass, {}, &elsewhere);
    CHECK(elsewhere.begun == 3);
    CHECK(mean_radiance(renderer.film().unpacked()) == approx(expected).epsilon(1e-4));
  }
}

TEST_CASE("a pass that is short of time has fewer photons, and is as bright") {
  Renderer whole(2), cut(2);
  for (Renderer* renderer : {&whole, &cut}) {
    renderer->options.adaptive_indirect = renderer->options.adaptive_samples = false;
    fill_box(*renderer, false);
    renderer->options.photons_per_pass = 1 << 20;
    renderer->build();
  }
  for (uint32_t pass = 0; pass < 4; ++pass) {
    whole.render_pass(pass);
    cut.render_pass(pass, {.seconds = 0, .paths_per_batch = 1 << 16});
  }
  CHECK(cut.map().statistics().photons.traced < whole.map().statistics().photons.traced / 2);
  CHECK(mean_radiance(cut.film().unpacked()) ==
        approx(mean_radiance(whole.film().unpacked())).epsilon(0.02));
}

namespace {

// A floor alone, under a white world: there is no light for photons to bring.
void fill_floor(Renderer& renderer, int side) {
  Scene& scene = renderer.scene;
  scene.materials.resize(1);
  scene.meshes.push_back(padded(make_grid(1)));
  scene.add_instance(0, identity, {0});
  scene.world = {1, 1, 1};
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, 0.5f, 0, 1, 0, 0.5f, 0, 0, 1, 0.4f}};
  camera.width = camera.height = camera.region_width = camera.region_height = side;
  renderer.options.photons_per_pass = 20000;
  renderer.options.adaptive_samples = true;
  renderer.options.indirect_light = IndirectLight::kPhotonsOrPaths;
  renderer.build();
}

}  // namespace

TEST_CASE("a first pass that tries paths says how many samples it has taken") {
  Renderer renderer(2);
  fill_floor(renderer, size);
  CHECK(renderer.next_pass().samples == 1);
  renderer.render_pass(0);
  REQUIRE(renderer.statistics().all_path_traced);
  CHECK(renderer.samples_of_last_pass() == 4);
  const double next = renderer.next_pass().samples;
  renderer.render_pass(1);
  CHECK(renderer.samples_of_last_pass() == next);
}

TEST_CASE("a first pass that tries paths has one sample of each pixel where it is short of time") {
  Renderer whole(2), cut(2);
  for (Renderer* renderer : {&whole, &cut}) fill_floor(*renderer, 5 * size);
  whole.render_pass(0, {.seconds = 3600});
  CHECK(whole.samples_of_last_pass() == 4);
  cut.render_pass(0, {.seconds = 0});
  REQUIRE(cut.statistics().all_path_traced);
  CHECK(cut.samples_of_last_pass() == 1);
  CHECK(cut.statistics().seconds.pilot > 0);  // that of the trial
  CHECK(mean_radiance(cut.film().unpacked()) ==
        approx(mean_radiance(whole.film().unpacked())).epsilon(0.02));
  for (Renderer* renderer : {&whole, &cut})
    for (uint32_t pass = 1; pass < 8; ++pass) renderer->render_pass(pass);
  CHECK(mean_radiance(cut.film().unpacked()) ==
        approx(mean_radiance(whole.film().unpacked())).epsilon(0.005));
}

TEST_CASE("paths gather where few photons arrive, and the picture is as bright") {
  for (const int bounces : {1, 2, 12}) {
    CAPTURE(bounces);
    const auto render = [&](IndirectLight light, uint64_t photons, uint32_t passes) {
      auto renderer = std::make_unique<Renderer>(2);
      renderer->options.indirect_light = light;
      renderer->options.max_bounces = bounces;
      fill_box(*renderer, false);
      renderer->options.photons_per_pass = photons;
      renderer->build();
      for (uint32_t pass = 0; pass < passes; ++pass) renderer->render_pass(pass);
      return renderer;
    };
    const auto many = render(IndirectLight::kAny, 40000, 20),
               few = render(IndirectLight::kAny, 2000, 150),
               told = render(IndirectLight::kPhotonsOrPaths, 2000, 1);
    CHECK_FALSE(many->statistics().gathers_after_all);
    CHECK_FALSE(told->statistics().gathers_after_all);
    CHECK(few->statistics().gathers_after_all);
    CHECK_FALSE(few->statistics().all_path_traced);
    CHECK(mean_radiance(few->film().unpacked()) ==
          approx(mean_radiance(many->film().unpacked())).epsilon(0.01));
  }
}
