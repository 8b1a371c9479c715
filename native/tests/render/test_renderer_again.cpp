// Renders of the same scene one after the other by one renderer: begin_again() and photons that are
// kept.
#include <doctest/doctest.h>

#include <cstring>

#include "render/renderer.h"
#include "shading/sees_view.h"
#include "support/approx.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr int size = 24;
constexpr size_t plenty = size_t{1} << 26;
constexpr uint32_t passes = 3;

void look_from(Renderer& renderer, float x, int width = size) {
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, x, 0, 1, 0, 0.5f, 0, 0, 1, 0.9f}};
  camera.width = camera.region_width = width;
  camera.height = camera.region_height = size;
}

void light(Renderer& renderer, float strength) {
  LampSettings lamp;
  lamp.to_world = Affine{{1, 0, 0, 0.6f, 0, 1, 0, 0.5f, 0, 0, 1, 0.8f}};
  lamp.strength = {strength, strength, strength};
  lamp.radius = 0.05f;
  renderer.lamps = {lamp};
}

// A grey cube seen from inside, with a lamp in it.
void fill_box(Renderer& renderer, size_t kept_bytes, float x = 0.5f, int width = size) {
  Material grey;
  grey.front.albedo = grey.back.albedo = {0.5f, 0.5f, 0.5f};
  renderer.scene.materials = {grey};
  renderer.scene.meshes.push_back(padded(make_cube()));
  renderer.scene.add_instance(0, identity, {0});
  light(renderer, 10);
  look_from(renderer, x, width);
  renderer.options.photons_per_pass = 20000;
  renderer.options.kept_photon_bytes = kept_bytes;
  renderer.build();
}

const Film& render(Renderer& renderer) {
  for (uint32_t pass = 0; pass < passes; ++pass)
    renderer.render_pass(pass, {.paths_per_batch = 10000});
  return renderer.film().unpacked();
}

bool same(const Film& a, const Film& b) {
  return a.passes == b.passes && a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(Pixel)) == 0;
}

double mean_indirect(const Film& film) {
  double sum = 0;
  for (const Pixel& p : film.pixels) sum += average(p.diffuse_indirect) * p.share();
  return sum / double(film.pixels.size());
}

uint64_t traced(Renderer& renderer) { return renderer.map().statistics().photons.traced; }

}  // namespace

TEST_CASE("a render of another view is that of a new renderer, bit for bit, and traces no photon") {
  for (size_t bytes : {plenty, size_t{1} << 20, size_t{1}, size_t{0}}) {
    CAPTURE(bytes);
    Renderer moved(2), made(2);
    // Passes have as many photons
    if (!bytes) moved.options.adaptive_samples = made.options.adaptive_samples = false;
    fill_box(moved, bytes);
    render(moved);
    CHECK(traced(moved) == passes * 20000);
    CHECK(moved.map().statistics().reused == 0);
    CHECK(moved.statistics().kept_photon_bytes <= bytes);
    look_from(moved, 0.3f, 17);
    moved.begin_again();
    CHECK(moved.film().sum().passes == 0);
    CHECK(moved.statistics().rays == 0);
    render(moved);
    if (bytes == plenty) {
      CHECK(traced(moved) == 0);
      CHECK(moved.map().statistics().pilot.traced == 0);
      CHECK(moved.map().statistics().reused == moved.map().statistics().used);
      CHECK(moved.map().statistics().reused > 0);
    } else if (bytes < 2) {
      CHECK(traced(moved) == passes * 20000);
      CHECK(moved.map().statistics().reused == 0);
    } else {
      CHECK(traced(moved) > 0);
      CHECK(moved.map().statistics().reused > 0);
      CHECK(moved.statistics().kept_photon_bytes > 0);
    }
    fill_box(made, bytes, 0.3f, 17);
    if (bytes)
      CHECK(same(render(made), moved.film().unpacked()));
    else
      CHECK(mean_indirect(render(made)) ==
            approx(mean_indirect(moved.film().unpacked())).epsilon(0.01));
  }
}

TEST_CASE("a single photon path is left in passes that want fewer") {
  Renderer renderer(2);
  fill_box(renderer, 0);
  renderer.options.photons_per_pass = 1;
  renderer.options.adaptive_indirect = false;  // else one photon is not worth its work
  renderer.build();
  for (uint32_t pass = 0; pass < 9; ++pass) {
    renderer.render_pass(pass);
    CHECK(traced(renderer) == pass + 1);
    renderer.limit_pass({1, 0.01});
  }
}

TEST_CASE("photons that do not fit any more are traced again and are the same ones") {
  Renderer all(2), some(2);
  for (Renderer* renderer : {&all, &some})
    renderer->options.adaptive_radius = renderer->options.adaptive_samples = false;
  fill_box(all, plenty);
  fill_box(some, size_t{1} << 20);
  CHECK(mean_indirect(render(all)) == approx(mean_indirect(render(some))).epsilon(1e-5));
}

TEST_CASE("kept photons give the light of a render that keeps none") {
  Renderer kept(2), plain(2);
  fill_box(kept, plenty);
  fill_box(plain, 0);
  CHECK(mean_indirect(render(kept)) == approx(mean_indirect(render(plain))).epsilon(0.01));
}

TEST_CASE("other lamps have photons of their own") {
  Renderer renderer(2);
  fill_box(renderer, plenty);
  const double before = mean_indirect(render(renderer));
  renderer.begin_again();
  light(renderer, 20);
  renderer.relight();
  CHECK(renderer.statistics().kept_photon_bytes == 0);
  CHECK(mean_indirect(render(renderer)) == approx(2 * before).epsilon(1e-4));
  CHECK(traced(renderer) == passes * 20000);
}

TEST_CASE("programs that ask where the camera is are found, and keep photons from being kept") {
  ProgramWriter plain, window, data;
  const uint32_t color = plain.reg();
  plain.emit(nodes::Op::TextureCoordinate,
             {{"what", word_of(nodes::Coordinates::OBJECT)}, {"out", color}});
  plain.emitting(color);
  window.emit(nodes::Op::TextureCoordinate,
              {{"what", word_of(nodes::Coordinates::WINDOW)}, {"out", window.reg()}});
  window.emitting(0);
  data.emit(nodes::Op::CameraData, {{"view_vector", data.reg()}});
  data.emitting(0);
  CHECK(!sees_view(plain.program()));
  CHECK(sees_view(window.program()));
  CHECK(sees_view(data.program()));

  Renderer renderer(2);
  renderer.scene.programs = {plain.program()};
  fill_box(renderer, plenty);
  render(renderer);
  renderer.begin_again();
  CHECK(renderer.statistics().kept_photon_bytes > 0);
  renderer.scene.programs = {window.program()};
  renderer.begin_again();
  CHECK(renderer.statistics().kept_photon_bytes == 0);
}
