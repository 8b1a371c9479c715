#include "lights/lights.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

Vec3 at_random(Random& random, float size) {
  return Vec3{random.next() - 0.5f, random.next() - 0.5f, random.next()} * size;
}

// Lamps of all kinds, strewn about; suns among them.
std::vector<LampSettings> many_lamps(int count, bool suns = true) {
  std::vector<LampSettings> lamps;
  Random random(1, 7);
  for (int i = 0; i < count; ++i) {
    LampSettings s;
    s.kind = i % 29 == 5 && suns ? LampKind::kSun
             : i % 3 == 0        ? LampKind::kPoint
             : i % 3 == 1        ? LampKind::kSpot
                                 : LampKind::kArea;
    const Vec3 place = at_random(random, 20);
    const Basis basis(sample_sphere(random.next2()));
    for (int c = 0; c < 3; ++c) {
      s.to_world.m[4 * c] = basis.tangent[c];
      s.to_world.m[4 * c + 1] = basis.bitangent[c];
      s.to_world.m[4 * c + 2] = basis.normal[c];
      s.to_world.m[4 * c + 3] = place[c];
    }
    const float power = s.kind == LampKind::kSun ? 0.05f : 20 * random.next();
    s.strength = {power, power, power};
    s.radius = i % 2 ? 0.2f : 0;
    s.soft_falloff = i % 4 < 2;
    s.spot_size = 0.3f + 2 * random.next();
    s.spot_blend = 0.3f;
    s.size_x = 0.5f;
    s.size_y = 1.5f;
    s.spread = i % 5 ? kPi : 1;
    s.angle = 0.1f;
    s.camera_visible = true;
    lamps.push_back(s);
  }
  return lamps;
}

LightTree::Item item_of(const Vec3& place, float energy) {
  LightTree::Item item;
  item.bounds.add(place);
  item.energy = energy;
  return item;
}

double irradiance(const Lights& lights, const Receiver& to, uint32_t count, uint32_t seed) {
  double sum = 0;
  for (uint32_t i = 0; i < count; ++i)
    if (const auto s = lights.sample(to, sobol_2d(i, 0, seed).x, sobol_2d(i, 1, seed)))
      sum += s->weight.x * std::max(0.0f, dot(s->direction, to.n));
  return sum / count;
}

}  // namespace

TEST_CASE(
    "the tree picks every light with the probability that it states, and leaves out none that can shine") {
  std::vector<LightTree::Item> items;
  Random random(2, 3);
  for (int i = 0; i < 200; ++i)
    items.push_back(item_of(at_random(random, 10), i % 7 ? random.next() : 0.001f));
  for (int i = 0; i < 20; ++i) items.push_back(item_of({1, 1, 1}, 0.3f));  // all in one place
  LightTree tree;
  tree.build(items);
  for (int place = 0; place < 8; ++place) {
    const Vec3 x = at_random(random, 10), n = place ? sample_sphere(random.next2()) : Vec3{};
    double sum = 0;
    std::vector<double> expected;
    for (uint32_t i = 0; i < items.size(); ++i) {
      expected.push_back(tree.probability(i, x, n));
      sum += expected.back();
      // A light above the horizon is never left out.
      const Vec3 to = items[i].bounds.center() - x;
      if (place == 0 || dot(to, n) > 1e-3f) CHECK(expected.back() > 0);
    }
    CHECK(sum < 1.001);  // the rest are nodes that look lit from afar and hold nothing that is
    CHECK(sum > 0.2);
    std::vector<int> drawn(items.size());
    constexpr int count = 100000;
    for (int i = 0; i < count; ++i) {
      const auto c = tree.pick(x, n, random.next());
      if (!c) continue;
      CHECK(c->probability == approx(expected[c->item]).epsilon(1e-3));
      ++drawn[c->item];
    }
    double chi2 = 0;
    int cells = 0;
    for (uint32_t i = 0; i < items.size(); ++i) {
      if (expected[i] * count < 10) continue;
      const double e = expected[i] * count;
      chi2 += (drawn[i] - e) * (drawn[i] - e) / e;
      ++cells;
    }
    CHECK(chi2 < cells + 5 * std::sqrt(2.0 * cells));
  }
}

