// What operations of shader programs yield where the answer is known without another renderer.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "support/approx.h"
#include "support/programs.h"
#include "textures/noise_kernel.h"

using namespace photon_splat;
using namespace photon_splat::nodes;

namespace {

// A unit square in two triangles, moved by (10, 20, 30), with programs so that object coordinates
// are kept.
struct Square {
  Scene scene{1};

  explicit Square(Mesh mesh = make_grid(1),
                  std::vector<Placement> places = {{1, 0, 0, 10, 0, 1, 0, 20, 0, 0, 1, 30}}) {
    scene.programs.emplace_back();
    fill(scene, std::move(mesh), places);
  }
};

void check_near(const Vec3& a, const Vec3& b, float tolerance = 1e-5f) {
  CAPTURE(a.x);
  CAPTURE(a.y);
  CAPTURE(a.z);
  CAPTURE(b.x);
  CAPTURE(b.y);
  CAPTURE(b.z);
  CHECK(length(a - b) <= tolerance);
}

// The vector that one operation puts out at a point.
Vec3 result_of(const Square& square, Op op, ProgramWriter::Values values, ProgramWriter& w,
               const char* out, const ShadingPoint& point) {
  const uint32_t r = w.reg();
  values[out] = r;
  w.emit(op, values);
  return emitted(square.scene, w.emitting(r), point);
}

}  // namespace

TEST_CASE("jumps skip what they jump over") {
  Square square;
  for (float condition : {0.0f, 1.0f}) {
    ProgramWriter w;
    const uint32_t r = w.reg();
    w.emit(Op::CopyVector, {{"out", r}, {"value", w.constant({1, 1, 1})}});
    const auto at = static_cast<uint32_t>(w.program().code.size());
    w.emit(Op::JumpIfZero, {{"value", w.constant({condition})}, {"target", at + 3 + 3}});
    w.emit(Op::CopyVector, {{"out", r}, {"value", w.constant({2, 3, 4})}});
    check_near(emitted(square.scene, w.emitting(r), point_on(square.scene, 0.1f, 0.1f)),
               condition == 0 ? Vec3{1, 1, 1} : Vec3{2, 3, 4});
  }
}

TEST_CASE("positions and coordinates of a mesh that is moved, turned and mirrored") {
  // x' = 10 - 2 z, y' = 20 + 3 x, z' = 30 + y; its determinant is negative.
  const Placement place{0, 0, -2, 10, 3, 0, 0, 20, 0, 1, 0, 30};
  for (bool shared : {false, true}) {
    Square square(make_grid(1),
                  shared ? std::vector<Placement>{place, identity} : std::vector<Placement>{place});
    square.scene.meshes[0].generated = {{2, 2, 1}, {-1, -1, 0}};
    Surface s;
    REQUIRE(square.scene.intersect({0, 20.9f, 30.25f}, {1, 0, 0}, 0, 100, true, s));
    ShadingPoint point;
    point.position = s.position;
    point.ng = point.ns = s.ng;
    point.wo = {-1, 0, 0};
    point.back = s.back;
    point.instance = s.instance;
    point.triangle = s.triangle;
    point.u = s.u;
    point.v = s.v;
    const auto coordinates = [&](Coordinates what) {
      ProgramWriter w;
      // Colours of emission are not negative: shifted.
      const uint32_t r = w.reg();
      w.emit(Op::TextureCoordinate, {{"out", r}, {"what", word_of(what)}});
      w.emit(Op::AddVector, {{"out", r}, {"a", r}, {"b", w.constant({5, 5, 5})}});
      return emitted(square.scene, w.emitting(r), point) - Vec3{5, 5, 5};
    };
    check_near(coordinates(Coordinates::OBJECT), {0.3f, 0.25f, 0}, 1e-4f);
    check_near(coordinates(Coordinates::GENERATED), {-0.4f, -0.5f, 0}, 1e-4f);
    check_near(coordinates(Coordinates::REFLECTION), {-1, 0, 0});
    check_near(coordinates(Coordinates::NORMAL), {0, 0, s.back ? -1.0f : 1.0f});
    ProgramWriter w;
    check_near(result_of(square, Op::ObjectLocation, {}, w, "out", point), {10, 20, 30});
    ProgramWriter w2;
    check_near(result_of(square, Op::Geometry, {}, w2, "out", point), {10, 20.9f, 30.25f}, 1e-4f);
  }
}

