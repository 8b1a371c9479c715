#include <doctest/doctest.h>

#include "math/spherical_triangle.h"
#include "support/approx.h"

using namespace photon_splat;

namespace {

Vec3 random_direction(Random& random) { return sample_sphere(random.next2()); }

// Through the triangle: on the same side of the three planes
bool sees(const Vec3& direction, const Vec3 p[3]) {
  const float side = dot(p[0], cross(p[1], p[2]));
  for (int i = 0; i < 3; ++i)
    if (dot(direction, cross(p[i], p[(i + 1) % 3])) * side < 0) return false;
  return true;
}

}  // namespace

TEST_CASE("an octant is pi/2; solid angles of random triangles agree with counting directions") {
  CHECK(SphericalTriangle({1, 0, 0}, {0, 3, 0}, {0, 0, 2}).solid_angle() ==
        approx(kPi / 2).epsilon(1e-5));
  Random random(1, 2);
  for (int n = 0; n < 20; ++n) {
    const Vec3 p[3] = {random_direction(random), random_direction(random),
                       random_direction(random)};
    int inside = 0;
    const int count = 40000;
    for (int i = 0; i < count; ++i) inside += sees(random_direction(random), p);
    CHECK(SphericalTriangle(p[0], p[1], p[2]).solid_angle() ==
          approx(4 * kPi * inside / count).epsilon(0.05).scale(0.5));
  }
}

TEST_CASE("directions are even over the solid angle: the parts of a triangle get their shares") {
  Random random(3, 4);
  for (int n = 0; n < 60; ++n) {
    const float size = n % 3 == 0 ? 1.0f : n % 3 == 1 ? 0.2f : 0.04f;
    const Vec3 centre = random_direction(random);
    Vec3 p[3];
    for (Vec3& corner : p)
      corner = (centre + random_direction(random) * size) * (0.2f + 5 * random.next());
    const SphericalTriangle whole(p[0], p[1], p[2]);
    if (whole.solid_angle() < 5e-3f) continue;  // smaller ones lose digits
    const float s = random.next();
    const Vec3 middle = normalize(p[0]) * s + normalize(p[1]) * (1 - s);
    const Vec3 part[3] = {p[0], middle, p[2]};
    const float share =
        SphericalTriangle(part[0], part[1], part[2]).solid_angle() / whole.solid_angle();
    int inside = 0, outside = 0;
    const int count = 20000;
    for (int i = 0; i < count; ++i) {
      const Vec3 direction = whole.sample(random.next2());
      CHECK(length(direction) == approx(1).epsilon(1e-4));
      inside += sees(direction, part);
      outside += !sees(direction, p);
    }
    CHECK(outside < count / 200);  // only by rounding, at the rim
    CHECK(double(inside) / count == approx(share).epsilon(0.04).scale(0.5));
  }
}

TEST_CASE(
    "degenerate triangles have no solid angle or a finite one, and their samples are finite") {
  const Vec3 hostile[][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                             {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
                             {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                             {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}},
                             {{1e-30f, 0, 0}, {0, 1e30f, 0}, {0, 0, 1}}};
  for (const auto& p : hostile) {
    const SphericalTriangle t(p[0], p[1], p[2]);
    CHECK(std::isfinite(t.solid_angle()));
    if (t.solid_angle() > 0) CHECK(is_finite(t.sample({0.3f, 0.7f})));
  }
}
