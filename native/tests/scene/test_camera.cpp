#include "scene/camera.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include <stdexcept>

using namespace photon_splat;

namespace {

CameraSettings settings_of(int width = 8, int height = 8) {
  CameraSettings s;
  s.width = s.region_width = width;
  s.height = s.region_height = height;
  s.clip_start = 0.5f;
  s.clip_end = 50;
  s.filter = FilterKind::kBox;
  s.filter_width = 1;
  return s;
}

PanoramaSettings panorama_of(PanoramaKind kind) {
  PanoramaSettings p;
  p.kind = kind;
  p.polynomial = {0, -0.03f, 0, 0, 0};
  return p;
}

void check_direction(const std::optional<Vec3>& is, const Vec3& should) {
  REQUIRE(is);
  CHECK(length(*is - normalize(should)) < 1e-5f);
}

constexpr PanoramaKind kAll[] = {
    PanoramaKind::kEquirectangular,   PanoramaKind::kEquiangularCubeFace,
    PanoramaKind::kMirrorBall,        PanoramaKind::kFisheyeEquidistant,
    PanoramaKind::kFisheyeEquisolid,  PanoramaKind::kFisheyePolynomial,
    PanoramaKind::kCentralCylindrical};

}  // namespace

TEST_CASE("every panorama looks along the viewing axis at its centre and gives unit directions") {
  for (const PanoramaKind kind : kAll) {
    const PanoramaSettings p = panorama_of(kind);
    check_direction(panorama_direction(p, 0.5f, 0.5f), {0, 0, -1});
    for (float u = -0.05f; u < 1.1f; u += 0.05f)
      for (float v = -0.05f; v < 1.1f; v += 0.05f)
        if (const auto d = panorama_direction(p, u, v))
          CHECK(length(*d) == approx(1).epsilon(1e-5));
    // Right is right and up is up.
    CHECK(panorama_direction(p, 0.6f, 0.5f)->x > 0);
    CHECK(panorama_direction(p, 0.5f, 0.6f)->y > 0);
  }
}

TEST_CASE("every panorama finds the place of a direction that it shows") {
  for (const PanoramaKind kind : kAll) {
    const PanoramaSettings p = panorama_of(kind);
    for (float u = 0.15f; u < 0.9f; u += 0.1f)
      for (float v = 0.15f; v < 0.9f; v += 0.1f)
        if (const auto d = panorama_direction(p, u, v)) {
          const Vec2 place = panorama_place(p, *d);
          CHECK(place.x == approx(u).epsilon(1e-4));
          CHECK(place.y == approx(v).epsilon(1e-4));
        }
  }
}

TEST_CASE("places of known direction on each panorama") {
  check_direction(panorama_direction(panorama_of(PanoramaKind::kEquirectangular), 0.75f, 0.5f),
                  {1, 0, 0});
  check_direction(panorama_direction(panorama_of(PanoramaKind::kEquirectangular), 0.3f, 1),
                  {0, 1, 0});
  check_direction(panorama_direction(panorama_of(PanoramaKind::kEquiangularCubeFace), 1, 0),
                  {1, -1, -1});
  check_direction(panorama_direction(panorama_of(PanoramaKind::kMirrorBall), 1, 0.5f), {0, 0, 1});
  check_direction(panorama_direction(panorama_of(PanoramaKind::kFisheyeEquidistant), 1, 0.5f),
                  {1, 0, 0});
  check_direction(panorama_direction(panorama_of(PanoramaKind::kCentralCylindrical), 0.75f, 1),
                  {1, 1, 0});
  CHECK_FALSE(panorama_direction(panorama_of(PanoramaKind::kFisheyeEquidistant), 0.9f, 0.9f));
  CHECK_FALSE(panorama_direction(panorama_of(PanoramaKind::kMirrorBall), 0.9f, 0.9f));
  PanoramaSettings equisolid = panorama_of(PanoramaKind::kFisheyeEquisolid);
  equisolid.focal_length = 10;
  equisolid.fov = 2.001f;
  const float edge = 20 * std::sin(0.5f) / 36;  // 1 radian off the axis: r = 2 f sin(angle / 2)
  check_direction(panorama_direction(equisolid, 0.5f, 0.5f + edge),
                  {0, std::sin(1.0f), -std::cos(1.0f)});
  CHECK_FALSE(panorama_direction(equisolid, 0.5f, 0.5f + edge * 1.01f));
}

TEST_CASE(
    "an aperture blurs nothing at the distance of focus and by the thin lens' circle elsewhere") {
  for (const bool orthographic : {false, true}) {
    CameraSettings s = settings_of();
    s.orthographic = orthographic;
    s.aperture = {0.1f, 4, 0, 0, 1};
    const Camera camera(s);
    CameraSettings sharp = s;
    sharp.aperture.radius = 0;
    const Camera pinhole(sharp);
    float widest = 0;
    for (uint32_t i = 0; i < 256; ++i) {
      const Vec2 u = sobol_2d(i, 0, 3), lens = sobol_2d(i, 1, 3);
      const auto through = camera.ray(6, 2, u, lens), centre = pinhole.ray(6, 2, u, lens);
      REQUIRE(through);
      CHECK(length(through->direction) == approx(1).epsilon(1e-5));
      const float clips_by = orthographic ? through->cosine : centre->cosine;
      CHECK(through->near * clips_by == approx(0.5).epsilon(1e-4));
      CHECK(through->far - through->near ==
            approx(49.5 / (orthographic ? 1.0 : double(clips_by))).epsilon(1e-4));
      CHECK(through->cosine == approx(-through->direction.z).epsilon(1e-5));
      const auto at_depth = [](const CameraRay& r, float depth) {
        return r.origin + r.direction * (depth / r.cosine);
      };
      CHECK(length(at_depth(*through, 4) - at_depth(*centre, 4)) < 1e-5f);
      widest = std::max(widest, length(at_depth(*through, 8) - at_depth(*centre, 8)));
    }
    // As far behind the focus as the lens is before it
    CHECK(widest == approx(0.1).epsilon(0.05));
    CHECK(widest <= 0.1001f);
  }
}

