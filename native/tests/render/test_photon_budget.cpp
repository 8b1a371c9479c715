#include "render/photon_budget.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace photon_splat;

TEST_CASE("batches fit into what is left of the time") {
  constexpr uint64_t many = 1'000'000'000, most = 1'000'000;
  CHECK(batch_that_fits(many, most, INFINITY, {}, false) == most);
  CHECK(batch_that_fits(many, most, 1, {}, false) == kTrialPaths);
  CHECK(batch_that_fits(200'000, most, 1, {}, true) == 200'000);
  CHECK(std::abs(double(batch_that_fits(many, most, 1, 1e-5, false)) - 1e5) <= 1);
  CHECK(batch_that_fits(many, most, 1, 1e-7, false) == most);
  CHECK(batch_that_fits(many, most, 1, 1e-5, true) == 0);
  CHECK(batch_that_fits(many, most, 1e-5 * kFewestPaths / 2, 1e-5, false) == 0);
  CHECK(batch_that_fits(many, most, -1, 1e-5, false) == 0);
}

TEST_CASE("photons have some time even where camera samples have taken all of it") {
  PassClock late(0);
  CHECK(late.seconds_for_one_of(1) <= 0);
  late.see_camera(40);
  CHECK(late.seconds_for_one_of(1) == approx(4));
  CHECK(late.seconds_for_one_of(2) == approx(2));
  PassClock early(100);
  early.see_camera(40);
  CHECK(early.seconds_for_one_of(1) == approx(94).epsilon(0.01));
}
