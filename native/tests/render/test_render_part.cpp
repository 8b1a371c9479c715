#include "render/render_part.h"

#include <doctest/doctest.h>

using namespace photon_splat;

TEST_CASE("the whole has the paths and the seeds of a render like any other") {
  const RenderPart whole;
  CHECK(whole.whole());
  CHECK(whole.own(77) == 77);
  CHECK(whole.paths(0, 5000, 1000) == 6000);
  CHECK(whole.passes(3) == 4);
}

TEST_CASE("parts that have done the same end their passes one after the other") {
  RenderPart part;
  part.count = 4;
  double before = 0;
  for (uint64_t pass = 0; pass < 3; ++pass)
    for (part.number = 1; part.number <= part.count; ++part.number) {
      CHECK(part.paths(0, 100 * pass, 100) == before + 100);
      before += 100;
    }
}

TEST_CASE("a generation goes on where the one before has ended, in the same sequences") {
  RenderPart part;
  part.generation = 1;
  part.passes_before = 8;
  part.paths_before = {800, 300};
  CHECK(part.paths(0, 0, 100) == 900);
  CHECK(part.paths(1, 100, 100) == 500);
  CHECK(part.paths(2, 100, 100) == 200);
  CHECK(part.passes(0) == 9);
  CHECK(part.paths_done(0, 50) == 850);
  CHECK(part.paths_done(2, 50) == 50);
  CHECK(part.own(77) == 77);
  part.number = 2;
  RenderPart other = part;
  other.generation = 2;
  CHECK(part.own(77) != 77);
  CHECK(part.own(77) == other.own(77));
  other.number = 3;
  CHECK(part.own(77) != other.own(77));
}
