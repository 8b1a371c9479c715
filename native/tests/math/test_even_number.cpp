#include "math/even_number.h"

#include <doctest/doctest.h>

#include "support/approx.h"

using namespace photon_splat;

TEST_CASE("a number that decides is spread as evenly over what it decides, and over what is left") {
  constexpr int count = 1000;
  Random random(1, 2);
  int first = 0, second = 0;
  double left = 0;
  for (int i = 0; i < count; ++i) {
    const float u = (static_cast<float>(i) + 0.5f) / count;
    EvenNumber number;
    if (number.decide(u, 0.3f, random)) {
      ++first;
      continue;
    }
    second += number.decide(u, 0.5f, random);
    left += number.rest(u, random);
  }
  CHECK(first == 300);
  CHECK(second == 350);
  CHECK(left / (count - first) == approx(0.5).epsilon(1e-3));
}

TEST_CASE("a number that is used up is a random one") {
  Random random(3, 4);
  EvenNumber number;
  CHECK(number.rest(0.25f, random) == 0.25f);
  number.use_up();
  CHECK(number.rest(0.25f, random) != number.rest(0.25f, random));
  int yes = 0;
  for (int i = 0; i < 10000; ++i) yes += number.decide(0.25f, 0.1f, random);
  CHECK(yes == approx(1000).epsilon(0.1));
  // One decision after another narrows it until nothing is left; a random one then goes on
  EvenNumber narrow;
  for (int i = 0; i < 40; ++i) narrow.decide(0.999f, 0.5f, random);
  CHECK(narrow.rest(0.999f, random) != narrow.rest(0.999f, random));
}
