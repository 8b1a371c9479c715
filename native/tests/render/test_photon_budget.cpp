#include "render/photon_budget.h"

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
