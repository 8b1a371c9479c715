#include "density/bent_places.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "support/bent_discs.h"

using namespace photon_splat;

TEST_CASE("places on a bent patch lie as its kernel does, coarse or fine, stretched or mirrored") {
  const Placement stretched{2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1.5, 0},
      mirrored{-2, 0, 0, 2, 0, 2, 0, 0, 0, 0, 2, 0}, flat{2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0.5, 0},
      elsewhere{1, 0, 0, 0, 0, 1, 0, 50, 0, 0, 1, 0};
  for (const Placement& place : {identity, stretched, mirrored, flat})
    for (int n : {10, 100}) {
      Scene scene(1);
      fill(scene, make_waves(n), {place, elsewhere});
      const Vec3 above{static_cast<float>(0.4 * place[0] + place[3]),
                       static_cast<float>(0.7 * place[5] + place[7]), 5};
      for (const bool below : {false, true}) {
        Surface s;
        REQUIRE(scene.intersect(below ? above - Vec3{0, 0, 10} : above, {0, 0, below ? 1.f : -1.f},
                                0, 100, true, s));
        const float h = 0.4f;
        double mass = 0, drawn = 0;
        Vec3 mean, found;
        const Vec3 front = below ? -s.ng : s.ng;
        sum_over_disc(scene, s.instance, s.position, front, h, 800 / n,
                      [&](const Vec3& y, double d2, double part) {
                        const double kernel = part * std::max(0.0, 1 - d2);
                        mass += kernel;
                        mean += (y - s.position) * static_cast<float>(kernel);
                      });
        const BentPlaces places(scene, s.instance, s.triangle, s.position, s.ng, h);
        Random random(7, 3);
        for (int i = 0; i < 200000; ++i) {
          BentPlaces::Place y;
          if (!places.draw(random, y)) continue;
          REQUIRE(dot(y.normal, s.ng) > 0);
          REQUIRE(y.distance2 < 1);
          drawn += y.weight;
          found += (y.position - s.position) * y.weight;
        }
        const Vec3 off = found / static_cast<float>(drawn) - mean / static_cast<float>(mass);
        CAPTURE(n);
        CHECK(length(off) < 0.005f * h);
      }
    }
}
