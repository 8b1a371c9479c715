#include <doctest/doctest.h>

#include "lights/environment_guide.h"
#include "math/vec.h"
#include "support/approx.h"

using namespace photon_splat;

namespace {

const Vec3 kUp{0, 0, 1};

// A world that is the same from everywhere, or has a disc of a sun in it, or one of a few texels.
enum class Sky { kEven, kSun, kImage };
struct World {
  explicit World(Sky sky) : scene(1) {
    scene.world = {1, 1, 1};
    if (sky == Sky::kSun) {
      SunDisc sun;
      sun.direction = kSun;
      sun.half_angle = 0.01f;
      sun.bottom = sun.top = {2e5f, 2e5f, 2e5f};
      sun.horizon = 0;
      scene.sun_discs.push_back(sun);
    }
    if (sky == Sky::kImage) {
      Texture t;
      t.width = 128;
      t.height = 64;
      for (int i = 0; i < t.width * t.height; ++i) {
        const float level = i / t.width == 48 && i % t.width == 40 ? 20000.0f : 1.0f;
        t.floats.insert(t.floats.end(), {level, level, level, 1});
      }
      scene.textures.push_back(t);
      scene.world_map.texture = 0;
    }
    environment = std::make_unique<Environment>(scene);
  }
  static inline const Vec3 kSun = normalize(Vec3{0.3f, 0.5f, 0.6f});
  Scene scene;
  std::unique_ptr<Environment> environment;
};

// Sightings from places in the unit cube, most of them of a patch of sky around `centre`; every
// tenth ray meets the world.
EnvironmentGuide taught(const World& world, const Vec3& centre, int rays) {
  Random random(5, 6);
  std::vector<EnvironmentGuide::Sighting> sightings;
  for (int i = 0; i < rays; ++i) {
    const Vec3 x{random.next(), random.next(), 0.1f * random.next()};
    const bool met = i % 10 == 0;
    const Vec3 way = met ? normalize(centre + sample_sphere(random.next2()) * 0.2f)
                         : sample_sphere(random.next2());
    sightings.push_back({x, kUp, way, met ? 1.0f : 0.0f, true});
  }
  EnvironmentGuide guide;
  guide.reset(*world.environment);
  guide.learn(sightings);
  guide.end_pass();
  return guide;
}

}  // namespace

TEST_CASE("the guide's density integrates to 1 and its samples follow it") {
  const Vec3 centre = normalize(Vec3{0.6f, -0.3f, 0.5f});
  for (const Sky sky : {Sky::kEven, Sky::kSun, Sky::kImage}) {
    CAPTURE(int(sky));
    const World world(sky);
    const Environment& environment = *world.environment;
    const EnvironmentGuide guide = taught(world, centre, 20000);
    const auto* cell = guide.find({0.5f, 0.5f, 0.05f}, kUp);
    REQUIRE(cell);
    Random random(1, 1);
    double there = 0, whole = 0, solid_angle = 0;
    const int count = 400000;
    const auto near = [&](const Vec3& d) { return dot(d, centre) > 0.95f; };
    for (int i = 0; i < count; ++i) {
      const auto [s, density, world_pdf] = cell->sample(environment, random.next2());
      CHECK(length(s) == approx(1).epsilon(1e-5));
      const double pdf = cell->pdf(environment, density);
      CHECK(pdf > 0);
      CHECK(world_pdf == environment.pdf(density));
      there += double(near(s)) / count;
      // Samples over their density give solid angles, if that is theirs: of the hemisphere, small
      // suns and all, and of the patch.
      whole += double(s.z > 0) / pdf / count;
      solid_angle += double(near(s)) / pdf / count;
    }
    CHECK(whole == approx(2 * kPi).epsilon(0.05));
    CHECK(solid_angle == approx(2 * kPi * 0.05).epsilon(0.02));
    CHECK(there > 0.5);
  }
}

TEST_CASE(
    "within a part of the world the guide draws as the world shines: a sun of one texel is met by what has seen it") {
  for (const Sky sky : {Sky::kSun, Sky::kImage}) {
    CAPTURE(int(sky));
    const World world(sky);
    const Environment& environment = *world.environment;
    // The brightest direction, by the world's own samples.
    Random random(3, 4);
    Vec3 sun = kUp;
    for (int i = 0; i < 1000; ++i)
      if (const Vec3 d = environment.sample(random.next2()).direction;
          environment.radiance(d).x > environment.radiance(sun).x)
        sun = d;
    for (const bool seen : {true, false}) {
      std::vector<EnvironmentGuide::Sighting> sightings;
      for (int i = 0; i < 20000; ++i) {
        const Environment::Sample s = environment.sample(random.next2());
        const bool shines = dot(s.direction, sun) > 0.99f;
        const float weight = s.direction.z > 0 && (seen || !shines)
                                 ? environment.radiance(s.direction).x * s.direction.z / s.pdf
                                 : 0;
        sightings.push_back({{random.next(), random.next(), 0}, kUp, s.direction, weight, false});
      }
      EnvironmentGuide guide;
      guide.reset(environment);
      guide.learn(sightings);
      guide.end_pass();
      const auto* cell = guide.find({0.5f, 0.5f, 0}, kUp);
      REQUIRE(cell);
      int met = 0;
      for (int i = 0; i < 10000; ++i)
        met += dot(cell->sample(environment, random.next2()).direction, sun) > 0.99f;
      if (seen)
        CHECK(met > 5000);
      else
        CHECK(met < 2500);  // the guide's doubt
    }
  }
}

TEST_CASE(
    "no guide where nothing is known, where little is, or where an even world is seen freely") {
  const World world(Sky::kEven);
  CHECK(EnvironmentGuide().find({0, 0, 0}, kUp) == nullptr);
  CHECK(taught(world, {0, 0, 1}, 100).find({0.5f, 0.5f, 0}, kUp) == nullptr);
  CHECK(taught(world, {0, 0, 1}, 20000).find({0.5f, 0.5f, 0}, -kUp) == nullptr);
  EnvironmentGuide free;
  free.reset(*world.environment);
  std::vector<EnvironmentGuide::Sighting> all;
  Random random(2, 3);
  for (int i = 0; i < 1000; ++i)
    all.push_back({{random.next(), 0, 0}, kUp, sample_sphere(random.next2()), 1, true});
  free.learn(all);
  free.end_pass();
  CHECK(free.find({0.5f, 0, 0}, kUp) == nullptr);
}

TEST_CASE("learning ends, and what is learnt in one place is no harm far outside of it") {
  const World world(Sky::kEven);
  EnvironmentGuide guide = taught(world, {0, 0, 1}, 20000);
  for (int pass = 0; pass < 100; ++pass) guide.end_pass();
  CHECK(!guide.learning());
  for (const Vec3& x : {Vec3{1e30f, 0, 0}, Vec3{-1e30f, 5, -3}, Vec3{NAN, 0, 0}}) {
    const auto* cell = guide.find(x, kUp);
    if (cell)
      CHECK(std::isfinite(cell->pdf(*world.environment, world.environment->density({0, 0, 1}))));
  }
}
