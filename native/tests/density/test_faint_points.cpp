// Of points that are faint beside other light few masses are found, and these stand for all.
#include <doctest/doctest.h>

#include "density/visible_points.h"
#include "support/approx.h"
#include "support/bent_discs.h"

using namespace photon_splat;

namespace {

constexpr float kDisc = 0.1f;  // m
constexpr uint64_t kSide = 120;

struct Found {
  double scale = 0, narrow = 0;  // sums over points
  uint64_t measured = 0;
};

// Waves all over a picture, with a photon in each disc that makes it this share of a pixel's light.
Found masses(Scene& scene, float share) {
  GatherPoints gather_points;
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const Vec2 u = sobol_2d(i, 0, 3);
    Surface s;
    REQUIRE(scene.intersect({u.x, u.y, 5}, {0, 0, -1}, 0, 100, true, s));
    gather_points.push_back({s.position,
                             s.key,
                             s.ng,
                             0.001f,
                             {1, 1, 1},
                             i,
                             s.instance,
                             s.triangle,
                             0,
                             LobeCategory::kDiffuse,
                             true,
                             false});
  }
  const CancelFlag never;
  const RadiusMap radii(scene, {}, 1, {});
  PointSettings settings;
  settings.caustics = true;
  settings.spacing = 0;
  settings.fixed_radius = kDisc;
  VisiblePoints points;
  points.build(scene, gather_points, radii, settings, 0, 1, never);
  points.correct_boundaries(scene, never);
  const float flat = 2 / (kPi * kDisc * kDisc);
  for (PointBlock& block : points.blocks())
    for (uint32_t lane = 0; lane < kBlockSize; ++lane)
      block.r[lane] = block.g[lane] = block.b[lane] = 1 / flat, block.count[lane] = 1;
  const std::vector<float> luminance(share > 0 ? gather_points.size() : 0, 1 / share);
  points.find_masses(scene, {luminance, &gather_points, 1}, never);
  Found found;
  found.measured = points.counts().measured;
  for (const PointBlock& block : points.blocks())
    for (uint32_t lane = 0; lane < kBlockSize; ++lane) {
      found.scale += block.scale[lane] / flat;
      found.narrow += block.narrow_scale[lane] / (2 * flat);
    }
  return found;
}

}  // namespace

TEST_CASE("faint points: a few masses stand for all of them; of others all are found") {
  Scene scene(2);
  fill(scene, make_waves(24), {identity});
  const Found all = masses(scene, 0);
  CHECK(all.measured == kSide * kSide);
  // Edges and waves matter
  CHECK(all.scale > 1.05 * kSide * kSide);
  CHECK(masses(scene, 0.5f).measured == all.measured);
  const Found faint = masses(scene, 1e-4f);
  CHECK(faint.measured < 0.15 * all.measured);
  CHECK(faint.measured > 0.1 * all.measured);
  CHECK(faint.scale == approx(all.scale).epsilon(0.015));
  CHECK(faint.narrow == approx(all.narrow).epsilon(0.015));
}
