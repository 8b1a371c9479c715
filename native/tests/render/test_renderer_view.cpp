// What a viewport asks of the renderer: other cameras and other light on the same geometry.
#include "render/renderer.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <cstring>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

constexpr int size = 24;
constexpr size_t budget = size_t{1} << 26;

void light(Renderer& renderer, float strength) {
  LampSettings lamp;
  lamp.to_world = Affine{{1, 0, 0, 0.6f, 0, 1, 0, 0.5f, 0, 0, 1, 0.8f}};
  lamp.strength = {strength, strength, strength};
  lamp.radius = 0.05f;
  renderer.lamps = {lamp};
}

void look_from(Renderer& renderer, float x, int size = ::size) {
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, x, 0, 1, 0, 0.5f, 0, 0, 1, 0.9f}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
}

// A grey cube seen from inside, with a lamp in it.
void fill_box(Renderer& renderer) {
  Material grey;
  grey.front.albedo = grey.back.albedo = {0.5f, 0.5f, 0.5f};
  renderer.scene.materials = {grey};
  renderer.scene.meshes.push_back(padded(make_cube()));
  renderer.scene.add_instance(0, identity, {0});
  light(renderer, 10);
  look_from(renderer, 0.5f);
  renderer.options.photons_per_pass = 20000;
  renderer.build();
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

}  // namespace

TEST_CASE("views of viewport photons trace none, and the same view is the same bit for bit") {
  for (int threads : {1, 3}) {
    Renderer renderer(threads);
    fill_box(renderer);
    renderer.trace_viewport_photons(30000, budget);
    const uint64_t traced = renderer.map().viewport_photons()->counts().traced;
    CHECK(renderer.map().viewport_photons()->paths() == 30000);
    renderer.draw_viewport();
    const Film first = renderer.film().unpacked();
    CHECK(first.passes == 1);
    look_from(renderer, 0.3f);
    renderer.draw_viewport();
    CHECK(!same(renderer.film().unpacked(), first));
    look_from(renderer, 0.5f);
    renderer.draw_viewport();
    CHECK(same(renderer.film().unpacked(), first));
    CHECK(renderer.map().viewport_photons()->counts().traced == traced);
    CHECK(renderer.map().statistics().photons.traced == 0);
  }
}

TEST_CASE("indirect light of viewport photons is that of a render") {
  Renderer renderer(2);
  fill_box(renderer);
  for (uint32_t pass = 0; pass < 4; ++pass) renderer.render_pass(pass);
  const double expected = mean_indirect(renderer.film().unpacked());
  renderer.trace_viewport_photons(60000, budget);
  renderer.trace_viewport_photons(60000, budget);
  renderer.draw_viewport();
  CHECK(mean_indirect(renderer.film().unpacked()) == approx(expected).epsilon(0.02));
}

// Over pixels, of all light.
struct Likeness {
  double ratio, difference;  // of means; mean absolute, over the mean
};

Likeness likeness(const Film& film, const Film& other) {
  double sum = 0, others = 0, difference = 0;
  for (size_t i = 0; i < film.pixels.size(); ++i) {
    const double a = average(film.pixels[i].combined()) * film.pixels[i].share(),
                 b = average(other.pixels[i].combined()) * other.pixels[i].share();
    sum += a;
    others += b;
    difference += std::abs(a - b);
  }
  return {sum / others, difference / others};
}

TEST_CASE("a picture from the cache is that of a render, but for the width of its pixels") {
  Renderer renderer(2);
  fill_box(renderer);
  for (uint32_t pass = 0; pass < 64; ++pass) renderer.render_pass(pass);
  const Film rendered = renderer.film().unpacked();
  renderer.trace_viewport_photons(120000, budget);
  for (int k = 0; k < 20; ++k) renderer.draw_from_cache(1, 0.2f);
  const Likeness cached = likeness(renderer.film().unpacked(), rendered);
  CHECK(cached.ratio == approx(1).epsilon(0.02));
  CHECK(cached.difference < 0.06);
}

// What the film shows, RGBA.
std::vector<float> shown(const Film& film, float factor) {
  std::vector<float> out;
  for (const Pixel& p : film.pixels) {
    const Rgb light = p.combined() * (p.share() * factor);
    out.insert(out.end(), {light.x, light.y, light.z, 1});
  }
  return out;
}

