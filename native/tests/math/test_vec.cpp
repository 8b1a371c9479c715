#include "math/vec.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <stdexcept>
#include <vector>

#include "math/sampling.h"

using namespace photon_splat;

TEST_CASE("a basis is orthonormal and right-handed for every normal, poles included") {
  std::vector<Vec3> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  for (uint32_t i = 0; i < 500; ++i) normals.push_back(normalize(sample_sphere(sobol_2d(i, 0, 3))));
  for (const Vec3& n : normals) {
    const Basis basis(n);
    CHECK(std::abs(dot(basis.tangent, basis.bitangent)) < 1e-6f);
    CHECK(std::abs(dot(basis.tangent, n)) < 1e-6f);
    CHECK(length(basis.tangent) == approx(1));
    CHECK(length(cross(basis.tangent, basis.bitangent) - n) < 1e-6f);
    CHECK(length(basis.to_world({0, 0, 1}) - n) < 1e-6f);
  }
}

// Half a step in both coordinates, 1/254 each, is stretched by up to sqrt(18) in the middle of a
// face.
TEST_CASE("packed directions come back within about a degree, axes exactly") {
  std::vector<Vec3> directions{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (uint32_t i = 0; i < 2000; ++i)
    directions.push_back(normalize(sample_sphere(sobol_2d(i, 1, 9))));
  for (const Vec3& d : directions)
    CHECK(length(decode_direction(encode_direction(d)) - d) < 0.018f);
  for (int i = 0; i < 6; ++i)
    CHECK(length(decode_direction(encode_direction(directions[i])) - directions[i]) < 1e-6f);
}

TEST_CASE("an inverse transform undoes points, vectors and normals") {
  const Affine a{{2, 0.5f, 0, 10, 0, -1, 3, -20, 0.25f, 0, 1, 5}};
  const Affine back = inverse(a);
  const Vec3 p{1, 2, 3}, q{0.5f, -1, 2};
  CHECK(length(back.point(a.point(p)) - p) < 1e-5f);
  CHECK(length(back.vector(a.vector(p)) - p) < 1e-5f);
  // A normal stays perpendicular to what it was perpendicular to.
  const Vec3 normal = cross(p, q);
  CHECK(std::abs(dot(normalize(back.transposed_vector(normal)), normalize(a.vector(p)))) < 1e-5f);
  CHECK(determinant(a) == approx(2 * (-1) * 1 + 0.5 * 3 * 0.25));
}

TEST_CASE("a singular transform has no inverse") {
  CHECK_THROWS_AS(inverse(Affine{{1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0}}), std::invalid_argument);
}
