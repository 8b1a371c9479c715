// True displacement: where vertices go, which stay, and what normals they have then.
#include "scene/displacement.h"
#include "support/approx.h"

#include <doctest/doctest.h>

#include "support/programs.h"

using namespace photon_splat;
using nodes::Op;

namespace {

// A program that moves every vertex by `offset`, in the world.
Program moving(std::initializer_list<float> offset) {
  ProgramWriter w;
  w.emit(Op::Displace, {{"weight", w.constant({1})}, {"offset", w.constant(offset)}});
  w.emit(Op::End, {});
  return w.program();
}

// One that moves it upwards by its X.
Program leaning() {
  ProgramWriter w;
  const uint32_t p = w.reg(), d = w.reg();
  w.emit(Op::TextureCoordinate, {{"out", p}, {"what", word_of(nodes::Coordinates::OBJECT)}});
  w.emit(Op::CombineColor, {{"out", d}, {"c", p}});
  w.emit(Op::Displace, {{"weight", w.constant({1})}, {"offset", d}});
  w.emit(Op::End, {});
  return w.program();
}

constexpr Placement kDoubled{2, 0, 0, 5, 0, 2, 0, 0, 0, 0, 2, 0};

struct Sheet {
  explicit Sheet(Program program, int quads = 1, const Placement& place = identity) : scene(1) {
    Mesh mesh = padded(make_grid(quads));
    mesh.corner_normals.own().resize(3 * mesh.triangles.size());
    for (Vec3& n : mesh.corner_normals.own()) n = {0, 0, 1};
    scene.materials.resize(1);
    scene.meshes.push_back(std::move(mesh));
    check_program(scene, program);
    scene.programs.push_back(std::move(program));
    scene.add_instance(0, place, {0});
  }
  DisplacedMesh displaced(const std::vector<SlotDisplacement>& slots,
                          const std::vector<bool>& smooth = {}, bool own_corners = false) {
    return displace(scene, 0, slots, smooth, own_corners, CancelFlag());
  }
  Scene scene;
};

void check_near(const Vec3& a, const Vec3& b) {
  INFO(a.x, " ", a.y, " ", a.z);
  CHECK(length(a - b) < 1e-5f);
}

}  // namespace

TEST_CASE("vertices move in the world, by the mesh's own measure") {
  Sheet sheet(moving({0, 0, 1}), 1, kDoubled);
  const DisplacedMesh moved = sheet.displaced({{0, false}});
  REQUIRE(moved.positions.size() == 4);
  check_near(moved.positions[3], {1, 1, 0.5f});
  CHECK(moved.not_finite == 0);
}

TEST_CASE("a vertex that has no finite place to go to stays") {
  Sheet sheet(moving({0, NAN, 1}));
  const DisplacedMesh moved = sheet.displaced({{0, false}});
  CHECK(moved.not_finite == 4);
  check_near(moved.positions[3], {1, 1, 0});
}

TEST_CASE("a mesh that has normals of vertices gets such again where all corners agree") {
  const std::vector<bool> flat(8, false), smooth;
  for (const SlotDisplacement slot : {SlotDisplacement{0, false}, SlotDisplacement{0, true}}) {
    Sheet corners(leaning(), 2), vertices(leaning(), 2);
    Mesh& mesh = vertices.scene.meshes[0];
    mesh.corner_normals.own().clear();
    mesh.vertex_normals.own().assign(mesh.positions.size() - 1, {0, 0, 1});
    const DisplacedMesh expected = corners.displaced({slot}), found = vertices.displaced({slot});
    for (size_t v = 0; v < 9; ++v) CHECK(length(found.positions[v] - expected.positions[v]) == 0);
    CHECK(found.vertex_normals.size() == (slot.bumps ? 0 : 9));
    CHECK(found.corner_normals.size() == (slot.bumps ? 24 : 0));
    for (size_t c = 0; c < 24; ++c) {
      const uint32_t v = mesh.triangles[c / 3][c % 3];
      const Vec3 n = slot.bumps ? found.corner_normals[c] : found.vertex_normals[v];
      CHECK(length(n - expected.corner_normals[c]) == 0);
    }
  }
}

TEST_CASE("a vertex moves once, by the first corner at it of a slot that moves") {
  Sheet sheet(moving({0, 0, 1}), 2);
  sheet.scene.meshes[0].slots = {0, 0, 1, 1, 0, 0, 0, 0};
  const DisplacedMesh moved = sheet.displaced({{-1, false}, {0, false}});
  // the second quad's corners: 1, 2, 5, 4
  for (const uint32_t v : {1u, 2u, 4u, 5u}) CHECK(moved.positions[v].z == 1);
  for (const uint32_t v : {0u, 3u, 6u, 7u, 8u}) CHECK(moved.positions[v].z == 0);
}

TEST_CASE("normals follow the surface, those of bumps stay") {
  const Vec3 leant = normalize({-1, 0, 1});
  Sheet sheet(leaning(), 2);
  for (const Vec3& n : sheet.displaced({{0, false}}).corner_normals) check_near(n, leant);
  for (const Vec3& n : sheet.displaced({{0, true}}).corner_normals) check_near(n, {0, 0, 1});
  CHECK(sheet.displaced({{0, false}}, std::vector<bool>(8, false)).corner_normals.empty());
}

TEST_CASE("corner normals of their own keep their difference") {
  Sheet sheet(leaning(), 1);
  const Vec3 own = normalize({0, 1, 1});
  sheet.scene.meshes[0].corner_normals.own()[0] = own;
  const DisplacedMesh moved = sheet.displaced({{0, false}}, {true, false}, true);
  const Vec3 leant = normalize({-1, 0, 1});
  check_near(moved.corner_normals[0], normalize(own + (leant - Vec3{0, 0, 1})));
  check_near(moved.corner_normals[1], leant);
  check_near(moved.corner_normals[3], leant);  // flat: the face's
}

TEST_CASE("what does not fit is refused") {
  Sheet sheet(moving({0, 0, 1}));
  CHECK_THROWS_AS(sheet.displaced({}), std::invalid_argument);
  CHECK_THROWS_AS(sheet.displaced({{1, false}}), std::invalid_argument);
  CHECK_THROWS_AS(sheet.displaced({{0, false}}, {true}), std::invalid_argument);
  CHECK_THROWS_AS(displace(sheet.scene, 1, {{0, false}}, {}, false, CancelFlag()),
                  std::invalid_argument);
  sheet.scene.meshes[0].corner_normals.own().clear();
  CHECK_THROWS_AS(sheet.displaced({{0, false}}), std::invalid_argument);
}
