#include "lights/environment.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "lights/emission/photon_emitter.h"
#include "support/meshes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

// An uneven image: a gradient, a bright spot of a few texels, black below.
void add_map(Scene& scene, int width = 96) {
  Texture t;
  t.width = width;
  t.height = width / 2;
  for (int y = 0; y < t.height; ++y)
    for (int x = 0; x < t.width; ++x) {
      const float up = static_cast<float>(y) / static_cast<float>(t.height);
      const bool spot = x / 2 == width / 8 && y / 2 == t.height * 3 / 8;
      const float level = spot ? 300.0f : up < 0.4f ? 0.0f : up;
      t.floats.insert(t.floats.end(), {level, 0.5f * level, 0.2f, 1});
    }
  scene.textures.push_back(t);
  scene.world_map.texture = 0;
  scene.world = {1, 1, 1};
}

void add_sun(Scene& scene, float elevation, float half_angle) {
  SunDisc sun;
  sun.direction = {std::cos(elevation), 0, std::sin(elevation)};
  sun.half_angle = half_angle;
  sun.bottom = {100, 40, 10};
  sun.top = {200, 150, 100};
  sun.horizon = 0;
  scene.sun_discs.push_back(sun);
}

// By brute force, from directions uniform over the sphere.
template <class F>
double over_sphere(F&& f, uint32_t count = 1 << 20) {
  double sum = 0;
  for (uint32_t i = 0; i < count; ++i) sum += f(sample_sphere(sobol_2d(i, 3, 1)));
  return sum / count * 4 * double(kPi);
}

template <class F>
double by_sampling(const Environment& world, F&& f, uint32_t count = 1 << 18) {
  double sum = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const auto s = world.sample(sobol_2d(i, 5, 2));
    REQUIRE(s.pdf > 0);
    REQUIRE(length(s.direction) == approx(1).epsilon(1e-4));
    sum += f(s.direction) / s.pdf;
  }
  return sum / count;
}

}  // namespace

TEST_CASE("a world that asks by what ray it is seen has its photons and samples for all of them") {
  using enum nodes::PathValue;
  const auto asking = [](Scene& scene, nodes::PathValue what) {
    ProgramWriter w;
    const uint32_t r = w.reg(1), color = w.reg();
    w.emit(nodes::Op::LightPath, {{"out", r}, {"what", word_of(what)}});
    w.emit(nodes::Op::Spread, {{"out", color}, {"value", r}});
    scene.programs.push_back(w.emitting(color));
    look_at_program(scene.programs[0]);
    scene.world_program = 0;
  };
  const Vec3 up{0, 0, 1};
  Scene by_camera(1), by_gloss(1), by_depth(1);
  asking(by_camera, IS_CAMERA_RAY);
  const Environment backdrop(by_camera);
  CHECK(backdrop.asks_camera());
  CHECK_FALSE(backdrop.asks_ray());
  CHECK(backdrop.radiance(up, RayInfo{}).x == 1);
  CHECK(backdrop.black());  // to all others
  asking(by_gloss, IS_GLOSSY_RAY);
  const Environment shine(by_gloss);
  CHECK(shine.asks_ray());
  CHECK(shine.radiance(up).x == 1);
  CHECK(shine.radiance(up, RayInfo{}).x == 0);
  CHECK(shine.share(up, Environment::photon_ray(true, false, false)).x == 0);
  CHECK(shine.share(up, Environment::photon_ray(false, false, true)).x == 1);
  CHECK(shine.share(up, Environment::photon_ray(false, true, false)).x == 1);
  asking(by_depth, RAY_DEPTH);
  const Environment deep(by_depth);
  CHECK(deep.asks_depth());
  CHECK_FALSE(shine.asks_depth());
  CHECK(deep.radiance(up, RayInfo{}).x == 1);
  CHECK(deep.radiance(up, RayInfo{}.scattered(true, false, false)).x == 2);
}

