#include "density/bent_mass.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "density/kernel_mass.h"
#include "support/bent_discs.h"

using namespace photon_splat;

namespace {

// The mass by its definition.
Masses summed_mass(const Scene& scene, uint32_t instance, const Vec3& x, const Vec3& normal,
                   float h, int cut) {
  Masses sum;
  sum_over_disc(scene, instance, x, normal, h, cut, [&](const Vec3&, double d2, double part) {
    sum.wide += part * std::max(0.0, 1 - d2);
    sum.narrow += 2 * part * std::max(0.0, 1 - 2 * d2);
  });
  return sum;
}

// Largest errors of both masses, relative, over some places and radii.
Masses largest_error(const Scene& scene, const Vec3& low, const Vec3& size, float unit, int cut) {
  Masses worst;
  for (uint32_t i = 0; i < 24; ++i) {
    const Vec2 u = sobol_2d(i, 0, 0);
    Surface s;
    REQUIRE(
        scene.intersect(low + Vec3{u.x * size.x, u.y * size.y, 5}, {0, 0, -1}, 0, 100, true, s));
    for (float h : {0.08f, 0.15f, 0.25f}) {
      const Masses expected = summed_mass(scene, s.instance, s.position, s.ng, h * unit, cut);
      const Masses found = bent_mass(scene, s.instance, s.triangle, s.position, s.ng, h * unit);
      worst.wide = std::max(worst.wide, std::abs(found.wide / expected.wide - 1));
      worst.narrow = std::max(worst.narrow, std::abs(found.narrow / expected.narrow - 1));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("waves, coarse or fine: the mass is that of a sum over all triangles") {
  for (int n : {10, 16, 50, 160, 320}) {
    Scene scene(1);
    fill(scene, make_waves(n), {identity});
    const Masses worst = largest_error(scene, {0, 0, 0}, {1, 1, 0}, 1, std::max(1, 800 / n));
    CAPTURE(n);
    CHECK(worst.wide < 0.005);
    CHECK(worst.narrow < 0.01);
  }
}

TEST_CASE(
    "of instances that are stretched, mirrored or turned the mass is that of the surface in the world") {
  const Placement stretched{2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1.5, 0},
      mirrored{-2, 0, 0, 2, 0, 2, 0, 0, 0, 0, 2, 0};
  const Placement sheared{2, 0.7, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0},
      elsewhere{1, 0, 0, 0, 0, 1, 0, 50, 0, 0, 1, 0};
  for (const Placement& place : {stretched, mirrored, sheared})
    for (int n : {16, 100}) {
      Scene scene(1);
      fill(scene, make_waves(n), {place, elsewhere});
      const Masses worst =
          largest_error(scene, {0.8f, 0, 0}, {1.2f, 1.9f, 0}, 2, std::max(1, 800 / n));
      CHECK(worst.wide < 0.005);
      CHECK(worst.narrow < 0.01);
    }
}

TEST_CASE("from behind it is the same") {
  Scene scene(1);
  fill(scene, make_waves(100), {identity});
  Surface s;
  REQUIRE(scene.intersect({0.3f, 0.6f, -1}, {0, 0, 1}, 0, 10, true, s));
  CHECK(bent_mass(scene, s.instance, s.triangle, s.position, s.ng, 0.2f).wide ==
        approx(summed_mass(scene, s.instance, s.position, s.ng * -1.0f, 0.2f, 8).wide)
            .epsilon(0.005));
}
