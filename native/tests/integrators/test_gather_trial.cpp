#include "integrators/gather_trial.h"

#include <doctest/doctest.h>

#include <cmath>

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
