#include "media/media.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr uint32_t kSamples = 1 << 16;
const CancelFlag kNever;

Program scattering(float coefficient, float g = 0, Rgb color = {1, 1, 1}) {
  ProgramWriter w;
  w.emit(nodes::Op::VolumeScatter, {{"weight", w.constant({1})},
                                    {"color", w.constant({color.x, color.y, color.z})},
                                    {"density", w.constant({coefficient})},
                                    {"anisotropy", w.constant({g})}});
  w.emit(nodes::Op::End, {});
  return w.program();
}

// A coefficient that grows with x: `slope` times it.
Program growing(float slope) {
  ProgramWriter w;
  const uint32_t place = w.reg(), density = w.reg(1);
  w.emit(nodes::Op::Geometry, {{"out", place}});
  w.emit(nodes::Op::Multiply, {{"out", density}, {"a", place}, {"b", w.constant({slope})}});
  w.emit(nodes::Op::VolumeScatter,
         {{"weight", w.constant({1})}, {"color", w.constant({1, 1, 1})}, {"density", density}});
  w.emit(nodes::Op::End, {});
  return w.program();
}

// A cube [0, 1]^3 of a medium behind a surface that lets everything pass.
void fill(Scene& scene, const Program& medium) {
  add_cube_of(scene, medium);
  scene.add_instance(0, identity, {0});
  for (const Program& program : scene.programs) check_program(scene, program);
  scene.build(kNever);
}

// Means over many flights of 1 m along x: of what comes through, and of what scatters, in units of
// the scattering coefficient.
struct Means {
  double passed = 0, scattered = 0;
};
Means fly(const Scene& scene, const Vec3& origin, const Vec3& direction, float far) {
  const MediumStack stack = scene.media()->around(origin);
  Means sum;
  Random random(7, 1);
  for (uint32_t i = 0; i < kSamples; ++i) {
    const Flight f =
        scene.media()->fly(stack, origin, direction, 0, far, {1, 1, 1}, {1, 1, 1}, {}, random);
    if (f.scatters)
      sum.scattered += double(average(f.weight * f.point.scattering)) / kSamples;
    else
      sum.passed += double(average(f.weight)) / kSamples;
  }
  return sum;
}

double transmitted(const Scene& scene, const Vec3& origin, const Vec3& direction, float far) {
  const MediumStack stack = scene.media()->around(origin);
  double sum = 0;
  Random random(3, 1);
  for (uint32_t i = 0; i < kSamples; ++i)
    sum += double(average(
               scene.media()->transmittance(stack, origin, direction, 0, far, {}, random))) /
           kSamples;
  return sum;
}

}  // namespace

TEST_CASE("phase functions send everything somewhere, and samples follow their densities") {
  const MieFit small = fit_mie(1), fog = fit_mie(4), drops = fit_mie(20), tiny = fit_mie(0.05f);
  const Phase phases[] = {{PhaseKind::kHenyeyGreenstein, 0, 0},
                          {PhaseKind::kHenyeyGreenstein, 0.8f, 0},
                          {PhaseKind::kHenyeyGreenstein, -0.5f, 0},
                          {PhaseKind::kRayleigh, 0, 0},
                          {PhaseKind::kDraine, 0.5f, 2},
                          small.first,
                          small.second,
                          fog.second,
                          drops.second,
                          tiny.second};
  for (const Phase& phase : phases) {
    CAPTURE(phase.g);
    CAPTURE(phase.alpha);
    double all = 0, density = 0, mean = 0, sampled = 0, weighed = 0;
    for (uint32_t i = 0; i < kSamples; ++i) {
      const float cosine = -1 + (2 * float(i) + 1) / float(kSamples);
      all += double(phase.evaluate(cosine)) * 4 * double(kPi) / kSamples;
      density += double(phase.pdf(cosine)) * 4 * double(kPi) / kSamples;
      mean += double(cosine * phase.evaluate(cosine)) * 4 * double(kPi) / kSamples;
      const float drawn = phase.sample_cosine((float(i) + 0.5f) / float(kSamples));
      REQUIRE(std::abs(drawn) <= 1);
      weighed += double(phase.evaluate(drawn) / phase.pdf(drawn)) / kSamples;
      sampled += double(drawn * phase.evaluate(drawn) / phase.pdf(drawn)) / kSamples;
    }
    CHECK(all == approx(1).epsilon(2e-3));
    CHECK(density == approx(1).epsilon(2e-3));
    CHECK(weighed == approx(1).epsilon(2e-3));
    CHECK(sampled == approx(mean).epsilon(2e-3));
  }
  CHECK(Phase{PhaseKind::kHenyeyGreenstein, NAN, 0}.evaluate(0.3f) == approx(1 / (4 * kPi)));
}

