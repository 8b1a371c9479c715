#include <doctest/doctest.h>

#include <algorithm>

#include "film/shadow_catcher.h"
#include "support/approx.h"

using namespace photon_splat;

namespace {

// Four samples: one of a thing, two of a catcher, one of the world behind all.
Pixel seen() {
  Pixel p;
  p.samples = 4;
  p.emission = {0.8f, 0.4f, 0.4f};
  p.alpha = 1;
  p.caught_alpha = 2;
  p.caught = {1, 0.5f, 0};
  p.caught_alone = {2, 2, 2};
  p.backdrop = {4, 4, 4};
  return p;
}

}  // namespace

TEST_CASE("a catcher's shadow is its light over that without other things") {
  const Pixel p = seen();
  const Rgb shadow = caught_shadow(p);
  CHECK(shadow.x == approx(0.25f + 0.75f * 0.5f));
  CHECK(shadow.y == approx(0.25f + 0.75f * 0.25f));
  CHECK(shadow.z == approx(0.25f));
  CHECK(caught_shadow(Pixel{}).x == 1);
}

TEST_CASE("a shadow is alpha in a transparent film and darkens the world in an opaque one") {
  const Pixel p = seen();
  const Rgb light = p.combined() * p.share();
  const float shown = average(caught_shadow(p));
  const Rgba clear = with_shadow(p, light, true), opaque = with_shadow(p, light, false);
  CHECK(clear.color.x == light.x);
  CHECK(clear.alpha == approx(0.25f + 0.75f * (1 - shown)));
  CHECK(opaque.color.x == approx(light.x + shown));
  CHECK(opaque.alpha == 1);
}

TEST_CASE("light that things throw on a catcher does not brighten the picture") {
  Pixel p = seen();
  p.caught = {9, 9, 9};
  CHECK(caught_shadow(p).x > 1);
  CHECK(with_shadow(p, {}, true).alpha == approx(0.25f));
  CHECK(with_shadow(p, {}, false).color.x == approx(1));
}
