#include "math/sampling.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <set>

using namespace photon_splat;

namespace {

// Means of f over a scrambled Sobol' set: exact to about 1/n for smooth f.
template <class F>
double mean_over_square(F&& f) {
  constexpr uint32_t count = 1 << 14;
  double sum = 0;
  for (uint32_t i = 0; i < count; ++i) sum += f(sobol_2d(i, 0, 1));
  return sum / count;
}

}  // namespace

TEST_CASE("the first 2^m points of each pair of dimensions are a (0, m, 2)-net") {
  constexpr int m = 8, count = 1 << m;
  for (uint32_t dimension : {0u, 1u, 17u})
    for (uint32_t seed : {0u, 5u})
      for (int bits_x = 0; bits_x <= m; ++bits_x) {
        std::set<std::pair<int, int>> cells;
        for (uint32_t i = 0; i < count; ++i) {
          const Vec2 p = sobol_2d(i, dimension, seed);
          REQUIRE(p.x >= 0);
          REQUIRE(p.x < 1);
          REQUIRE(p.y >= 0);
          REQUIRE(p.y < 1);
          cells.insert({int(p.x * float(1 << bits_x)), int(p.y * float(1 << (m - bits_x)))});
        }
        CHECK(cells.size() == count);
      }
}

TEST_CASE("runs of points are the points one by one, on every instruction set") {
  const SobolPair pair(3, 77);
  SobolPair::Run run;
  pair.fill(5, 33, run);
  for (uint32_t k = 0; k < 33; ++k)
    CHECK((run.x[k] == pair.at(5 + k).x && run.y[k] == pair.at(5 + k).y));
  for (const char* name : {"generic", "sse42", "avx2", "avx512"}) {
    const SobolKernel kernel = choose_sobol_kernel(name);
    if (!kernel) continue;  // not on this machine
    CAPTURE(name);
    const SobolKeys keys{0x12345u, 0x9876543u, 0xfedcba98u};
    SobolPair::Run plain, vectors;
    for (const uint32_t first : {0u, 4000000000u, ~0u - 20u}) {
      sobol_generic(keys, first, SobolPair::kMost, plain.x, plain.y);
      kernel(keys, first, SobolPair::kMost, vectors.x, vectors.y);
      for (uint32_t k = 0; k < SobolPair::kMost; ++k)
        CHECK((plain.x[k] == vectors.x[k] && plain.y[k] == vectors.y[k]));
    }
  }
}

TEST_CASE("random streams of neighbouring indices and seeds are uniform and independent") {
  constexpr int count = 20000;
  for (uint32_t seed : {0u, 1u}) {
    double sum = 0, squares = 0, product = 0;
    for (uint64_t i = 0; i < count; ++i) {
      const float a = Random(i, seed).next(), b = Random(i + 1, seed).next();
      REQUIRE(a >= 0);
      REQUIRE(a < 1);
      sum += a;
      squares += double(a) * a;
      product += (a - 0.5) * (b - 0.5);
    }
    CHECK(sum / count == approx(0.5).epsilon(0.02));
    CHECK(squares / count == approx(1.0 / 3).epsilon(0.02));
    CHECK(std::abs(product / count) < 4.0 / 12 / std::sqrt(count));
  }
}

TEST_CASE("the disc map is uniform in area and stays in the disc") {
  CHECK(mean_over_square([](Vec2 u) {
          const Vec2 d = sample_disk(u);
          return d.x * d.x + d.y * d.y;
        }) == approx(0.5).epsilon(1e-3));
  CHECK(mean_over_square([](Vec2 u) { return sample_disk(u).x; }) ==
        approx(0).epsilon(1e-3).scale(1));
  CHECK(mean_over_square([](Vec2 u) {
          const Vec2 d = sample_disk(u);
          return d.x * d.x + d.y * d.y > 1.000001f;
        }) == 0);
}

TEST_CASE("the cosine-weighted hemisphere has the moments of cos/pi") {
  const auto z = [](Vec2 u) { return double(sample_cosine_hemisphere(u).z); };
  CHECK(mean_over_square(z) == approx(2.0 / 3).epsilon(1e-3));
  CHECK(mean_over_square([&](Vec2 u) { return z(u) * z(u); }) == approx(0.5).epsilon(1e-3));
}

TEST_CASE("the sphere is uniform") {
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(std::abs(mean_over_square([&](Vec2 u) { return double(sample_sphere(u)[axis]); })) <
          1e-3);
    CHECK(mean_over_square([&](Vec2 u) { return std::pow(double(sample_sphere(u)[axis]), 2); }) ==
          approx(1.0 / 3).epsilon(1e-3));
  }
}

TEST_CASE("cones are uniform in solid angle, hemispheres and tiny ones alike") {
  for (float one_minus_cos : {1.0f, 0.1f, 1e-8f}) {
    const auto drop = [&](Vec2 u) {  // 1 - cos, from the sine: exact where 1 - z is not
      const Vec3 d = sample_cone(u, one_minus_cos);
      const double sine2 = double(d.x) * d.x + double(d.y) * d.y;
      return sine2 / (1 + d.z);
    };
    CHECK(mean_over_square(drop) == approx(one_minus_cos / 2).epsilon(1e-3));
    CHECK(mean_over_square([&](Vec2 u) { return drop(u) > one_minus_cos * 1.00001; }) == 0);
  }
}

TEST_CASE("cosines and sines by series are the library's to the last bits") {
  for (int i = 0; i <= 1 << 16; ++i) {
    const float turn = static_cast<float>(i) / (1 << 16);
    const double angle = 6.283185307179586 * static_cast<double>(turn);
    const Vec2 v = cos_sin_of_turn(turn), octant = cos_sin_of_octant(kPi / 4 * (2 * turn - 1));
    CHECK(std::abs(v.x - std::cos(angle)) < 1.5e-7);
    CHECK(std::abs(v.y - std::sin(angle)) < 1.5e-7);
    CHECK(std::abs(octant.x - std::cos(0.7853981633974483 * (2.0 * turn - 1))) < 1.5e-7);
    CHECK(std::abs(octant.y - std::sin(0.7853981633974483 * (2.0 * turn - 1))) < 1.5e-7);
  }
}

TEST_CASE("turn_of is atan2 over a full turn, in every octant and on the axes") {
  Random random(8, 9);
  for (int i = 0; i < 100000; ++i) {
    const Vec2 p{2 * random.next() - 1, 2 * random.next() - 1};
    const float scale = i % 3 == 0 ? 1 : i % 3 == 1 ? 1e-12f : 1e12f, thin = i % 2 ? 1 : 1e-5f;
    const double turn =
        std::atan2(double(p.y * scale * thin), double(p.x * scale)) / (2 * double(kPi));
    REQUIRE(std::abs(turn_of(p.y * scale * thin, p.x * scale) - turn) < 7e-8);
  }
  CHECK(turn_of(0, 1) == 0);
  CHECK(turn_of(1, 0) == approx(0.25f));
  CHECK(turn_of(-1, 0) == approx(-0.25f));
  CHECK(turn_of(0, -1) == approx(0.5f));
  CHECK(turn_of(-0.0f, -1) == approx(-0.5f));
  CHECK(std::abs(turn_of(0, 0)) <= 0.5f);
}
