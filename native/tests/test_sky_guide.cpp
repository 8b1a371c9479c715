#include <doctest/doctest.h>

#include "sky_guide.h"
#include "vec.h"

using namespace photon_splat;

namespace {

const Vec3 kUp{0, 0, 1};

// Sightings from places in the unit cube, most of them of a patch of sky around `centre`; every tenth ray meets the world.
SkyGuide taught(const Vec3& centre, int rays) {
  Random random(5, 6);
  std::vector<SkyGuide::Sighting> sightings;
  for (int i = 0; i < rays; ++i) {
    const Vec3 x{random.next(), random.next(), 0.1f * random.next()};
    const bool met = i % 10 == 0;
    const Vec3 way = met ? normalize(centre + sample_sphere(random.next2()) * 0.2f) : sample_sphere(random.next2());
    sightings.push_back({x, kUp, way, met ? 1.0f : 0.0f, true});
  }
  SkyGuide guide;
  guide.learn(sightings);
  guide.end_pass();
  return guide;
}

}  // namespace

TEST_CASE("the guide's density integrates to 1 and its samples follow it") {
  const Vec3 centre = normalize(Vec3{0.6f, -0.3f, 0.5f});
  const SkyGuide guide = taught(centre, 20000);
  const auto* cell = guide.find({0.5f, 0.5f, 0.05f}, kUp);
  REQUIRE(cell);
  Random random(1, 1);
  double sum = 0, there = 0, expected = 0;
  const int count = 400000;
  const auto near = [&](const Vec3& d) { return dot(d, centre) > 0.95f; };
  for (int i = 0; i < count; ++i) {
    const Vec3 d = sample_sphere(random.next2());
    const double pdf = cell->pdf(d) * 4 * kPi / count;
    sum += pdf;
    if (near(d)) expected += pdf;
    const Vec3 s = cell->sample(random.next2());
    CHECK(length(s) == doctest::Approx(1).epsilon(1e-5));
    CHECK(cell->pdf(s) > 0);
    there += double(near(s)) / count;
  }
  CHECK(sum == doctest::Approx(1).epsilon(0.02));
  CHECK(there == doctest::Approx(expected).epsilon(0.03));
  CHECK(there > 0.5);
}

TEST_CASE("no guide where nothing is known, where little is, or where the world is seen freely") {
  CHECK(SkyGuide().find({0, 0, 0}, kUp) == nullptr);
  CHECK(taught({0, 0, 1}, 100).find({0.5f, 0.5f, 0}, kUp) == nullptr);
  CHECK(taught({0, 0, 1}, 20000).find({0.5f, 0.5f, 0}, -kUp) == nullptr);
  SkyGuide free;
  std::vector<SkyGuide::Sighting> all;
  Random random(2, 3);
  for (int i = 0; i < 1000; ++i) all.push_back({{random.next(), 0, 0}, kUp, sample_sphere(random.next2()), 1, true});
  free.learn(all);
  free.end_pass();
  CHECK(free.find({0.5f, 0, 0}, kUp) == nullptr);
}

TEST_CASE("learning ends, and what is learnt in one place is no harm far outside of it") {
  SkyGuide guide = taught({0, 0, 1}, 20000);
  for (int pass = 0; pass < 100; ++pass) guide.end_pass();
  CHECK(!guide.learning());
  for (const Vec3& x : {Vec3{1e30f, 0, 0}, Vec3{-1e30f, 5, -3}, Vec3{NAN, 0, 0}}) {
    const auto* cell = guide.find(x, kUp);
    if (cell) CHECK(std::isfinite(cell->pdf({0, 0, 1})));
  }
}
