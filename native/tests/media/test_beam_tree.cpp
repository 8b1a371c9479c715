#include "media/beam_tree.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "media/media.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

const CancelFlag kNever;

Program scattering(float coefficient, bool grows) {
  ProgramWriter w;
  const uint32_t place = w.reg(), density = w.reg(1);
  if (grows) {  // with x
    w.emit(nodes::Op::Geometry, {{"out", place}});
    w.emit(nodes::Op::Multiply, {{"out", density}, {"a", place}, {"b", w.constant({coefficient})}});
  }
  w.emit(nodes::Op::VolumeScatter, {{"weight", w.constant({1})},
                                    {"color", w.constant({1, 1, 1})},
                                    {"density", grows ? density : w.constant({coefficient})}});
  w.emit(nodes::Op::End, {});
  return w.program();
}

// A cube [0, 1]^3 of a medium.
void fill(Scene& scene, float coefficient, bool grows = false) {
  ProgramWriter clear;
  clear.emit(nodes::Op::Transparent,
             {{"weight", clear.constant({1})}, {"color", clear.constant({1, 1, 1})}});
  clear.emit(nodes::Op::End, {});
  clear.program().features = kProgramTransparent;
  scene.programs = {clear.program(), scattering(coefficient, grows)};
  Material material;
  material.program = 0;
  material.volume = 1;
  scene.materials = {material};
  scene.meshes.push_back(padded(make_cube()));
  scene.add_instance(0, identity, {0});
  for (const Program& program : scene.programs) check_program(scene, program);
  scene.build(kNever);
}

// 1 W in `count` beams along `direction` from places spread over [0, 1]^2 at x = 0.
std::vector<PhotonBeam> sheet(const Scene& scene, uint32_t count, const Vec3& direction,
                              uint32_t seed, float slope = 0) {
  std::vector<PhotonBeam> beams;
  const uint16_t wall = encode_direction(normalize({1, slope, 0}));
  const SobolPair places(0, seed);
  for (uint32_t i = 0; i < count; ++i) {
    const Vec2 p = places.at(i);
    const Vec3 from{-slope * (p.x - 0.5f), p.x, p.y};
    beams.push_back({from, direction, 2, Rgb{1, 0.5f, 0.25f} / float(count),
                     scene.media()->around({0.5f, 0.5f, 0.5f}), wall, encode_direction(-direction),
                     int16_t{0}, 0});
  }
  return beams;
}

BeamTree tree_of(Scene& scene, const std::vector<PhotonBeam>& pilot,
                 const std::vector<PhotonBeam>& beams, float factor = 1, uint32_t looks = 1 << 20,
                 double variance = 0) {
  BeamTree tree;
  BeamTree::Settings s;
  s.middle = {0.5f, 0.5f, 0.5f};
  s.reach = 0.6f;
  s.beams_per_disc = 2;
  s.looks = looks;
  s.variance = variance;
  s.strength = [](const PhotonBeam& beam) { return luminance(beam.power); };
  s.footprint = [](const Vec3&) { return 2e-3f; };
  s.more_beams = double(beams.size()) / double(pilot.size());
  tree.learn(pilot, s);
  tree.fill(beams, *scene.media(), 1, factor, scene.pool(), kNever);
  return tree;
}

// Radiant flux per metre of what the ray meets, 1/m of W.
Rgb seen(const BeamTree& tree, const Scene& scene, const Vec3& origin, const Vec3& direction,
         float far) {
  Rgb sum{};
  Random random(1, 1);
  tree.each(tree.stack_of(scene.media()->around({0.5f, 0.5f, 0.5f})), origin, direction, 0, far,
            random, [&](const BeamCrossing& at) {
              sum += at.piece.power * attenuation(at.piece.extinction, at.along) * at.kernel;
            });
  return sum;
}

}  // namespace

TEST_CASE("rays across a sheet of beams see its flux, faded by Beer and Lambert's law") {
  Scene scene(1);
  fill(scene, 2);
  const auto beams = sheet(scene, 1 << 14, {1, 0, 0}, 2);
  const BeamTree tree = tree_of(scene, sheet(scene, 1 << 13, {1, 0, 0}, 1), beams);
  CHECK(tree.cell_count() > 100);
  for (const float x : {0.05f, 0.3f, 0.9f}) {
    CAPTURE(x);
    for (const Vec3& way : {Vec3{0, 1, 0}, Vec3{0, 0, 1}, normalize({0, 1, -0.3f})}) {
      const Vec3 origin = Vec3{x, 0.5f, 0.5f} - way * 0.4f;
      const Rgb sum = seen(tree, scene, origin, way, 0.8f);
      CHECK(sum.x == approx(0.8 * std::exp(-2 * double(x))).epsilon(0.02));
      CHECK(sum.z == approx(0.2 * std::exp(-2 * double(x))).epsilon(0.02));
    }
  }
  // Aslant: as long a way through the sheet as in the other cases, for what is across the beams
  const Vec3 way = normalize({0.6f, 0.8f, 0});
  double expected = 0;
  for (int i = 0; i < 1000; ++i) {
    const double t = (i + 0.5) / 1000;
    expected += std::exp(-2 * (0.1 + 0.6 * t)) / 1000;
  }
  CHECK(seen(tree, scene, {0.1f, 0.1f, 0.5f}, way, 1).x == approx(expected).epsilon(0.02));
  // In other media there is nothing
  CHECK(tree.stack_of({}) == -1);
}

