#include "bsdf/turned_glass.h"

#include "support/approx.h"

#include <doctest/doctest.h>

namespace photon_splat {
namespace {

const Vec3 kUp{0, 0, 1};

Vec3 direction(float z, float phi) {
  const float r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

// What viewers above see through glass of that normal, each as it turns for them: over the
// directions that the light then comes from, or over their own.
struct Seen {
  double by_light = 0, by_viewer = 0;
};

float looks(const Vec3& wo) { return 1 + wo.x + 0.5f * wo.y * wo.z; }

Seen seen_through(float lean, float ior) {
  const Vec3 n{std::sin(lean), 0, std::cos(lean)};
  constexpr int kSide = 200;
  Seen out;
  for (int i = 0; i < kSide * kSide; ++i) {
    const float z = (static_cast<float>(i / kSide) + 0.5f) / kSide,
                phi = 2 * kPi * (static_cast<float>(i % kSide) + 0.5f) / kSide;
    const Vec3 up = direction(z, phi);
    if (const auto way = way_through({kUp, kUp, kUp, false}, n, -up, ior))
      out.by_light += z * looks(way->to) * way->spread;
    Vec3 from;
    if (refract(up, valid_reflection({up, kUp, kUp, false}, n), ior, &from) && from.z < 0 &&
        dot(up, valid_reflection({up, kUp, kUp, false}, n)) > 0)
      out.by_viewer += z * looks(up);
  }
  return out;
}

TEST_CASE("light finds every viewer of glass whose normal turns towards them") {
  for (const float ior : {1.33f, 1 / 1.33f, 1.5f, 1 / 1.5f})
    for (const float lean : {0.0f, 0.2f, 0.5f, 0.8f, 1.1f, 1.4f, 1.8f}) {
      CAPTURE(ior);
      CAPTURE(lean);
      const Seen seen = seen_through(lean, ior);
      CHECK(seen.by_light == doctest::Approx(seen.by_viewer).epsilon(0.01));
    }
}

TEST_CASE("a normal that looks the other way sends nothing through") {
  CHECK(!way_through({kUp, kUp, kUp, false}, -kUp, -kUp, 1.5f));
  CHECK(!way_through({kUp, kUp, kUp, false}, kUp, kUp, 1.5f));
}

}  // namespace
}  // namespace photon_splat
