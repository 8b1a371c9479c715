// Closures against what Cycles made of them: bsdf_albedo.inc says how it was measured.
#include <doctest/doctest.h>

#include "support/bsdf_cases.h"

using namespace photon_splat;

namespace {

const Vec3 kTangent{0, 1, 0};

struct View2 {
  Vec3 wo;
  Rgb light;
};

struct Measured {
  void (*fill)(Bsdf&);
  bool lobes;  // the world's channels differ: 1, and two lobes
  std::vector<View2> views;
};

const std::vector<Measured>& measured() {
  static const std::vector<Measured> all = {
#include "bsdf/bsdf_albedo.inc"
  };
  return all;
}

Rgb world(const Vec3& w, bool lobes) {
  if (!lobes) return kWhite;
  const auto lobe = [&](const Vec3& axis) {
    return std::pow(saturate(0.5f + 0.5f * dot(w, axis)), 8.0f);
  };
  return {1, lobe(kUp), lobe(normalize({1, 0, 0.5f}))};
}

}  // namespace

TEST_CASE("closures scatter the light that they scatter in Cycles") {
  CHECK(measured().size() > 70);
  for (const Measured& m : measured())
    for (const View2& view : m.views) {
      const Vec3 n = view.wo.z < 0 ? -kUp : kUp;
      Bsdf bsdf(Transport::kRadiance, view.wo, n, n, view.wo.z < 0);
      m.fill(bsdf);
      bsdf.finish();
      constexpr int count = 1 << 13;
      double sum[3] = {};
      for (int i = 0; i < count; ++i)
        if (const auto s =
                bsdf.sample(sobol_2d(uint32_t(i), 1, 3).x, sobol_2d(uint32_t(i), 0, 3))) {
          const Rgb light = s->weight * world(s->direction, m.lobes);
          for (int k = 0; k < 3; ++k) sum[k] += double(light[k]) / count;
        }
      const Rgb straight = bsdf.transparency() * world(-view.wo, m.lobes) + bsdf.emission();
      CAPTURE(&m - measured().data());
      CAPTURE(view.wo.z);
      for (int k = 0; k < 3; ++k) {
        CAPTURE(k);
        CHECK(std::abs(sum[k] + double(straight[k] - view.light[k])) <
              0.01 * double(view.light[k]) + 0.0015);
      }
    }
}