TEST_CASE(
    "particles in water send as much backwards as they are said to, and follow their density") {
  const float cases[][2] = {
      {1.33f, 0.1f}, {1.05f, 0.02f}, {1.1f, 0.4f}, {2, 0.05f}, {1.8165f, 0.3f}};
  for (const auto& [index, backwards] : cases) {
    CAPTURE(index);
    CAPTURE(backwards);
    const Phase phase{PhaseKind::kFournierForand, index, backwards};
    for (const float least : {0.5f, 0.1f, 0.01f}) {  // sin^2 of half the angle
      double share = 0, drawn = 0;
      for (uint32_t i = 0; i < kSamples; ++i) {
        const double u = (i + 0.5) / kSamples, t = double(least) * std::pow(1 / double(least), u);
        share += phase.evaluate(float(1 - 2 * t)) * 4 * double(kPi) * t *
                 std::log(1 / double(least)) / kSamples;
        const float cosine = phase.sample_cosine(float(u));
        REQUIRE(std::abs(cosine) <= 1);
        CHECK(phase.pdf(cosine) == phase.evaluate(cosine));
        drawn += cosine < 1 - 2 * least ? 1.0 / kSamples : 0;
      }
      if (least == 0.5f) CHECK(drawn == approx(backwards).epsilon(2e-3));
      CHECK(share == approx(drawn).epsilon(2e-3));
    }
  }
  CHECK(std::isfinite(Phase{PhaseKind::kFournierForand, NAN, NAN}.evaluate(0.3f)));
  CHECK(std::isfinite(Phase{PhaseKind::kFournierForand, 1.33f, 0.1f}.evaluate(1)));
}

TEST_CASE("light fades by Beer and Lambert's law, drawn or computed") {
  Scene scene(1);
  fill(scene, scattering(2, 0, {1, 0.5f, 0}));
  const Rgb through =
      scene.media()->transmittance(scene.media()->around({0.5f, 0.5f, 0.5f}), {0.5f, 0.5f, 0.5f},
                                   {1, 0, 0}, 0, 0.4f, {}, *std::make_unique<Random>(1, 1));
  CHECK(through.x == approx(std::exp(-0.8)));
  CHECK(through.y == approx(std::exp(-0.4)));
  CHECK(through.z == 1);
  const Means means = fly(scene, {0.1f, 0.5f, 0.5f}, {1, 0, 0}, 0.8f);
  const double passed = (std::exp(-1.6) + std::exp(-0.8) + 1) / 3;
  CHECK(means.passed == approx(passed).epsilon(0.01));
  CHECK(means.scattered == approx(1 - passed).epsilon(0.01));
}

TEST_CASE("the same where the medium changes from place to place") {
  Scene scene(1);
  fill(scene, growing(3));  // an optical depth of 1.5 (b^2 - a^2)
  const double passed = std::exp(-1.5 * (0.81 - 0.01));
  CHECK(transmitted(scene, {0.1f, 0.5f, 0.5f}, {1, 0, 0}, 0.8f) == approx(passed).epsilon(0.01));
  CHECK(transmitted(scene, {0.9f, 0.5f, 0.5f}, {-1, 0, 0}, 0.8f) == approx(passed).epsilon(0.01));
  const Means means = fly(scene, {0.1f, 0.5f, 0.5f}, {1, 0, 0}, 0.8f);
  CHECK(means.passed == approx(passed).epsilon(0.01));
  CHECK(means.scattered == approx(1 - passed).epsilon(0.01));
}

TEST_CASE("shadow rays cross media that they enter and leave") {
  Scene scene(1);
  fill(scene, scattering(0.7f));
  Random random(1, 1);
  const auto through = [&](const Vec3& origin, const Vec3& direction, float far) {
    return scene
        .transmittance(origin, direction, far, {}, ~uint64_t{0}, scene.media()->around(origin),
                       random)
        .x;
  };
  CHECK(through({-1, 0.5f, 0.4f}, {1, 0, 0}, 5) == approx(std::exp(-0.7)));
  CHECK(through({-1, 0.5f, 0.4f}, {1, 0, 0}, 1.5f) == approx(std::exp(-0.35)));
  CHECK(through({0.25f, 0.5f, 0.4f}, {1, 0, 0}, 5) == approx(std::exp(-0.525)));
  CHECK(through({-1, 0.5f, 0.4f}, {-1, 0, 0}, 5) == 1);
}