TEST_CASE("attributes are interpolated over their domain, byte colours decoded first") {
  Mesh mesh = make_grid(1);  // triangle 0: vertices 0, 1, 3
  mesh.attributes.push_back({7, MeshAttribute::Domain::kPoint, 1, {0, 1, 5, 3}, {}});
  mesh.attributes.push_back({8,
                             MeshAttribute::Domain::kCorner,
                             3,
                             {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                             {}});
  mesh.attributes.push_back({9, MeshAttribute::Domain::kFace, 2, {4, 6, 0, 0}, {}});
  mesh.attributes.push_back({10,
                             MeshAttribute::Domain::kPoint,
                             4,
                             {},
                             {255, 188, 0, 255, 255, 188, 0, 127, 0, 0, 0, 0, 255, 188, 0, 127}});
  Square square(std::move(mesh));
  square.scene.instance_attributes.push_back({7, 4, {0.1f, 0.2f, 0.6f, 0.5f}});
  const ShadingPoint point = point_on(square.scene, 0.25f, 0.5f);
  const auto read = [&](Op op, uint32_t id) {
    ProgramWriter w;
    const uint32_t r = w.reg(), scalar = w.reg();
    w.emit(op, {{"vector", r}, {"factor", scalar}, {"alpha", scalar + 1}, {"attribute", id}});
    const Rgb color = emitted(square.scene, w.emitting(r), point);
    w.program().code.resize(w.program().code.size() - 4);  // the emission and the end
    return std::pair{color, emitted(square.scene, w.emitting(scalar), point)};
  };
  auto [number, scalars] = read(Op::Attribute, 7);
  check_near(number, {1.75f, 1.75f, 1.75f});
  check_near(scalars, {1.75f, 1, 0});
  std::tie(number, scalars) = read(Op::Attribute, 8);
  check_near(number, {0.25f, 0.25f, 0.5f});
  CHECK(scalars.x == approx(1.0f / 3));
  std::tie(number, scalars) = read(Op::Attribute, 9);
  check_near(number, {4, 6, 0});
  CHECK(scalars.x == 4);
  std::tie(number, scalars) = read(Op::Attribute, 10);
  check_near(number, {1, 0.5028865f, 0}, 1e-4f);
  CHECK(scalars.y == approx(0.25 + 0.75 * 127 / 255));
  std::tie(number, scalars) = read(Op::Attribute, 11);
  check_near(number, {0, 0, 0});
  check_near(scalars, {0, 1, 0});
  std::tie(number, scalars) = read(Op::InstanceAttribute, 7);
  check_near(number, {0.1f, 0.2f, 0.6f});
  check_near(scalars, {0.3f, 0.5f, 0});
}

TEST_CASE("bumps: none without slope, and the slope of a plane is that of the normal") {
  Square square;
  for (bool back : {false, true}) {
    const ShadingPoint point = point_on(square.scene, 0.2f, 0.3f, back);
    for (float slope : {0.0f, 0.75f}) {
      ProgramWriter w;
      uint32_t height[3];
      for (uint32_t axis = 0; axis < 3; ++axis) {  // height = slope * x
        w.emit(Op::Offset, {{"axis", axis}, {"width", w.constant({0.1f})}});
        const uint32_t p = w.reg();
        height[axis] = w.reg(1);
        w.emit(Op::TextureCoordinate, {{"out", p}, {"what", word_of(Coordinates::OBJECT)}});
        w.emit(Op::Multiply, {{"out", height[axis]}, {"a", p}, {"b", w.constant({slope})}});
      }
      w.emit(Op::Offset, {{"axis", 0}, {"width", w.constant({1})}});
      const uint32_t n = w.reg();
      w.emit(Op::Geometry, {{"out", n}, {"what", word_of(GeometryVector::NORMAL)}});
      w.emit(Op::Bump, {{"normal", n},
                        {"strength", w.constant({1})},
                        {"distance", w.constant({1})},
                        {"width", w.constant({0.1f})},
                        {"height", height[0]},
                        {"height_dx", height[1]},
                        {"height_dy", height[2]},
                        {"normal_in", n}});
      w.emit(Op::AddVector, {{"out", n}, {"a", n}, {"b", w.constant({2, 2, 2})}});
      const float z = back ? -1.0f : 1.0f;
      check_near(emitted(square.scene, w.emitting(n), point) - Vec3{2, 2, 2},
                 normalize(Vec3{-slope, 0, z}), 1e-3f);
    }
  }
}

TEST_CASE("a normal map's blue is the normal, its red leans along u") {
  Mesh mesh = make_grid(1);
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  Square square(std::move(mesh));
  const auto mapped = [&](Rgb color, bool back) {
    ProgramWriter w;
    const uint32_t n = w.reg();
    w.emit(Op::NormalMap, {{"normal", n},
                           {"strength", w.constant({1})},
                           {"color", w.constant({color.x, color.y, color.z})}});
    w.emit(Op::AddVector, {{"out", n}, {"a", n}, {"b", w.constant({2, 2, 2})}});
    return emitted(square.scene, w.emitting(n), point_on(square.scene, 0.2f, 0.3f, back)) -
           Vec3{2, 2, 2};
  };
  check_near(mapped({0.5f, 0.5f, 1}, false), {0, 0, 1});
  check_near(mapped({0.9f, 0.5f, 0.8f}, false), {0.8f, 0, 0.6f});
  check_near(mapped({0.5f, 0.9f, 0.8f}, false), {0, 0.8f, 0.6f});
  check_near(mapped({0.9f, 0.5f, 0.8f}, true), {-0.8f, 0, -0.6f});
}

TEST_CASE("images: pixels, extension, alpha") {
  Square square;
  Texture texture;
  texture.width = 2;
  texture.height = 1;
  texture.interpolation = Interpolation::kClosest;
  texture.extension = Extension::kClip;
  texture.floats = {0.2f, 0.4f, 0.1f, 0.5f, 3, 2, 1, 1};
  square.scene.textures.push_back(texture);
  const auto look = [&](float u, float v, bool unassociate, uint32_t image = 0) {
    ProgramWriter w;
    return result_of(
        square, Op::ImageTexture,
        {{"vector", w.constant({u, v, 0})}, {"image", image}, {"unassociate", unassociate}}, w,
        "color", point_on(square.scene, 0.1f, 0.1f));
  };
  check_near(look(0.25f, 0.5f, false), {0.2f, 0.4f, 0.1f});
  check_near(look(0.25f, 0.5f, true), {0.4f, 0.8f, 0.2f});
  check_near(look(0.75f, 0.5f, true), {3, 2, 1});
  check_near(look(1.25f, 0.5f, false), {0, 0, 0});
  check_near(look(1e9f, 0.5f, false), {0, 0, 0});
  square.scene.textures[0].extension = Extension::kRepeat;
  check_near(look(-20000.75f, 0.5f, false), {0.2f, 0.4f, 0.1f});
  check_near(look(-20000.25f, 0.5f, false), {3, 2, 1});
  square.scene.textures[0].extension = Extension::kMirror;
  check_near(look(20001.75f, 0.5f, false), {0.2f, 0.4f, 0.1f});
  square.scene.textures[0].extension = Extension::kExtend;
  check_near(look(1e9f, 0.5f, false), {3, 2, 1});
  check_near(look(0.25f, 0.5f, false, kNone), {1, 0, 1});
}

TEST_CASE("noise is smooth, bounded and not constant; its cells repeat nowhere near") {
  Square square;
  const ShadingPoint point = point_on(square.scene, 0.1f, 0.1f);
  for (uint32_t dimensions = 0; dimensions < 4; ++dimensions) {
    float low = 1, high = 0, last = -1, jump = 0;
    for (int i = 0; i < 400; ++i) {
      ProgramWriter w;
      const float x = 0.05f * static_cast<float>(i);
      const float value = result_of(square, Op::NoiseTexture,
                                    {{"vector", w.constant({x, 0.3f * x, 0.7f})},
                                     {"w", w.constant({x})},
                                     {"scale", w.constant({1})},
                                     {"detail", w.constant({1.5f})},
                                     {"roughness", w.constant({0.5f})},
                                     {"lacunarity", w.constant({2})},
                                     {"noise_dimensions", dimensions},
                                     {"noise_type", word_of(NoiseType::FBM)},
                                     {"normalize", 1}},
                                    w, "color", point)
                              .x;
      low = std::min(low, value);
      high = std::max(high, value);
      if (i > 0) jump = std::max(jump, std::abs(value - last));
      last = value;
    }
    CHECK(low >= 0);
    CHECK(high <= 1);
    CHECK(high - low > 0.2f);
    CHECK(jump < 0.2f);
  }
}

TEST_CASE(
    "noise is the same number, bit for bit, on every instruction set, and 0 at whole numbers") {
  NoisePoints points{};
  constexpr uint32_t kCount = 51;
  for (uint32_t i = 0; i < kCount; ++i)
    for (int d = 0; d < 4; ++d)
      points.c[d][i] = i == 7
                           ? static_cast<float>(d - 2)
                           : std::sin(static_cast<float>(i + 1) * (1.7f + static_cast<float>(d))) *
                                 std::exp2(static_cast<float>(i % 17));
  for (int dimensions = 1; dimensions <= 4; ++dimensions) {
    float plain[NoisePoints::kMost] = {};
    choose_noise_kernel("generic")(dimensions, points, kCount, plain);
    CHECK(plain[7] == 0);
    CHECK(*std::max_element(plain, plain + kCount) > 0.3f);
    CHECK(*std::min_element(plain, plain + kCount) < -0.3f);
    for (const char* name : {"sse42", "avx2", "avx512", ""}) {
      CAPTURE(dimensions);
      CAPTURE(name);
      const NoiseKernel kernel = choose_noise_kernel(name);
      if (!kernel) continue;  // not on this machine
      for (uint32_t count : {1u, 2u, 3u, 5u, 8u, 9u, kCount}) {
        float values[NoisePoints::kMost] = {};
        kernel(dimensions, points, count, values);
        CHECK(std::memcmp(values, plain, count * sizeof(float)) == 0);
      }
    }
  }
}

TEST_CASE(
    "noise that is computed together is what each texture yields by itself, of any number, kind and dimension") {
  Square square;
  const ShadingPoint point = point_on(square.scene, 0.1f, 0.1f);
  constexpr uint32_t kTextures = 40;  // of up to 18 points each: more than are computed at once
  const auto run = [&](bool together, uint32_t only) {
    ProgramWriter w;
    const uint32_t r = w.reg(kTextures * 3);
    if (together) w.emit(Op::Together, {{"count", kTextures}});
    for (uint32_t i = 0; i < kTextures; ++i) {
      const float x = 0.37f * static_cast<float>(i);
      const auto value = [&](float v) { return w.constant({v}); };
      const ProgramWriter::Values common{{"vector", w.constant({x, 0.3f - x, 0.7f})},
                                         {"scale", value(1.5f)},
                                         {"detail", value(0.5f * static_cast<float>(i % 11))}};
      if (i % 5 == 4) {
        ProgramWriter::Values wave{{"fac", r + 3 * i},
                                   {"distortion", value(i % 2 ? 0.0f : 2.0f)},
                                   {"detail_scale", value(1)},
                                   {"detail_roughness", value(0.5f)}};
        wave.insert(common.begin(), common.end());
        w.emit(Op::WaveTexture, wave);
      } else {
        ProgramWriter::Values noise{{i % 3 ? "fac" : "color", r + 3 * i},
                                    {"w", value(x)},
                                    {"roughness", value(0.6f)},
                                    {"lacunarity", value(2.1f)},
                                    {"offset", value(0.4f)},
                                    {"gain", value(1.2f)},
                                    {"distortion", value(i % 7 ? 0.0f : 0.5f)},
                                    {"noise_dimensions", i < 20 ? 2u : i % 4},
                                    {"noise_type", i % 5},
                                    {"normalize", 1}};
        noise.insert(common.begin(), common.end());
        w.emit(Op::NoiseTexture, noise);
      }
    }
    return emitted(square.scene, w.emitting(r + 3 * only), point);
  };
  uint32_t different = 0;
  for (uint32_t i = 0; i < kTextures; ++i) {
    CAPTURE(i);
    const Vec3 alone = run(false, i), joined = run(true, i);
    CHECK(alone.x == joined.x);
    CHECK(alone.y == joined.y);
    CHECK(alone.z == joined.z);
    different += alone.x != run(false, 0).x;
  }
  CHECK(different > kTextures / 2);
}

TEST_CASE(
    "Voronoi: the distance is to the position, the second is farther, both hashes fill the cells") {
  Square square;
  const ShadingPoint point = point_on(square.scene, 0.1f, 0.1f);
  for (uint32_t hash : {0u, 1u})
    for (uint32_t feature : {word_of(VoronoiFeature::F1), word_of(VoronoiFeature::F2)}) {
      const auto look = [&](const char* out, const Vec3& p) {
        ProgramWriter w;
        const uint32_t r = w.reg();
        w.emit(Op::VoronoiTexture, {{out, r},
                                    {"vector", w.constant({p.x, p.y, p.z})},
                                    {"scale", w.constant({1})},
                                    {"roughness", w.constant({0.5f})},
                                    {"lacunarity", w.constant({2})},
                                    {"exponent", w.constant({0.5f})},
                                    {"randomness", w.constant({1})},
                                    {"voronoi_dimensions", word_of(Dimensions::D3)},
                                    {"feature", feature},
                                    {"hash", hash}});
        return emitted(square.scene, w.emitting(r), point);
      };
      for (int i = 0; i < 50; ++i) {
        const Vec3 p{2 + 0.37f * static_cast<float>(i), 3 + 0.11f * static_cast<float>(i), 4.5f};
        const float distance = look("distance", p).x;
        CHECK(distance == approx(length(look("position", p) - p)).epsilon(1e-3));
        CHECK(distance < (feature == 0 ? 1.5f : 2.0f));
      }
    }
}

TEST_CASE("what the ray knows") {
  Square square;
  const auto value = [&](PathValue what, const ShadingPoint& point) {
    ProgramWriter w;
    const uint32_t r = w.reg();
    w.emit(Op::LightPath, {{"out", r}, {"what", word_of(what)}});
    return emitted(square.scene, w.emitting(r), point).x;
  };
  ShadingPoint point = point_on(square.scene, 0.1f, 0.1f);
  CHECK(value(PathValue::IS_CAMERA_RAY, point) == 1);
  point.ray.kind = RayInfo::kGlossy;
  point.ray.length = 2.5f;
  point.ray.depth = 3;
  CHECK(value(PathValue::IS_CAMERA_RAY, point) == 0);
  CHECK(value(PathValue::IS_GLOSSY_RAY, point) == 1);
  CHECK(value(PathValue::IS_REFLECTION_RAY, point) == 1);
  CHECK(value(PathValue::RAY_LENGTH, point) == 2.5f);
  CHECK(value(PathValue::RAY_DEPTH, point) == 3);
}

TEST_CASE("closures: weights, and normals on the side that is looked at") {
  Square square;
  for (bool back : {false, true}) {
    ProgramWriter w;
    const uint32_t n = w.reg();
    w.emit(Op::Geometry, {{"out", n}, {"what", word_of(GeometryVector::NORMAL)}});
    w.emit(
        Op::Diffuse,
        {{"weight", w.constant({0.5f})}, {"color", w.constant({0.8f, 0.4f, 0.2f})}, {"normal", n}});
    w.emit(Op::Transparent, {{"weight", w.constant({0.25f})}, {"color", w.constant({1, 0, 1})}});
    w.emit(Op::End, {});
    const ShadingPoint point = point_on(square.scene, 0.1f, 0.1f, back);
    check_program(square.scene, w.program());
    Bsdf bsdf(Transport::kRadiance, point.wo, point.ng, point.ns, point.back);
    run_program(square.scene, w.program(), point, bsdf);
    bsdf.finish();
    check_near(bsdf.gather(), {0.4f, 0.2f, 0.1f});
    check_near(bsdf.transparency(), {0.25f, 0, 0.25f});
    float pdf;
    check_near(bsdf.evaluate(point.wo, &pdf), Vec3{0.4f, 0.2f, 0.1f} * (1 / kPi));
    check_near(bsdf.evaluate(-point.wo, &pdf), {0, 0, 0});
  }
}

TEST_CASE("an IES profile is read between its angles, nothing outside") {
  Square square;
  // One meridian and its end, 0 to 90 degrees down: 10, 20, 30 candela.
  const auto look = [&](const Vec3& d) {
    ProgramWriter w;
    const uint32_t profile =
        w.constant({2, 3, 0, 2 * kPi, 0, kPi / 4, kPi / 2, 10, 20, 30, 10, 20, 30}) & ~kConstant;
    const uint32_t r = w.reg();
    w.emit(Op::IesTexture, {{"fac", r},
                            {"vector", w.constant({d.x, d.y, d.z})},
                            {"strength", w.constant({2})},
                            {"profile", profile}});
    return emitted(square.scene, w.emitting(r), point_on(square.scene, 0.1f, 0.1f)).x;
  };
  CHECK(look({0, 0.001f, -1}) == approx(20).epsilon(0.01));
  CHECK(look({1, 0, -1}) == approx(40).epsilon(0.01));
  CHECK(look({0, 0, 1}) == 0);
}
