// The cells that keep the light of surfaces for a viewport.
#include "integrators/light_cache.h"
#include "support/approx.h"

#include <doctest/doctest.h>

using namespace photon_splat;

namespace {

using Kind = LightCache::Kind;
constexpr Vec3 up{0, 0, 1};

LightCache::Place at(float x, float y, uint32_t key = 1, float width = 0.25f) {
  return LightCache::place(key, {x, y, 0}, up, width);
}

// As many samples as no wider cell has to help out with.
void fill(LightCache& cache, float x, float y, float light) {
  for (int i = 0; i < 32; ++i) cache.add(at(x, y), Kind::kDiffuse, {light, 2 * light, 0});
}

}  // namespace

TEST_CASE("a cell gives the mean of its samples, and is known by its surface, side and kind") {
  LightCache cache;
  const LightCache::Place place = at(0.125f, 0.125f);  // the middle of a cell
  CHECK(!cache.knows(place, Kind::kDiffuse));
  CHECK(is_black(cache.light(place, Kind::kDiffuse)));
  cache.add(place, Kind::kDiffuse, {1, 0, 0});
  cache.add(place, Kind::kDiffuse, {3, 2, 0});
  CHECK(cache.samples(place, Kind::kDiffuse) == 2);
  CHECK(cache.light(place, Kind::kDiffuse).x == approx(2));
  CHECK(cache.light(place, Kind::kDiffuse).y == approx(1));
  CHECK(!cache.knows(place, Kind::kReflected));
  CHECK(!cache.knows(at(0.125f, 0.125f, 2), Kind::kDiffuse));
  CHECK(!cache.knows(LightCache::place(1, {0.125f, 0.125f, 0}, -up, 0.25f), Kind::kDiffuse));
  CHECK(!cache.knows(at(100, 0), Kind::kDiffuse));
}

TEST_CASE("between the middles of cells light changes evenly") {
  LightCache cache;
  fill(cache, 0.125f, 0.125f, 1);
  fill(cache, 0.375f, 0.125f, 3);
  for (const float share : {0.0f, 0.25f, 0.5f, 1.0f}) {
    const Rgb light = cache.light(at(0.125f + 0.25f * share, 0.125f), Kind::kDiffuse);
    CHECK(light.x == approx(1 + 2 * share));
    CHECK(light.y == approx(2 + 4 * share));
  }
}

TEST_CASE("light that is linear over a surface is read as such, below 0 too, whatever the axis") {
  for (const Vec3& normal : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}}) {
    LightCache cache;
    const Vec3 a = normal.x != 0 ? Vec3{0, 1, 0} : Vec3{1, 0, 0}, b = cross(absolute(normal), a);
    for (int i = -8; i < 8; ++i)
      for (int k = -8; k < 8; ++k)
        for (int n = 0; n < 40; ++n) {
          const float u = (static_cast<float>(i) + 0.5f) / 4,
                      v = (static_cast<float>(k) + 0.5f) / 4;
          cache.add(LightCache::place(7, a * u + b * v, normal, 0.25f), Kind::kDiffuse,
                    {10 + u + 2 * v, 0, 0});
        }
    for (const auto& [u, v] : {std::pair{-1.3f, -0.7f}, {0.02f, -0.01f}, {1.1f, 0.9f}})
      CHECK(cache.light(LightCache::place(7, a * u + b * v, normal, 0.25f), Kind::kDiffuse).x ==
            approx(10 + u + 2 * v).epsilon(1e-4));
  }
}

TEST_CASE("where cells hold nothing, wider ones tell") {
  LightCache cache;
  fill(cache, 0.125f, 0.125f, 5);
  const LightCache::Place beside = at(0.6f, 0.6f);
  CHECK(cache.samples(beside, Kind::kDiffuse) == 0);
  CHECK(cache.knows(beside, Kind::kDiffuse));
  CHECK(cache.light(beside, Kind::kDiffuse).x == approx(5));
}

TEST_CASE("reflected light is told apart by where a mirror would look") {
  LightCache cache;
  const auto looking = [](const Vec3& direction) {
    LightCache::Place place = at(0.125f, 0.125f);
    LightCache::set_mirror(place, normalize(direction), 20);
    return place;
  };
  for (int i = 0; i < 32; ++i) {
    cache.add(looking({1, 0, 0.2f}), Kind::kReflected, {1, 0, 0});
    cache.add(looking({-1, 0, 0.2f}), Kind::kReflected, {9, 0, 0});
  }
  CHECK(cache.light(looking({1, 0, 0.2f}), Kind::kReflected).x == approx(1));
  CHECK(cache.light(looking({-1, 0, 0.2f}), Kind::kReflected).x == approx(9));
  CHECK(cache.samples(looking({0, 0, 1}), Kind::kReflected) == 0);
}

TEST_CASE("old samples fade, so that light that has changed comes through") {
  LightCache cache;
  const LightCache::Place place = at(0.125f, 0.125f);
  for (int i = 0; i < 1000; ++i) cache.add(place, Kind::kDiffuse, {1, 1, 1});
  for (int i = 0; i < 1000; ++i) cache.add(place, Kind::kDiffuse, {2, 2, 2});
  CHECK(cache.light(place, Kind::kDiffuse).x == approx(2).epsilon(0.01));
}

TEST_CASE("memory is bounded: what no late picture has added to is forgotten first") {
  constexpr size_t most = 10000;
  LightCache cache(most);
  const auto cell = [](int i) { return at(static_cast<float>(i), 0.125f); };
  int next = 0;
  for (int picture = 0; picture < 12; ++picture) {
    cache.begin_picture();
    for (int i = 0; i < 1000; ++i) cache.add(cell(next++), Kind::kDiffuse, {1, 1, 1});
  }
  cache.begin_picture();
  CHECK(cache.size() <= most);
  CHECK(cache.knows(cell(next - 1), Kind::kDiffuse));
  CHECK(!cache.knows(cell(0), Kind::kDiffuse));
}

TEST_CASE("absurd places have a cell as well") {
  LightCache cache;
  for (const float x : {1e30f, -1e30f, INFINITY, NAN})
    for (const float width : {0.0f, 1e-30f, 1.0f, INFINITY, NAN}) {
      LightCache::Place place = LightCache::place(1, {x, x, x}, up, width);
      LightCache::set_mirror(place, {x, x, x}, 20);
      cache.add(place, Kind::kDiffuse, {1, 1, 1});
      cache.add(place, Kind::kReflected, {1, 1, 1});
      CHECK(is_finite(cache.light(place, Kind::kReflected)));
      CHECK(is_finite(cache.light(place, Kind::kDiffuse)));
    }
}

TEST_CASE("samples go by albedo, and a colour that it lacks by the others") {
  CacheSample sample;
  sample.albedo.diffuse = {0.5f, 0.25f, 0};
  sample.light.diffuse = {1, 1, 0};
  const Rgb light = sample.over_albedo().diffuse;
  CHECK(light.x == approx(2));
  CHECK(light.y == approx(4));
  CHECK(light.z == approx(3));
  CHECK(is_black(sample.over_albedo().reflected));
}
