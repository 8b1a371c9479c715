// Which lamps a ray comes near.
#include <doctest/doctest.h>

#include <bit>

#include "lights/near_lamps.h"
#include "math/sampling.h"

using namespace photon_splat;

TEST_CASE("of few lamps rays are told all that they meet, far off too, and hardly any other") {
  Random random(1, 2);
  const auto place = [&](float size) {
    return Vec3{random.next() - 0.5f, random.next() - 0.5f, random.next() - 0.5f} * size;
  };
  for (const float size : {1e-3f, 1.0f, 1e4f}) {
    for (const float off : {0.0f, 1e3f}) {  // of all from the origin, in sizes
      const Vec3 middle = Vec3{0.6f, -0.7f, 0.4f} * (off * size);
      const float radius = 0.01f * size;
      NearLamps lamps;
      Vec3 centers[NearLamps::kMost];
      for (Vec3& center : centers) {
        center = middle + place(size);
        lamps.add(center, sqr(radius));
      }
      int found = 0;
      for (int i = 0; i < 4000; ++i) {
        const Vec3 origin = middle + place(size);
        const uint32_t k = static_cast<uint32_t>(i) % NearLamps::kMost;
        const Vec3 to = centers[k] - origin;
        const Basis beside(normalize(to));
        const float angle = 2 * kPi * random.next();
        const Vec3 rim = (beside.tangent * std::cos(angle) + beside.bitangent * std::sin(angle)) *
                         (0.9999f * radius);
        REQUIRE((lamps.met_by(origin, normalize(to + rim)) >> k & 1) == 1);
        found += std::popcount(lamps.met_by(origin, sample_sphere(random.next2())));
      }
      CHECK(found < 4000 * 32 / 100);
    }
  }
}

TEST_CASE("every ray may meet a sun, and none what no ray is to look for") {
  NearLamps lamps;
  lamps.add({}, INFINITY);
  lamps.add({1, 0, 0}, -1);
  CHECK(lamps.met_by({0, 0, -5}, {0, 0, 1}) == 1);
  CHECK(lamps.met_by({0, 0, 0}, {1, 0, 0}) == 1);
}