TEST_CASE("a cache that passes have taught shows what they have, and passes go on as before") {
  Renderer renderer(2), other(2);
  for (Renderer* one : {&renderer, &other}) {
    fill_box(*one);
    look_from(*one, 0.5f, 4 * size);
    one->trace_viewport_photons(30000, budget);
    one->draw_from_cache(4, 0);  // the next one samples what is not known alone
    one->camera_settings.exposure = 2;
    one->set_view();
    for (uint32_t pass = 0; pass < 12; ++pass) one->render_pass(pass);
  }
  const Film rendered = renderer.film().unpacked();
  renderer.teach_light_cache(4, 1, shown(rendered, 2).data());
  CHECK(same(renderer.film().unpacked(), rendered));
  for (uint32_t pass = 12; pass < 14; ++pass)
    for (Renderer* one : {&renderer, &other}) one->render_pass(pass);
  CHECK(same(renderer.film().unpacked(), other.film().unpacked()));
  renderer.draw_from_cache(4, 0);
  const Likeness taught = likeness(renderer.film().unpacked(), rendered);
  CHECK(taught.ratio == approx(1).epsilon(0.01));
  CHECK(taught.difference < 0.04);
  CHECK(renderer.cache_counts().samples == 0);
  // What counts is the picture, and all of it.
  renderer.relight();
  renderer.trace_viewport_photons(30000, budget);
  for (uint32_t pass = 0; pass < 8; ++pass) renderer.render_pass(pass);
  renderer.teach_light_cache(4, 1, shown(rendered, 6).data());
  renderer.draw_from_cache(4, 0);
  CHECK(likeness(renderer.film().unpacked(), rendered).ratio == approx(3).epsilon(0.03));
}

TEST_CASE("pictures from the cache sample what they do not know, and little of the rest") {
  Renderer renderer(2);
  fill_box(renderer);
  renderer.trace_viewport_photons(30000, budget);
  const uint64_t traced = renderer.map().viewport_photons()->counts().traced;
  renderer.draw_from_cache(2, 0.1f);
  CHECK(renderer.cache_counts().samples == size * size);
  for (int k = 0; k < 4; ++k) renderer.draw_from_cache(2, 0.1f);
  CHECK(renderer.cache_counts().readings == size * size);
  CHECK(renderer.cache_counts().samples < size * size / 5);
  look_from(renderer, 0.4f);
  renderer.draw_from_cache(2, 0.1f);
  CHECK(renderer.cache_counts().samples < size * size / 2);
  CHECK(renderer.map().viewport_photons()->counts().traced == traced);
  renderer.relight();
  CHECK(renderer.light_cache().empty());
}

TEST_CASE("pictures from the cache are the same bit for bit on any number of threads") {
  std::vector<Film> films;
  for (int threads : {1, 3}) {
    Renderer renderer(threads);
    fill_box(renderer);
    renderer.trace_viewport_photons(30000, budget);
    for (const float x : {0.5f, 0.45f, 0.5f}) {
      look_from(renderer, x);
      renderer.draw_from_cache(2, 0.2f);
    }
    films.push_back(renderer.film().unpacked());
  }
  CHECK(same(films[0], films[1]));
}

TEST_CASE("viewport photons keep to their memory") {
  Renderer renderer(2);
  fill_box(renderer);
  renderer.trace_viewport_photons(1000, 0);  // the first photons are always taken in
  CHECK(renderer.map().viewport_photons()->paths() == 1000);
  renderer.trace_viewport_photons(1000, 0);
  CHECK(renderer.map().viewport_photons()->paths() == 1000);
  CHECK(renderer.map().viewport_photons()->full());
  renderer.draw_viewport();
}

TEST_CASE("another view begins passes anew, and the film is that of a renderer made for it") {
  Renderer moved(2), made(2);
  fill_box(moved);
  moved.render_pass(0);
  look_from(moved, 0.3f);
  moved.camera_settings.width = moved.camera_settings.region_width = 17;
  moved.set_view();
  CHECK(moved.film().sum().passes == 0);
  moved.render_pass(0);
  fill_box(made);
  made.camera_settings = moved.camera_settings;
  made.set_view();
  made.render_pass(0);
  CHECK(same(moved.film().unpacked(), made.film().unpacked()));
}

TEST_CASE("relight takes other lamps on the same geometry") {
  Renderer renderer(2);
  fill_box(renderer);
  renderer.trace_viewport_photons(30000, budget);
  renderer.draw_viewport();
  const double before = mean_indirect(renderer.film().unpacked());
  light(renderer, 20);
  renderer.relight();
  CHECK(!renderer.map().viewport_photons());
  CHECK(renderer.film().sum().passes == 0);
  renderer.trace_viewport_photons(30000, budget);
  renderer.draw_viewport();
  CHECK(mean_indirect(renderer.film().unpacked()) == approx(2 * before).epsilon(1e-4));
}

TEST_CASE("what cancel stopped goes on after resume") {
  Renderer renderer(2);
  fill_box(renderer);
  renderer.trace_viewport_photons(30000, budget);
  renderer.draw_viewport();
  const Film first = renderer.film().unpacked();
  renderer.cancel();
  CHECK_THROWS_AS(renderer.draw_viewport(), Cancelled);
  CHECK_THROWS_AS(renderer.trace_viewport_photons(1000, budget), Cancelled);
  renderer.resume();
  renderer.draw_viewport();
  CHECK(same(renderer.film().unpacked(), first));
}

TEST_CASE("stages out of order are refused") {
  Renderer renderer(1);
  CHECK_THROWS_AS(renderer.set_view(), std::logic_error);
  CHECK_THROWS_AS(renderer.trace_viewport_photons(1, budget), std::logic_error);
  fill_box(renderer);
  CHECK_THROWS_AS(renderer.draw_viewport(), std::logic_error);
  CHECK_THROWS_AS(renderer.draw_from_cache(2, 0.2f), std::logic_error);
}