TEST_CASE("the density of directions integrates to one and is that of the samples") {
  for (int variant = 0; variant < 4; ++variant) {
    CAPTURE(variant);
    Scene scene(1);
    if (variant != 0)
      add_map(scene);
    else
      scene.world = {0.3f, 0.2f, 0.1f};
    if (variant >= 2) add_sun(scene, 0.5f, variant == 2 ? 0.3f : 0.05f);
    const Environment world(scene);
    CHECK(over_sphere([&](const Vec3& d) { return world.pdf(d); }) ==
          approx(1).epsilon(variant == 3 ? 0.02 : 0.005));
    // Any function has the same integral by samples: here the solid angle of octants.
    for (int octant = 0; octant < 8; ++octant) {
      const auto inside = [octant](const Vec3& d) {
        return ((d.x > 0) == bool(octant & 1) && (d.y > 0) == bool(octant & 2) &&
                (d.z > 0) == bool(octant & 4))
                   ? 1.0
                   : 0.0;
      };
      CHECK(by_sampling(world, inside) == approx(kPi / 2).epsilon(0.05));
    }
    // Of each part likewise: shares add up to one, and densities in parts to that of the whole.
    double shares = 0;
    for (int part = 0; part < Environment::kParts; ++part) shares += world.part_share(part);
    CHECK(shares == approx(1).epsilon(1e-4));
    for (uint32_t i = 0; i < 2000; ++i) {
      const Vec3 d =
          i % 2 ? sample_sphere(sobol_2d(i, 1, 1)) : world.sample(sobol_2d(i, 1, 1)).direction;
      CHECK(world.pdf_by_parts([&](int part) { return world.part_share(part); },
                               world.density(d)) == approx(world.pdf(d)).epsilon(1e-3));
      const int part = world.part_of(d);
      const Vec3 again = world.sample_part(part, sobol_2d(i, 7, 2)).direction;
      if (part != Environment::kDiscs)
        CHECK((world.part_of(again) == part || world.part_of(again) == Environment::kDiscs));
    }
    const auto red = [&](const Vec3& d) { return world.radiance(d).x; };
    CHECK(by_sampling(world, red) == approx(over_sphere(red)).epsilon(0.01));
    CHECK(average(world.mean()) * 4 * kPi == approx(over_sphere([&](const Vec3& d) {
                                               return average(world.radiance(d));
                                             })).epsilon(0.02));
  }
}

TEST_CASE(
    "samples bring the density that their direction has, but where rounding moves it to the next cell") {
  // Of the image; the table's rows end within a step, and with one
  for (const int width : {96, 100, 512}) {
    CAPTURE(width);
    Scene scene(1);
    add_map(scene, width);
    add_sun(scene, 0.5f, 0.05f);
    const Environment world(scene);
    int moved = 0, count = 0;
    const auto check = [&](const Environment::Sample& s) {
      REQUIRE(s.pdf == world.pdf(s.density));
      const bool same =
          s.pdf == world.pdf(s.direction) && world.density(s.direction).patch == s.density.patch;
      moved += !same;
      ++count;
    };
    for (uint32_t i = 0; i < 100000; ++i) check(world.sample(sobol_2d(i, 1, 1)));
    for (int part = 0; part < Environment::kParts; ++part)
      for (uint32_t i = 0; i < 100; ++i) check(world.sample_part(part, sobol_2d(i, 2, part)));
    CHECK(moved < count / 500);
  }
}

TEST_CASE("a world that is the same everywhere is known as such") {
  Scene scene(1);
  scene.world = {0.3f, 0.2f, 0.1f};
  CHECK(Environment(scene).constant());
  CHECK_FALSE(Environment(scene).black());
  CHECK(Environment(scene).irradiance({0, 1, 0}) == approx(kPi * 0.2f));
  scene.world = {};
  CHECK(Environment(scene).black());
  add_map(scene);
  CHECK_FALSE(Environment(scene).constant());
  CHECK(Environment(scene).contrast() > 0.3f);
}

TEST_CASE(
    "an image's directions follow Blender: u against the longitude, v upwards, the middle at +X") {
  CHECK(equirectangular_uv({1, 0, 0}).x == approx(0.5));
  CHECK(equirectangular_uv({0, 1, 0}).x == approx(0.25));
  CHECK(equirectangular_uv({0, 0, 1}).y == approx(1));
  CHECK(mirror_ball_uv({0, -1, 0}).x == approx(0.5));
  CHECK(mirror_ball_uv({0, -1, 0}).y == approx(0.5));
  CHECK(mirror_ball_uv({1, 0, 0}).x == approx(0.5 + 0.5 / std::sqrt(2.0)));
}

