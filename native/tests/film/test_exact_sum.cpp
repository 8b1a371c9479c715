#include "film/exact_sum.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "math/sampling.h"

using namespace photon_splat;

namespace {

// Of all sizes and both signs.
std::vector<float> made(size_t count, uint32_t seed) {
  std::vector<float> values(count);
  Random random(0, seed);
  for (float& value : values)
    value = std::ldexp(random.next() - 0.5f, static_cast<int>(random.next() * 250) - 130);
  return values;
}

}  // namespace

TEST_CASE("a sum of two floats is what double precision makes of them, where that has room") {
  for (const auto& [a, b] : {std::pair{1.0f, 0x1p-24f},
                             {1.0f, 0x1p-25f},
                             {3.0f, 0x1p-23f},
                             {-1.0f, 0x1p-24f},
                             {0x1p-149f, 0x1p-149f},
                             {1e20f, -1e20f}}) {
    const double sum = double{a} + b;
    const float terms[] = {a, b};
    const std::vector<float> parts = exact_sums(terms, 2, 1);
    CHECK(parts[0] == static_cast<float>(sum));
    double all = 0;
    for (const float part : parts) all += part;
    CHECK(all == sum);
  }
}

TEST_CASE("neither order nor grouping changes a bit of a sum") {
  constexpr size_t kTerms = 40;
  std::vector<float> values = made(kTerms, 1);
  const std::vector<float> sum = exact_sums(values.data(), kTerms, 1);
  std::vector<float> back(values.rbegin(), values.rend());
  CHECK(exact_sums(back.data(), kTerms, 1) == sum);
  for (const size_t cut : {1u, 13u, 39u}) {
    std::vector<float> halves = exact_sums(values.data(), cut, 1);
    const std::vector<float> rest = exact_sums(values.data() + cut, kTerms - cut, 1);
    halves.insert(halves.end(), rest.begin(), rest.end());
    CHECK(exact_sums(halves.data(), halves.size(), 1) == sum);
  }
}

TEST_CASE("what is added and taken away leaves nothing") {
  std::vector<float> values = made(30, 2);
  for (size_t i = 0; i < 30; ++i) values.push_back(-values[i]);
  CHECK(exact_sums(values.data(), values.size(), 1) == std::vector<float>{0.0f});
}

TEST_CASE("a sum beyond all floats is kept in several") {
  const float most = std::numeric_limits<float>::max();
  const float terms[] = {most, most, most};
  CHECK(exact_sums(terms, 3, 1) == std::vector<float>{most, most, most});
}

TEST_CASE("what is no number is refused") {
  const float terms[] = {1, std::numeric_limits<float>::quiet_NaN()};
  CHECK_THROWS_AS(exact_sums(terms, 2, 1), std::invalid_argument);
}