TEST_CASE("rays through an edge are in the medium where they go on into it, and not past its rim") {
  Scene scene(1);
  fill(scene, scattering(0.7f));
  Random random(5, 1);
  int past_rim = 0, into = 0;
  for (uint32_t i = 0; i < kSamples; ++i) {  // the edge at y = z = 0
    const Vec3 edge{0.1f + 0.8f * random.next(), 0, 0};
    const float x = 2 * random.next() - 1, y = 0.1f + random.next(), z = 0.1f + random.next();
    const auto through = [&](const Vec3& direction) {
      const Vec3 origin = edge - direction * (1 + 3 * random.next());
      return scene
          .transmittance(origin, direction, 1e4f, {}, ~uint64_t{0}, scene.media()->around(origin),
                         random)
          .x;
    };
    past_rim += through(normalize({x, y, -z})) < 0.999f;
    const float passed = through(normalize({x, y, z}));
    into += passed > 0.999f || passed < 0.25f;
  }
  CHECK(past_rim == 0);
  CHECK(into == 0);
}

TEST_CASE("a path leaves one medium and enters another where their surfaces lie in each other") {
  Scene scene(1);
  add_cube_of(scene, scattering(1));
  scene.programs.push_back(scattering(2));
  Material other = scene.materials[0];
  other.volume = 2;
  scene.materials.push_back(other);
  scene.add_instance(0, identity, {0});
  scene.add_instance(0, {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0}, {1});
  scene.add_instance(0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1}, {1});
  scene.build(kNever);
  const Media& media = *scene.media();
  const auto extinction = [&](const MediumStack& stack) {
    return media.at(stack, {}, {0, 0, 1}, {}).extinction().x;
  };
  CHECK(extinction(media.around({0.3f, 0.4f, 0.5f})) == approx(1));
  CHECK(extinction(media.around({1.3f, 0.4f, 0.5f})) == approx(2));
  CHECK(extinction(media.around({0.3f, 0.4f, 1.5f})) == approx(2));
  CHECK(media.around({1.3f, 0.4f, 1.5f}).empty());
  const struct {
    Vec3 from, way;
    float before, after;
  } ways[] = {{{0.3f, 0.4f, 0.5f}, {1, 0, 0}, 1, 2},
              {{1.3f, 0.4f, 0.5f}, {-1, 0, 0}, 2, 1},
              {{0.3f, 0.4f, 0.5f}, {0, 0, 1}, 1, 2},
              {{0.3f, 0.4f, 1.5f}, {0.1f, -0.1f, -1}, 2, 1}};
  for (const auto& [from, way, before, after] : ways) {
    const Vec3 direction = normalize(way);
    MediumStack stack = media.around(from), beside = stack;
    CHECK(extinction(stack) == approx(before));
    Surface s;
    REQUIRE(scene.intersect(from, direction, 0, INFINITY, false, s));
    media.cross(stack, s, gap_at(s, from, direction), kShutterCentre);
    CHECK(extinction(stack) == approx(after));
    media.cross(beside, s, gap_beside(s, direction), kShutterCentre);
    CHECK(extinction(beside) == approx(after));
  }
}

TEST_CASE("a point knows the media around it") {
  Scene scene(1);
  fill(scene, scattering(1));
  CHECK(!scene.media()->around({0.5f, 0.5f, 0.5f}).empty());
  CHECK(scene.media()->around({0.5f, 0.5f, 1.5f}).empty());
  CHECK(scene.media()->around({0.5f, 0.45f, -1.5f}).empty());
}

TEST_CASE("absurd media end light and nothing else") {
  for (const float coefficient : {1e12f, INFINITY, NAN, -3.0f, 0.0f}) {
    CAPTURE(coefficient);
    Scene scene(1);
    fill(scene, scattering(coefficient));
    const Means means = fly(scene, {0.1f, 0.5f, 0.5f}, {1, 0, 0}, 0.8f);
    CHECK(means.passed + means.scattered == approx(1).epsilon(0.01));
    Scene uneven(1);
    fill(uneven, growing(coefficient));
    const double sum = transmitted(uneven, {0.1f, 0.5f, 0.5f}, {1, 0, 0}, 0.8f);
    CHECK((sum >= 0 && sum <= 1.0001));
  }
}

TEST_CASE("media are entered once, left once, and no more of them than there is room for") {
  MediumStack stack;
  stack.cross(3, false);
  stack.cross(3, false);
  stack.cross(-1, false);
  stack.cross(3, true);
  CHECK(stack.empty());
  stack.cross(5, true);
  CHECK(stack.empty());
  for (int i = 0; i < 20; ++i) stack.cross(i, false);
  CHECK(stack.end() - stack.begin() == MediumStack::kMost);
  stack.cross(2, true);
  CHECK(!stack.holds(2));
  CHECK(stack.holds(6));
}
