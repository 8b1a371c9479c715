#include "lights/emission/emission_guide.h"
#include "math/random_streams.h"
#include "support/approx.h"

#include <doctest/doctest.h>

using namespace photon_splat;

namespace {

EmissionPrimary unguided(Random& random, const std::vector<double>& powers) {
  double sum = 0;
  for (const double p : powers) sum += p;
  double target = random.next() * sum;
  uint32_t e = 0;
  while (e + 1 < powers.size() && target >= powers[e]) target -= powers[e++];
  return {e, random.next2(), random.next2(), random.next2()};
}

EmissionPrimary guided(Random& random, const EmissionGuide& guide) {
  EmissionPrimary p{0, random.next2(), random.next2(), random.next2()};
  guide.warp(p, random.next2());
  return p;
}

// Use of a path, which goes with the square of its power: in a small box of the second emitter.
bool in_box(const EmissionPrimary& p) {
  const auto near = [](float u, float at) { return std::abs(u - at) < 0.05f; };
  return p.emitter == 1 && near(p.place.x, 0.62f) && near(p.place.y, 0.31f) &&
         near(p.way.x, 0.5f) && p.way.y > 0.5f;
}

void teach(EmissionGuide& guide, Random& random, const std::vector<double>& powers, bool by_guide,
           double (*use)(const EmissionPrimary&)) {
  std::vector<EmissionPrimary> paths(65536);
  for (EmissionPrimary& p : paths) p = by_guide ? guided(random, guide) : unguided(random, powers);
  for (const EmissionPrimary& p : paths) guide.learn(p, use(p) * p.weight * p.weight);
  guide.finish();
}

double box(const EmissionPrimary& p) { return in_box(p) ? 1 : 0; }

}  // namespace

TEST_CASE("a guide finds a small part of one emitter and loses none of the light") {
  const std::vector<double> powers{3, 1, 0.5};
  Random random(7, 11);
  EmissionGuide guide(powers);
  for (int pilot = 0; pilot < 4; ++pilot) teach(guide, random, powers, pilot > 0, box);
  const int count = 400000;
  double found = 0, weights = 0, of_last = 0, in_it = 0, moment = 0, heaviest = 0;
  for (int i = 0; i < count; ++i) {
    const EmissionPrimary p = guided(random, guide);
    weights += p.weight, heaviest = std::max<double>(heaviest, p.weight);
    if (p.emitter == 2) of_last += p.weight;
    moment += p.weight * (p.place.x + 2 * p.way.y);
    if (in_box(p)) in_it += p.weight, ++found;
  }
  // .0005 of a share of 1/4.5 of the paths is there
  const double part = 0.1 * 0.1 * 0.1 * 0.5 / 4.5;
  CHECK(in_it / count == approx(part).epsilon(0.02));
  CHECK(found / count > 500 * part);
  CHECK(weights / count == approx(1).epsilon(0.01));
  CHECK(of_last / count == approx(0.5 / 4.5).epsilon(0.03));
  CHECK(moment / count == approx(1.5).epsilon(0.01));
  CHECK(heaviest < 1 / 0.3 / 0.3 + 1e-3);
}

TEST_CASE("a guide cuts nothing where all paths are as useful, whoever drew them") {
  Random random(3, 5);
  EmissionGuide guide({1, 1});
  for (int pilot = 0; pilot < 3; ++pilot)
    teach(guide, random, {1, 1}, pilot > 0, [](const EmissionPrimary&) { return 0.25; });
  CHECK(guide.cells() == 2);
}

TEST_CASE("a guide that has found nothing of use draws as if it was not there") {
  Random random(3, 6);
  EmissionGuide guide({3, 1});
  teach(guide, random, {3, 1}, false, [](const EmissionPrimary&) { return 0.0; });
  for (int i = 0; i < 100; ++i) CHECK(guided(random, guide).weight == approx(1));
}

TEST_CASE("further pilots see what the first one saw too little of") {
  Random random(9, 2);
  EmissionGuide guide({1});
  teach(guide, random, {1}, false, [](const EmissionPrimary& p) {
    return std::abs(p.place.x - 0.3f) < 0.01f && p.way.y < 0.03f ? 1.0 : 0.0;
  });
  const auto share = [&] {
    int found = 0;
    for (int i = 0; i < 50000; ++i) {
      const EmissionPrimary p = guided(random, guide);
      found += std::abs(p.place.x - 0.3f) < 0.01f && p.way.y < 0.03f;
    }
    return found / 50000.0;
  };
  const double once = share();
  for (int pilot = 1; pilot < 4; ++pilot)
    teach(guide, random, {1}, true, [](const EmissionPrimary& p) {
      return std::abs(p.place.x - 0.3f) < 0.01f && p.way.y < 0.03f ? 1.0 : 0.0;
    });
  CHECK(share() > 1.3 * once);
}
