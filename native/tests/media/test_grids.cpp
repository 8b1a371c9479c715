#include <doctest/doctest.h>

#include "media/media.h"
#include "support/approx.h"
#include "support/grids.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr uint32_t kSamples = 1 << 15;
constexpr uint32_t kDensity = 7;
const CancelFlag kNever;

// Scatters `factor` times what the grid holds, and shines likewise.
Program of_grid(float factor, float shines = 0) {
  ProgramWriter w;
  const uint32_t value = w.reg(1), color = w.reg();
  w.emit(nodes::Op::GridValue, {{"vector", color}, {"factor", value}, {"attribute", kDensity}});
  w.emit(nodes::Op::VolumeScatter,
         {{"weight", w.constant({factor})}, {"color", w.constant({1, 1, 1})}, {"density", value}});
  if (shines > 0) {
    w.emit(nodes::Op::Emission, {{"weight", w.constant({shines})}, {"color", color}});
    w.program().features = kProgramEmits;
  }
  w.emit(nodes::Op::End, {});
  return w.program();
}

// 30 voxels a metre, empty but for 0.2 <= x < 0.8.
double held(int x, int y, int z) {
  if (x < 6 || x >= 24) return 0;
  return 1 + 0.5 * std::sin(0.4 * x) + 0.02 * (y + z);
}

// A cube [0, 1]^3 that carries the grid.
void fill(Scene& scene, const Program& medium, const Placement& place = identity,
          float density = 1) {
  add_cube_of(scene, medium);
  const Affine to_index{{30, 0, 0, 0, 0, 30, 0, 0, 0, 0, 30, 0}};
  scene.meshes[0].grids.push_back(
      {kDensity, std::make_shared<const VolumeGrid>(
                     grid_of({0, 0, 0}, {31, 31, 31}, to_index, 1,
                             [](int x, int y, int z, uint32_t) { return held(x, y, z); }))});
  scene.add_instance(0, place, {0});
  scene.instances[0].density = density;
  for (const Program& program : scene.programs) check_program(scene, program);
  scene.build(kNever);
}

// What the grid holds along a line of constant y and z, in voxels, from 0 to 1 along x, times m.
double depth_along_x(double y, double z) {
  double sum = 0;
  const auto at = [&](int x) {
    const int iy = static_cast<int>(y), iz = static_cast<int>(z);
    const double ty = y - iy, tz = z - iz;
    return (held(x, iy, iz) * (1 - ty) + held(x, iy + 1, iz) * ty) * (1 - tz) +
           (held(x, iy, iz + 1) * (1 - ty) + held(x, iy + 1, iz + 1) * ty) * tz;
  };
  for (int x = 0; x < 30; ++x) sum += 0.5 * (at(x) + at(x + 1)) / 30;
  return sum;
}

struct Means {
  double passed = 0, scattered = 0, emitted = 0, through = 0, least = 1, most = 0;
};
Means look(const Scene& scene, const Vec3& origin, const Vec3& direction, float far,
           const Vec3& inside) {
  const MediumStack stack = scene.media()->around(inside);
  REQUIRE(!stack.empty());
  Means sum;
  Random random(7, 1);
  for (uint32_t i = 0; i < kSamples; ++i) {
    const Flight f =
        scene.media()->fly(stack, origin, direction, 0, far, {1, 1, 1}, {1, 1, 1}, {}, random);
    if (f.scatters)
      sum.scattered += double(average(f.weight * f.point.scattering)) / kSamples;
    else
      sum.passed += double(average(f.weight)) / kSamples;
    sum.emitted += double(average(f.emission)) / kSamples;
    const double through =
        double(average(scene.media()->transmittance(stack, origin, direction, 0, far, {}, random)));
    sum.through += through / kSamples;
    sum.least = std::min(sum.least, through);
    sum.most = std::max(sum.most, through);
  }
  return sum;
}

}  // namespace

TEST_CASE("light fades in a volume grid as its integral says") {
  Scene scene(1);
  fill(scene, of_grid(2));
  const Means means = look(scene, {0, 0.35f, 0.6f}, {1, 0, 0}, 1, {0.5f, 0.5f, 0.5f});
  const double passed = std::exp(-2 * depth_along_x(10.5, 18));
  CHECK(means.through == approx(passed).epsilon(0.01));
  CHECK(means.passed == approx(passed).epsilon(0.03));
  CHECK(means.scattered == approx(1 - passed).epsilon(0.01));
}