TEST_CASE("an aperture of blades is its regular polygon, uniformly filled") {
  CameraSettings s = settings_of();
  s.aperture = {1, 1e6f, 4, 0.3f, 2};
  const Camera camera(s);
  double area = 0, moment = 0;
  constexpr int count = 4096;
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3 p = camera.ray(4, 4, {0.5f, 0.5f}, sobol_2d(i, 1, 3))->origin;
    const float x = p.x * 2, y = p.y;  // the ratio undone
    const float c = std::cos(0.3f), n = std::sin(0.3f), a = c * x + n * y, b = -n * x + c * y;
    CHECK(std::max(std::abs(a), std::abs(b)) <= std::sqrt(0.5f) + 1e-5f);
    area += std::abs(a) < 0.25f && std::abs(b) < 0.25f;
    moment += a * a;
  }
  CHECK(area / count == approx(0.25 / 2).epsilon(0.02));  // a square of side sqrt 2
  CHECK(moment / count == approx(2.0 / 12).epsilon(0.02));
}

TEST_CASE(
    "a panorama's depth is distance, its footprint an angle, and its lens focuses at that distance") {
  for (const PanoramaKind kind : kAll) {
    CameraSettings s = settings_of(64, 64);
    s.left = s.bottom = 0;
    s.panorama = panorama_of(kind);
    s.aperture = {0.05f, 2, 5, 0, 1};
    const Camera camera(s);
    CameraSettings sharp = s;
    sharp.aperture.radius = 0;
    for (uint32_t i = 0; i < 64; ++i) {
      const Vec2 u = sobol_2d(i, 0, 3), lens = sobol_2d(i, 1, 3);
      const auto ray = camera.ray(20, 40, u, lens), centre = Camera(sharp).ray(20, 40, u, lens);
      REQUIRE(ray.has_value() == centre.has_value());
      if (!ray) continue;
      CHECK(ray->cosine == 1);
      CHECK(ray->near == 0.5f);
      CHECK(ray->footprint > 0.01f);
      CHECK(ray->footprint < 0.2f);
      CHECK(length(ray->origin) <= 0.0501f);
      const Vec3 to_focus = centre->direction * 2 - ray->origin;
      CHECK(length(normalize(to_focus) - ray->direction) < 1e-5f);
    }
  }
}

TEST_CASE("rays of two eyes stand to either side and meet at the distance of convergence") {
  CameraSettings s = settings_of(64, 32);
  s.left = s.bottom = 0, s.right = s.top = 1;
  s.panorama = panorama_of(PanoramaKind::kEquirectangular);
  s.to_world = {{1, 0, 0, 3, 0, 1, 0, 4, 0, 0, 1, 5}};
  const Vec2 middle{0.5f, 0.5f};
  const auto seen = [&](float offset, float convergence, int x, int y) {
    s.stereo = {offset, convergence, 0.5f, 1.0f};
    return *Camera(s).ray(x, y, middle, middle);
  };
  for (const int x : {3, 20, 50}) {
    const CameraRay one = seen(0, INFINITY, x, 16), left = seen(-0.1f, INFINITY, x, 16),
                    right = seen(0.1f, INFINITY, x, 16);
    const Vec3 apart = right.origin - left.origin;
    CHECK(length(apart) == approx(0.2));
    CHECK(length(right.origin + left.origin - one.origin * 2) < 1e-5f);
    CHECK(std::abs(dot(apart, one.direction)) < 1e-6f);
    CHECK(dot(cross(apart, one.direction), Vec3{0, 1, 0}) > 0);  // to the right
    CHECK(length(left.direction - right.direction) < 1e-6f);
    const CameraRay inward = seen(-0.1f, 2, x, 16);
    const Vec3 met = one.origin + one.direction * 2;
    CHECK(length(cross(met - inward.origin, inward.direction)) < 1e-5f);
  }
  // 32 rows are 180 degrees: the eyes come together from 28 to 57 degrees above the horizon
  CHECK(length(seen(0.1f, 2, 20, 20).origin - Vec3{3, 4, 5}) == approx(0.1));
  CHECK(length(seen(0.1f, 2, 20, 23).origin - Vec3{3, 4, 5}) ==
        approx(0.1 * std::cos(0.5 * kPi * (7.5 * kPi / 32 - 0.5) / 0.5)).epsilon(0.01));
  CHECK(length(seen(0.1f, 2, 20, 30).origin - Vec3{3, 4, 5}) < 1e-6f);
}

TEST_CASE("an aperture that cannot be is refused") {
  CameraSettings s = settings_of();
  s.aperture = {0.1f, 0, 0, 0, 1};
  CHECK_THROWS_AS(Camera{s}, std::invalid_argument);
}