TEST_CASE(
    "the sun's disc: flux with limb darkening, half of it below the horizon, nothing beside it") {
  Scene scene(1);
  add_sun(scene, 0.5f, 0.01f);
  const Environment world(scene);
  const double solid_angle = 2 * kPi * (1 - std::cos(0.01));
  const auto green = [&](const Vec3& d) { return world.radiance(d).y; };
  // The mean of 1 - 0.6 (1 - sqrt(1 - r^2)) over the disc is 0.8; of the colour's gradient, the
  // middle.
  CHECK(by_sampling(world, green) == approx(95 * 0.8 * solid_angle).epsilon(0.01));
  CHECK(world.radiance({0, 0, 1}).y == 0);
  CHECK(world.radiance({std::cos(0.5f), 0, std::sin(0.5f)}).y == approx(95).epsilon(0.01));
  Scene setting(1);
  add_sun(setting, 0, 0.01f);
  const Environment half(setting);
  CHECK(by_sampling(half, [&](const Vec3& d) { return half.radiance(d).z > 0 ? 1.0 : 0.0; }) ==
        approx(solid_angle / 2).epsilon(0.02));
}

TEST_CASE("irradiance by light samples, by BSDF samples and by both is the same") {
  Scene scene(1);
  add_map(scene);
  add_sun(scene, 0.9f, 0.1f);
  fill(scene, make_grid(1), {identity});
  LampSettings lamp;
  lamp.strength = {20, 20, 20};
  lamp.to_world.m[11] = 2;
  for (const bool with_lamp : {false, true}) {
    const Lights lights(scene,
                        with_lamp ? std::vector<LampSettings>{lamp} : std::vector<LampSettings>{});
    for (const Vec3 n : {Vec3{0, 0, 1}, normalize(Vec3{1, -2, 0.5f})}) {
      const Receiver to{{0.5f, 0.5f, 0}, n, false};
      const Basis basis(n);
      double by_light = 0, by_bsdf = 0, by_both = 0, lamp_light = 0;
      constexpr uint32_t count = 1 << 19;
      for (uint32_t i = 0; i < count; ++i) {
        if (const auto s = lights.sample(to, sobol_2d(i, 0, 7).x, sobol_2d(i, 1, 7))) {
          const float cosine = std::max(0.0f, dot(s->direction, n)), bsdf_pdf = cosine / kPi;
          const double value = s->weight.x * cosine;
          by_light += value;
          if (!s->use_mis) lamp_light += value;
          by_both += value * (s->use_mis ? s->pdf * s->pdf / (s->pdf * s->pdf + bsdf_pdf * bsdf_pdf)
                                         : 1.0f);
        }
        const Vec3 local = sample_cosine_hemisphere(sobol_2d(i, 2, 7)), d = basis.to_world(local);
        if (!(local.z > 0)) continue;
        by_bsdf += lights.world_met(to, d, INFINITY).x * kPi;
        by_both += lights.world_met(to, d, local.z / kPi).x * kPi;
      }
      by_bsdf += lamp_light;
      CHECK(by_light / count == approx(by_bsdf / count).epsilon(0.01));
      CHECK(by_both / count == approx(by_bsdf / count).epsilon(0.01));
    }
  }
}

TEST_CASE("photons of the world carry its power through the scene's disc") {
  Scene scene(1);
  add_map(scene);
  add_sun(scene, 0.9f, 0.1f);
  fill(scene, make_grid(1), {identity});
  const Lights lights(scene, {});
  double sum = 0;
  constexpr uint32_t count = 1 << 16;
  for (uint32_t i = 0; i < count; ++i) {
    const PhotonStart start =
        PhotonEmitter(lights).emit(PhotonEmitter(lights).primary(i, 3, nullptr));
    REQUIRE(dot(start.direction, scene.center() - start.origin) > 0);
    sum += start.power.x;
  }
  const double disc = kPi * scene.radius() * scene.radius();
  CHECK(sum / count == approx(disc * over_sphere([&](const Vec3& d) {
                                return lights.environment().radiance(d).x;
                              }))
                           .epsilon(0.01));
}
