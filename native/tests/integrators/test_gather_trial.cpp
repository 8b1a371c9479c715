#include "integrators/gather_trial.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

using namespace photon_splat;

namespace {

// Neighbours that differ by `noise`, of which `deep` is from beyond the first place, in paths of
// `rays`, of which so many are for that.
GatherTrial trial(float noise, float deep, uint64_t rays, uint64_t deep_rays) {
  GatherTrial t;
  for (int i = 0; i < 100; ++i) t.add_pair(1 + noise, deep, 1 - noise, -deep);
  t.add_rays(100, rays, deep_rays);
  return t;
}

}  // namespace

TEST_CASE("paths pay where photons would take nothing off their noise, whatever photons cost") {
  CHECK(trial(0.3f, 0, 500, 0).paths_pay(0));
  CHECK(trial(0.3f, 0, 500, 100).paths_pay(1));
  CHECK_FALSE(trial(0.3f, 0, 500, 400).paths_pay(0));  // but not for five times the rays
}

TEST_CASE(
    "photons pay where most of the noise comes from beyond, unless they are many for each path") {
  CHECK_FALSE(trial(0.3f, 0.2f, 1000, 500).paths_pay(0.2));
  CHECK(trial(0.3f, 0.2f, 1000, 500).paths_pay(40));
}

TEST_CASE("trials add up, specks and what is not finite say little") {
  GatherTrial sum = trial(0.3f, 0.05f, 500, 50);
  const bool before = sum.paths_pay(0.2);
  sum.add(trial(0.3f, 0.05f, 500, 50));
  CHECK(sum.paths_pay(0.2) == before);
  sum.add_pair(INFINITY, INFINITY, 1, 0);
  sum.add_pair(NAN, 0, 1, 0);
  sum.add_pair(1e6f, 1e6f, 1, 0);
  CHECK(sum.paths_pay(0.2) == before);
  CHECK_FALSE(GatherTrial().paths_pay(1));
}

TEST_CASE(
    "photons are worth their blur where they take most of the noise, beside the light of tiles") {
  const auto beats = [](double all, double shallow, uint64_t rays, uint64_t deep) {
    GatherTrial t;
    for (const double light : {1.0, 100.0}) {
      t.begin_tile(light);
      for (int i = 0; i < 50; ++i) t.add_pixel(all * light * light, shallow * light * light);
    }
    t.add_rays(100, rays, deep);
    return t.paths_beat_density();
  };
  CHECK(beats(1, 0.9, 400, 20));
  CHECK_FALSE(beats(1, 0.1, 400, 20));
  CHECK_FALSE(beats(1, 0.6, 800, 500));  // nor for three times the rays
  CHECK_FALSE(GatherTrial().paths_beat_density());
  GatherTrial t;  // what is not finite says nothing
  t.begin_tile(INFINITY);
  t.add_pixel(1, 0);
  t.begin_tile(1);
  t.add_pixel(NAN, 0);
  t.add_pixel(1, 1);
  t.add_rays(1, 4, 0);
  CHECK(t.paths_beat_density());
}
