#include "density/kernel_mass.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "support/meshes.h"

using namespace photon_splat;

namespace {

// The mass by its definition: the kernel summed over a fine grid of the disc.
template <class Inside>
double summed_mass(const Vec3& x, float h, Inside&& inside) {
  constexpr int n = 2000;
  const double reach = std::min(1.0, 1.5 / double(h));  // nothing lies further off
  double sum = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double u = ((i + 0.5) / n * 2 - 1) * reach, v = ((j + 0.5) / n * 2 - 1) * reach,
                   s2 = u * u + v * v;
      if (s2 < 1 && inside(x.x + h * u, x.y + h * v)) sum += 2 / M_PI * (1 - s2);
    }
  return sum * reach * reach * 4 / (double(n) * n);
}

float mass_at(const Scene& scene, float x, float y, float h) {
  Surface s;
  REQUIRE(const_cast<Scene&>(scene).intersect({x, y, 1}, {0, 0, -1}, 0, 100, true, s));
  const KernelMass m = kernel_mass(scene, s.instance, s.triangle, s.position, s.ng, h);
  const KernelMass narrow =
      kernel_mass(scene, s.instance, s.triangle, s.position, s.ng, kNarrow * h);
  if (m.exact && narrow.exact) CHECK(m.narrow == approx(narrow.mass).epsilon(0.005));
  return m.mass;
}

// An L: the unit square without its upper right quarter.
Mesh make_l() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, .5f, 0}, {.5f, .5f, 0}, {.5f, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  return mesh;
}

}  // namespace

TEST_CASE(
    "whole inside, one half at an edge, a quarter at a corner, however the square is tessellated") {
  for (int n : {1, 8, 20}) {
    Scene scene(1);
    fill(scene, make_grid(n), {identity});
    CHECK(mass_at(scene, 0.5f, 0.5f, 0.3f) == approx(1));
    CHECK(mass_at(scene, 0.5f, 1e-5f, 0.2f) == approx(0.5).epsilon(1e-3));
    CHECK(mass_at(scene, 1e-5f, 1 - 1e-5f, 0.2f) == approx(0.25).epsilon(1e-3));
  }
}

TEST_CASE("a square smaller than the disc, seen from anywhere on it") {
  Scene scene(1);
  fill(scene, make_grid(1), {identity});
  for (uint32_t i = 0; i < 8; ++i) {
    const Vec2 u = sobol_2d(i, 0, 0);
    for (float h : {0.4f, 0.9f, 3.0f}) {
      const double expected = summed_mass(
          {u.x, u.y, 0}, h, [](double x, double y) { return x > 0 && x < 1 && y > 0 && y < 1; });
      CHECK(mass_at(scene, u.x, u.y, h) == approx(expected).epsilon(2e-3));
    }
  }
}

TEST_CASE("a concave patch") {
  Scene scene(1);
  fill(scene, make_l(), {identity});
  const auto inside = [](double x, double y) {
    return x > 0 && x < 1 && y > 0 && y < 1 && (x < 0.5 || y < 0.5);
  };
  for (const Vec2& p : {Vec2{0.45f, 0.45f}, {0.3f, 0.8f}, {0.9f, 0.1f}, {0.499f, 0.501f}})
    for (float h : {0.2f, 0.6f})
      CHECK(mass_at(scene, p.x, p.y, h) ==
            approx(summed_mass({p.x, p.y, 0}, h, inside)).epsilon(3e-3));
}

TEST_CASE("placed by a transform, mirrored or stretched, once or twice: judged in world space") {
  const auto inside = [](double x, double y) { return x > 0 && x < 2 && y > 0 && y < 1; };
  const Placement stretched{2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 3, 0},
      mirrored{-2, 0, 0, 2, 0, 1, 0, 0, 0, 0, 1, 0};
  const Placement elsewhere{1, 0, 0, 0, 0, 1, 0, 50, 0, 0, 1, 0};
  for (int n : {1, 20})
    for (const Placement& place : {stretched, mirrored})
      for (bool shared : {false, true}) {
        Scene scene(1);
        fill(scene, make_grid(n), shared ? std::vector{place, elsewhere} : std::vector{place});
        for (const Vec2& p : {Vec2{0.1f, 0.3f}, {1.95f, 0.9f}})
          CHECK(mass_at(scene, p.x, p.y, 0.5f) ==
                approx(summed_mass({p.x, p.y, 0}, 0.5f, inside)).epsilon(3e-3));
      }
}

TEST_CASE("from behind it is the same") {
  Scene scene(1);
  fill(scene, make_grid(1), {identity});
  Surface s;
  REQUIRE(scene.intersect({0.2f, 0.9f, -1}, {0, 0, 1}, 0, 10, true, s));
  CHECK(kernel_mass(scene, s.instance, s.triangle, s.position, s.ng, 0.4f).mass ==
        approx(mass_at(scene, 0.2f, 0.9f, 0.4f)));
}

TEST_CASE("a closed sphere loses nothing") {
  Scene scene(1);
  fill(scene, make_sphere(24, 48), {identity});
  CHECK(mass_at(scene, 0.3f, 0.2f, 0.25f) == 1);
  Surface s;
  REQUIRE(scene.intersect({0.3f, 0.2f, 2}, {0, 0, -1}, 0, 10, true, s));
  CHECK(curvature_radius_limit(scene, s.instance, s.triangle) == approx(0.7).epsilon(0.02));
}