TEST_CASE("rays find the lights whose bounds they meet") {
  std::vector<LightTree::Item> items;
  Random random(3, 3);
  for (int i = 0; i < 300; ++i) {
    LightTree::Item item = item_of(at_random(random, 10), 1);
    item.bounds.add(item.bounds.lower + Vec3{random.next(), 0, random.next()});  // flat
    items.push_back(item);
  }
  LightTree tree;
  tree.build(items);
  for (int ray = 0; ray < 300; ++ray) {
    const Vec3 origin = at_random(random, 10), inside = items[ray].bounds.center();
    const float distance = length(inside - origin);
    bool found = false;
    tree.along(origin, (inside - origin) / distance, INFINITY,
               [&](uint32_t item) { found |= item == static_cast<uint32_t>(ray); });
    CHECK(found);
    found = false;
    tree.along(origin, (inside - origin) / distance, 0.2f * distance,
               [&](uint32_t item) { found |= item == static_cast<uint32_t>(ray); });
    if (distance > 2) CHECK_FALSE(found);
  }
}

TEST_CASE("irradiance from many lamps is the sum of theirs") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  const auto lamps = many_lamps(150);
  const Lights all(scene, lamps);
  for (const Receiver& to :
       {Receiver{{1, 2, 0}, {0, 0, 1}}, Receiver{{-4, 0, 5}, normalize(Vec3{1, 1, -1})}}) {
    double expected = 0;
    for (const LampSettings& lamp : lamps)
      expected += irradiance(Lights(scene, {lamp}), to, 512, 1);
    CHECK(irradiance(all, to, 1 << 19, 2) == approx(expected).epsilon(0.01));
  }
}

TEST_CASE("a receiver in one of a few point lamps gets the light of the others") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  std::vector<LampSettings> lamps(3);
  for (int i = 0; i < 3; ++i) {
    lamps[i].strength = {1, 1, 1};
    lamps[i].to_world.m[3] = static_cast<float>(i);
    lamps[i].to_world.m[11] = static_cast<float>(1 + i);
  }
  const Receiver to{{0, 0, 1}, {0, 0, 1}};
  double expected = 0;
  for (const LampSettings& lamp : {lamps[1], lamps[2]})
    expected += irradiance(Lights(scene, {lamp}), to, 16, 1);
  REQUIRE(expected > 0);
  CHECK(irradiance(Lights(scene, lamps), to, 1 << 12, 1) == approx(expected).epsilon(0.01));
}

TEST_CASE("many lamps: rays and light samples share them to the full") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  auto lamps = many_lamps(150);
  std::erase_if(lamps,
                [](const LampSettings& s) { return s.kind != LampKind::kArea && s.radius <= 0; });
  REQUIRE(lamps.size() > 60);
  const Lights all(scene, lamps);
  const Receiver to{{1, 2, 0}, {0, 0, 1}, true};
  double by_light = 0, by_ray = 0, shared = 0;
  constexpr uint32_t count = 1 << 20;
  for (uint32_t i = 0; i < count; ++i) {
    if (const auto s = all.sample(to, sobol_2d(i, 0, 3).x, sobol_2d(i, 1, 3))) {
      const double value = s->weight.x * std::max(0.0f, s->direction.z);
      const double pdf = std::max(0.0f, s->direction.z) / kPi;
      by_light += value;
      shared += value * (s->use_mis ? s->pdf * s->pdf / (s->pdf * s->pdf + pdf * pdf) : 1);
    }
    const Vec3 d = sample_cosine_hemisphere(sobol_2d(i, 2, 3));
    if (!(d.z > 0)) continue;
    by_ray += all.lamps_seen(to.x, d, 0, INFINITY, kShutterCentre).x * kPi;
    shared += all.lamps_met(to, d, 0, INFINITY, d.z / kPi).x * kPi;
  }
  CHECK(by_light / count == approx(by_ray / count).epsilon(0.03));
  CHECK(shared / count == approx(by_light / count).epsilon(0.01));
}

