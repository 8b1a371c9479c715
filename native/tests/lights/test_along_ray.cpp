// Where rays through media look for the light of near lamps.
#include <doctest/doctest.h>

#include "lights/lights.h"
#include "support/approx.h"
#include "support/meshes.h"

using namespace photon_splat;

namespace {

constexpr int kCount = 200000;

LampSettings lamp_at(LampKind kind, const Vec3& place) {
  LampSettings s;
  s.kind = kind;
  s.to_world = Affine{{1, 0, 0, place.x, 0, 1, 0, place.y, 0, 0, 1, place.z}};  // shines down
  s.strength = {10, 10, 10};
  s.radius = 0.1f;
  s.size_x = s.size_y = 0.5f;
  s.spot_size = 0.8f;
  return s;
}

struct Along {
  double integral = 0;  // of pdf over the ray, by samples of it that are uniform
  float least = INFINITY, most = -INFINITY;  // of what is drawn
};

Along look(const Lights& lights, const Vec3& origin, const Vec3& direction, float far) {
  Along out;
  Random random(1, 2);
  for (int i = 0; i < kCount; ++i) {
    const auto s = lights.sample_along(origin, direction, 0, far, random.next(), random.next());
    REQUIRE(s);
    out.least = std::min(out.least, s->distance);
    out.most = std::max(out.most, s->distance);
    const float t = far * (static_cast<float>(i) + 0.5f) / kCount;
    out.integral += double(*lights.pdf_along(origin, direction, 0, far, t)) * far / kCount;
  }
  return out;
}

}  // namespace

TEST_CASE("distances along a ray are drawn by a density that integrates to 1, within what is lit") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  const Vec3 origin{-5, 0, 1}, along{1, 0, 0};
  {
    const Lights point(scene, {lamp_at(LampKind::kPoint, {0, 0, 2})});
    const Along seen = look(point, origin, along, 10);
    CHECK(seen.integral == approx(1).epsilon(1e-3));
    CHECK(seen.least < 0.1f);
    CHECK(seen.most > 9.9f);
  }
  {  // the cone of half angle .4 from .1/sin .4 above the lamp
    const Lights spot(scene, {lamp_at(LampKind::kSpot, {0, 0, 2})});
    const Along seen = look(spot, origin, along, 10);
    const float half = (1 + 0.1f / std::sin(0.4f)) * std::tan(0.4f);
    CHECK(seen.integral == approx(1).epsilon(1e-3));
    CHECK(seen.least == approx(5 - half).epsilon(1e-3));
    CHECK(seen.most == approx(5 + half).epsilon(1e-3));
    CHECK(*spot.pdf_along(origin, along, 0, 10, 1) == 0);
    CHECK_FALSE(spot.sample_along({-5, 0, 3}, along, 0, 10, 0.5f, 0.5f));  // above it
  }
  {  // below the lamp alone
    const Vec3 up = normalize(Vec3{1, 0, 1});
    const Lights area(scene, {lamp_at(LampKind::kArea, {0, 0, 3})});
    const Along seen = look(area, {-4, 0, 0}, up, 10);
    CHECK(seen.integral == approx(1).epsilon(1e-3));
    CHECK(seen.most == approx(3 * std::sqrt(2.0f)).epsilon(1e-3));
  }
}

TEST_CASE("of many lamps rays look for the strongest") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  std::vector<LampSettings> lamps;
  for (int i = 0; i < 100; ++i) {
    lamps.push_back(lamp_at(LampKind::kPoint, {static_cast<float>(i % 10), 5, 2}));
    lamps.back().strength = Rgb{1, 1, 1} * (i == 70 ? 1000.0f : 0.01f);
  }
  lamps[70].to_world.m[3] = 0;
  lamps[70].to_world.m[7] = 0;
  const Lights lights(scene, lamps);
  int near = 0;
  Random random(1, 2);
  for (int i = 0; i < 1000; ++i) {
    const auto s = lights.sample_along({-5, 0, 1}, {1, 0, 0}, 0, 10, random.next(), random.next());
    REQUIRE(s);
    near += std::abs(s->distance - 5) < 2;
  }
  CHECK(near > 600);
}

TEST_CASE(
    "light at a place in a medium right before an area lamp is bounded by half of all directions") {
  Scene scene(1);
  fill(scene, make_grid(1, 10), {identity});
  LampSettings settings = lamp_at(LampKind::kArea, {0, 0, 3});
  const Lights lights(scene, {settings});
  Random random(3, 4);
  for (const float before : {0.3f, 1e-2f, 1e-3f}) {
    const Receiver receiver{{0.1f, 0.05f, 3 - before}, {}, true};
    double sum = 0, most = 0;
    for (int i = 0; i < kCount; ++i)
      if (const auto light =
              lights.sample(receiver, random.next(), {random.next(), random.next()})) {
        sum += light->weight.x / kCount;
        most = std::max(most, double(light->weight.x));
      }
    CHECK(most < 1.01 * sum);
    if (before < 1e-2f) CHECK(sum == approx(10 / (kPi * 0.25) * 2 * kPi).epsilon(0.02));
  }
}