TEST_CASE("beams are cut where the surface at their beginning cuts the ray's place") {
  Scene scene(1);
  fill(scene, 0);
  // A wall that leans by 45 degrees, from which beams leave
  const auto beams = sheet(scene, 1 << 12, {1, 0, 0}, 2, 1);
  const BeamTree tree = tree_of(scene, sheet(scene, 1 << 12, {1, 0, 0}, 1, 1), beams, 3);
  // Along a line parallel to the wall, close to it on either side, to which beams come from above
  // and below
  const Vec3 way = normalize({-1, 1, 1});
  const float far = 0.6f;
  const auto at = [&](float beside) {
    const Vec3 origin = Vec3{0, 0.5f, 0.5f} + normalize({1, 1, 0}) * beside - way * (0.5f * far);
    return seen(tree, scene, origin, way, far).x;
  };
  const double across = double(far) * std::sqrt(2.0 / 3);
  CHECK(at(0.005f) == approx(across).epsilon(0.03));
  CHECK(at(-0.005f) == 0);
}

TEST_CASE("a beam fades as its medium says where that is not the same everywhere") {
  Scene scene(1);
  fill(scene, 4, true);
  const auto beams = sheet(scene, 1 << 15, {1, 0, 0}, 2);
  const BeamTree tree = tree_of(scene, sheet(scene, 1 << 13, {1, 0, 0}, 1), beams);
  for (const float x : {0.1f, 0.5f, 0.9f}) {
    CAPTURE(x);
    CHECK(seen(tree, scene, {x, 0.1f, 0.5f}, {0, 1, 0}, 0.8f).x ==
          approx(0.8 * std::exp(-2 * double(x * x))).epsilon(0.06));
  }
}

TEST_CASE("rays that look at some of the beams see as much light in the mean") {
  Scene scene(1);
  fill(scene, 0);
  const auto pilot = sheet(scene, 1 << 12, {1, 0, 0}, 1),
             beams = sheet(scene, 1 << 13, {1, 0, 0}, 2);
  const BeamTree all = tree_of(scene, pilot, beams), some = tree_of(scene, pilot, beams, 1, 4);
  double by_all = 0, by_some = 0;
  uint64_t hits = 0, few = 0;
  Random random(1, 1);
  for (int i = 0; i < 40000; ++i) {
    const Vec3 origin{random.next(), 0.1f, 0.3f + 0.4f * random.next()};
    const auto add = [&](const BeamTree& tree, double& sum, uint64_t& count) {
      tree.each(0, origin, {0, 1, 0}, 0, 0.8f, random, [&](const BeamCrossing& at) {
        sum += double(at.piece.power.x * at.kernel);
        ++count;
      });
    };
    add(all, by_all, hits);
    add(some, by_some, few);
  }
  CHECK(by_some == approx(by_all).epsilon(0.01));
  CHECK(few < hits / 4);
}

TEST_CASE("rays look at fewer beams where other light is much noisier, and see as much") {
  Scene scene(1);
  fill(scene, 2);
  const auto beams = sheet(scene, 1 << 14, {1, 0, 0}, 2),
             pilot = sheet(scene, 1 << 11, {1, 0, 0}, 1);
  const Vec3 way = normalize({0.1f, 0.9f, 0.2f});
  struct Looks {
    double light = 0, squares = 0, met = 0;
  };
  const auto look = [&](double variance) {
    const BeamTree tree = tree_of(scene, pilot, beams, 1, 64, variance);
    Looks all;
    Random random(7, 7);
    constexpr int kRays = 100000;
    for (int ray = 0; ray < kRays; ++ray) {
      double light = 0;
      tree.each(tree.stack_of(scene.media()->around({0.5f, 0.5f, 0.5f})), {0.2f, 0.1f, 0.4f}, way,
                0, 0.8f, random, [&](const BeamCrossing& at) {
                  light += luminance(at.piece.power * attenuation(at.piece.extinction, at.along)) *
                           at.kernel;
                  all.met += 1.0 / kRays;
                });
      all.light += light / kRays;
      all.squares += light * light / kRays;
    }
    return all;
  };
  const Looks still = look(0), noisy = look(1);
  CHECK(noisy.met < 0.2 * still.met);
  CHECK(noisy.light == approx(still.light).epsilon(0.02));
  // What is left of the noise is what was said to be no matter, in each of the cells
  CHECK(noisy.squares - noisy.light * noisy.light < 1);
  CHECK(look(1e-12).met == approx(still.met).epsilon(0.02));
}

TEST_CASE("what is faint of a beam is broken off by chance") {
  Scene scene(1);
  fill(scene, 12);
  const auto beams = sheet(scene, 1 << 16, {1, 0, 0}, 2);
  const BeamTree tree = tree_of(scene, sheet(scene, 1 << 13, {1, 0, 0}, 1), beams);
  CHECK(tree.pieces().size() > beams.size());
  CHECK(seen(tree, scene, {0.5f, 0.1f, 0.5f}, {0, 1, 0}, 0.8f).x ==
        approx(0.8 * std::exp(-6.0)).epsilon(0.1));
}

TEST_CASE("a tree is the same for any number of threads") {
  std::vector<std::vector<Rgb>> light;
  for (const int threads : {1, 3}) {
    Scene scene(threads);
    fill(scene, 4, true);
    const BeamTree tree =
        tree_of(scene, sheet(scene, 1 << 12, {1, 0, 0}, 1), sheet(scene, 5000, {1, 0, 0}, 2));
    std::vector<Rgb> own;
    for (int i = 0; i < 20; ++i)
      own.push_back(seen(tree, scene, {0.04f * float(i), 0.1f, 0.5f}, {0, 1, 0}, 0.8f));
    light.push_back(own);
  }
  for (size_t i = 0; i < light[0].size(); ++i) {
    CHECK(light[0][i].x == light[1][i].x);
    CHECK(light[0][i].y == light[1][i].y);
  }
}