TEST_CASE("of many lamps, those near by are drawn most") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  std::vector<LampSettings> lamps(10000);
  for (int i = 0; i < 10000; ++i) {
    lamps[i].strength = {1, 1, 1};
    lamps[i].to_world.m[3] = static_cast<float>(i % 100);
    lamps[i].to_world.m[7] = static_cast<float>(i / 100);
    lamps[i].to_world.m[11] = 0.5f;
  }
  const Lights all(scene, lamps);
  const Receiver to{{50.2f, 49.9f, 0}, {0, 0, 1}};
  double sum = 0, squares = 0;
  constexpr uint32_t count = 1 << 14;
  for (uint32_t i = 0; i < count; ++i) {
    const auto s = all.sample(to, sobol_2d(i, 0, 3).x, sobol_2d(i, 1, 3));
    const double value = s ? s->weight.x * std::max(0.0f, s->direction.z) : 0;
    sum += value;
    squares += value * value;
  }
  double expected = 0, by_power = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3 way = Vec3{static_cast<float>(i % 100), static_cast<float>(i / 100), 0.5f} - to.x;
    const double value = 1 / (4 * kPi) * 0.5 / std::pow(double(length2(way)), 1.5);
    expected += value;
    by_power += 10000 * value * value;  // second moment of drawing them all alike
  }
  CHECK(sum / count == approx(expected).epsilon(0.02));
  const double mean = sum / count, deviation = std::sqrt(squares / count - mean * mean);
  CHECK(deviation < 0.1 * std::sqrt(by_power - expected * expected));
}

TEST_CASE(
    "a lamp seen from near: diffuse receivers draw it by their cosine, without bias and almost without noise") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  LampSettings lamp;
  lamp.kind = LampKind::kArea;
  lamp.strength = {1, 1, 1};
  lamp.size_x = 2;
  lamp.size_y = 1;
  lamp.to_world.m[11] = 3;  // shines downwards from there
  const Lights lights(scene, {lamp});
  struct Case {
    Vec3 x, ng, ns;
    double most_noise;  // of one sample over that of one that knows no cosine
  };
  const Vec3 tilted = normalize(Vec3{1, 0.3f, 0.4f});
  for (const Case& c :
       {Case{{0.5f, 0.2f, 0}, {0, 0, 1}, {0, 0, 1}, 0.6},
        Case{{6, 3, 1}, {0, 0, 1}, {0, 0, 1}, 0.1}, Case{{-3, 0, 1}, tilted, tilted, 0.2},
        // Half of the lamp below its horizon
        Case{{3, 1, 1}, {-1, 0, 0}, {-1, 0, 0}, 0.1}, Case{{1, 0, 1}, tilted, tilted, 1},
        Case{{-2, 0, 1}, {0, 0, 1}, normalize(Vec3{0.3f, 0.2f, 1}), 0.2}}) {
    double sums[2] = {0, 0}, squares[2] = {0, 0};
    constexpr uint32_t count = 1 << 15;
    for (int way : {0, 1}) {
      Receiver to{c.x, c.ng, way == 0};
      to.ns = c.ns;
      for (uint32_t i = 0; i < count; ++i)
        if (const auto s = lights.sample(to, 0.5f, sobol_2d(i, 1, 3))) {
          const double value = s->weight.x * std::max(0.0f, dot(c.ns, s->direction));
          sums[way] += value / count;
          squares[way] += value * value / count;
          CHECK(s->use_mis == (way == 0));
        }
    }
    CAPTURE(c.x.x);
    CHECK(sums[1] == approx(sums[0]).epsilon(2e-3));
    const auto noise = [&](int way) {
      return std::sqrt(std::max(0.0, squares[way] - sums[way] * sums[way]));
    };
    CHECK(noise(1) < c.most_noise * noise(0));
    const Receiver matte{c.x, c.ng, false, ~uint64_t{0}, nullptr, 1, 0xff, 0, c.ns};
    CHECK_FALSE(lights.wants_bsdf_ray(matte));
    const Vec3 d = normalize(Vec3{0, 0, 3} - c.x);
    CHECK(lights.lamps_met(matte, d, 0, INFINITY, 0.3f).x == 0);
  }
}