TEST_CASE("bounds from bricks bound what a volume grid holds") {
  Scene scene(1);
  fill(scene, of_grid(5));
  Random random(3, 1);
  for (int i = 0; i < 20; ++i) {
    const Vec3 from{random.next(), random.next(), random.next()},
        to{random.next(), random.next(), random.next()};
    const Means means =
        look(scene, from, normalize(to - from), length(to - from), {0.5f, 0.5f, 0.5f});
    CHECK(means.least >= 0);  // every weight of a null collision lies between 0 and 1
    CHECK(means.most <= 1);
  }
}

TEST_CASE("nothing collides where a volume grid is empty") {
  Scene scene(1);
  fill(scene, of_grid(1e6f));
  const MediumStack stack = scene.media()->around({0.5f, 0.5f, 0.5f});
  Random one(1, 1), other(1, 1);
  other.next();  // the one depth that it draws
  CHECK(scene.media()->transmittance(stack, {0.99f, 0.5f, 0.5f}, {1, 0, 0}, 0, 5, {}, one).x == 1);
  CHECK(one.next() == other.next());
}

TEST_CASE("a volume grid turns and grows with its object, and its density by a factor") {
  const Placement turned{0, -2, 0, 3, 2, 0, 0, 1, 0, 0, 2, -1};  // x to y, twice the size
  Scene scene(1);
  fill(scene, of_grid(2, 0.5f), turned, 0.5f);
  const Means means = look(scene, {3 - 2 * 0.35f, 1, -1 + 2 * 0.6f}, {0, 1, 0}, 2, {2, 2, 0});
  const double depth = 2 * depth_along_x(10.5, 18);
  CHECK(means.through == approx(std::exp(-depth)).epsilon(0.01));
  CHECK(means.passed == approx(std::exp(-depth)).epsilon(0.03));
  // All that shines does so in proportion to what scatters.
  CHECK(means.emitted == approx(0.25 * (1 - std::exp(-depth))).epsilon(0.02));
}

TEST_CASE("programs read what an object without the grid is to have instead") {
  ProgramWriter w;
  const uint32_t value = w.reg(1);
  w.emit(nodes::Op::GridValue,
         {{"factor", value}, {"absent", w.constant({3, 0, 0})}, {"attribute", kDensity + 1}});
  w.emit(nodes::Op::VolumeScatter,
         {{"weight", w.constant({1})}, {"color", w.constant({1, 1, 1})}, {"density", value}});
  w.emit(nodes::Op::End, {});
  Scene scene(1);
  fill(scene, w.program());
  const Means means = look(scene, {0, 0.5f, 0.5f}, {1, 0, 0}, 0.5f, {0.5f, 0.5f, 0.5f});
  CHECK(means.passed == approx(std::exp(-1.5)).epsilon(0.02));
}

TEST_CASE(
    "what shines everywhere in the mesh around a grid does not beyond it, whoever has lost the way out") {
  ProgramWriter w;
  const uint32_t value = w.reg(1);
  w.emit(nodes::Op::GridValue, {{"factor", value}, {"attribute", kDensity}});
  w.emit(nodes::Op::VolumeScatter,
         {{"weight", w.constant({1e-4f})}, {"color", w.constant({1, 1, 1})}, {"density", value}});
  w.emit(nodes::Op::Emission, {{"weight", w.constant({3})}, {"color", w.constant({1, 1, 1})}});
  w.emit(nodes::Op::End, {});
  w.program().features = kProgramEmits;
  const Placement turned{0, -2, 0, 3, 2, 0, 0, 1, 0, 0, 2, -1};  // x to y, twice the size
  for (const Placement& place : {identity, turned}) {
    Scene scene(1);
    fill(scene, w.program(), place);
    const double size = place == identity ? 1 : 2;
    const Vec3 middle = scene.bounds().center(), along{0, 1, 0};
    const auto from = [&](double y) {
      return middle + along * static_cast<float>(size * (y - 0.5));
    };
    const float far = 1000;
    CHECK(look(scene, from(0.5), along, far, middle).emitted == approx(3 * size / 2).epsilon(0.01));
    CHECK(look(scene, from(1.01), along, far, middle).emitted == 0);
  }
}
