// Shader programs: what the checker refuses, and that no sound program fails or yields what is not
// a number.
#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <stdexcept>

#include "support/programs.h"

using namespace photon_splat;
using nodes::Op;
using nodes::Operand;

namespace {

std::string refusal(const Scene& scene, const Program& program) {
  try {
    check_program(scene, program);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

Program program_of(std::vector<uint32_t> code, std::vector<float> constants = {},
                   uint32_t registers = 4) {
  Program p;
  p.name = "Wall";
  p.code = std::move(code);
  p.constants = std::move(constants);
  p.registers = registers;
  return p;
}

constexpr uint32_t code(Op op) { return static_cast<uint32_t>(op); }

// A mesh with everything that programs can ask for, a texture of each kind, and a camera.
void fill_everything(Scene& scene, bool shared) {
  scene.programs.emplace_back();
  scene.materials.resize(1);
  Mesh mesh = padded(make_sphere(6, 8));
  const size_t corners = 3 * mesh.triangles.size();
  for (const Triangle& t : mesh.triangles)
    for (uint32_t vertex : t) {
      mesh.corner_normals.own().push_back(mesh.positions[vertex]);
      mesh.uv.own().push_back({mesh.positions[vertex].x, mesh.positions[vertex].y});
    }
  mesh.attributes.push_back(
      {1, MeshAttribute::Domain::kCorner, 4, LargeArray<float>(4 * corners, 0.5f), {}});
  mesh.attributes.push_back({2,
                             MeshAttribute::Domain::kPoint,
                             4,
                             {},
                             std::vector<uint8_t>(4 * (mesh.positions.size() - 1), 128)});
  mesh.attributes.push_back(
      {3, MeshAttribute::Domain::kFace, 1, LargeArray<float>(corners / 3, 2.0f), {}});
  scene.meshes.push_back(std::move(mesh));
  const Placement place{-2, 0, 0, 5, 0, 1, 0.5, 6, 0, 0, 1, 7};
  scene.add_instance(0, place, {0});
  if (shared) scene.add_instance(0, identity, {0});
  scene.instance_attributes.push_back(
      {4, 3, std::vector<float>(3 * scene.instances.size(), 0.25f)});
  for (Interpolation interpolation :
       {Interpolation::kLinear, Interpolation::kClosest, Interpolation::kCubic})
    for (Extension extension :
         {Extension::kRepeat, Extension::kExtend, Extension::kClip, Extension::kMirror}) {
      Texture texture;
      texture.width = 3;
      texture.height = 2;
      texture.srgb = true;
      texture.interpolation = interpolation;
      texture.extension = extension;
      texture.bytes.assign(24, 100);
      scene.textures.push_back(texture);
    }
  scene.build(CancelFlag());
}

// A sound instruction with operands drawn at random; its outputs go to the first `registers`
// registers.
void append_random(Program& p, Op op, const Scene& scene, Random& random, uint32_t registers,
                   const std::map<std::string, uint32_t>& tables) {
  using Kind = Operand::Kind;
  const auto pick = [&](uint32_t n) {
    return std::min(static_cast<uint32_t>(random.next() * static_cast<float>(n)), n - 1);
  };
  const auto next = static_cast<uint32_t>(p.code.size()) + nodes::kWords[code(op)];
  p.code.push_back(code(op));
  const uint32_t constants = 64;  // the hostile numbers at the start
  for (const Operand& operand : nodes::operations()[static_cast<size_t>(op)].operands) {
    uint32_t word = 0;
    switch (operand.code) {
      case Kind::kOutFloat: word = pick(4) == 0 ? nodes::kUnused : pick(registers); break;
      case Kind::kOutVector: word = pick(4) == 0 ? nodes::kUnused : pick(registers - 2); break;
      case Kind::kFloat:
        word = pick(2) ? pick(registers) : pick(constants) | nodes::kConstant;
        break;
      case Kind::kVector:
        word = pick(2) ? pick(registers - 2) : pick(constants - 2) | nodes::kConstant;
        break;
      case Kind::kMode: word = pick(static_cast<uint32_t>(operand.modes.size())); break;
      case Kind::kNumber: word = pick(3) == 0 ? 65535 : pick(12); break;
      case Kind::kTexture:
        word = pick(4) == 0 ? nodes::kNone : pick(static_cast<uint32_t>(scene.textures.size()));
        break;
      case Kind::kAttribute: word = pick(7) == 0 ? nodes::kNone : pick(6); break;
      case Kind::kJump: word = next; break;
      default: word = tables.at(operand.kind); break;
    }
    p.code.push_back(word);
  }
}

}  // namespace

TEST_CASE(
    "the checker refuses what would read or write out of bounds, and says which shader it was") {
  Scene scene(1);
  scene.textures.resize(1);
  const uint32_t end = code(Op::End);
  CHECK(refusal(scene, program_of({end})) == "");
  CHECK(refusal(scene, program_of({})) == "the shader program of 'Wall' does not end with End");
  CHECK(refusal(scene, program_of({code(Op::Copy), 0, 1})) ==
        "the shader program of 'Wall' does not end with End");
  CHECK(refusal(scene, program_of({code(Op::Copy), 0})) ==
        "the shader program of 'Wall' ends within an instruction");
  CHECK(refusal(scene, program_of({9999, end})) ==
        "the shader program of 'Wall' has an unknown operation");
  CHECK(refusal(scene, program_of({code(Op::Copy), 4, 0, end})) ==
        "the shader program of 'Wall' writes beyond its registers");
  CHECK(refusal(scene, program_of({code(Op::CopyVector), 2, 0, end})) ==
        "the shader program of 'Wall' writes beyond its registers");
  CHECK(refusal(scene, program_of({code(Op::CopyVector), 0, 2, end})) ==
        "the shader program of 'Wall' reads beyond its registers");
  CHECK(refusal(scene, program_of({code(Op::Copy), 0, nodes::kConstant, end})) ==
        "the shader program of 'Wall' reads beyond its constants");
  CHECK(refusal(scene, program_of({code(Op::Copy), nodes::kUnused, 0, end})) == "");
  CHECK(refusal(scene, program_of({code(Op::Copy), 0, nodes::kUnused, end})) ==
        "the shader program of 'Wall' reads beyond its registers");
  CHECK(refusal(scene, program_of({code(Op::Jump), 0, end})) ==
        "the shader program of 'Wall' jumps backwards");
  CHECK(refusal(scene, program_of({code(Op::Jump), 3, code(Op::Copy), 0, 0, end})) ==
        "the shader program of 'Wall' jumps to where no instruction starts");
  CHECK(refusal(scene, program_of({code(Op::Jump), 2, end})) == "");
  CHECK(refusal(scene, program_of({code(Op::Jump), 70, end})) ==
        "the shader program of 'Wall' jumps to where no instruction starts");
  CHECK(refusal(scene, program_of({code(Op::Geometry), 0, 6, end})) ==
        "the shader program of 'Wall' has an unknown mode");
  CHECK(refusal(scene, program_of({code(Op::ImageTexture), 0, 3, 0, 1, 0, 0, 0, end})) ==
        "the shader program of 'Wall' names a texture that does not exist");
  CHECK(refusal(scene, program_of({code(Op::MagicTexture), 0, 3, 0, 0, 0, 70000, 0, end})) ==
        "the shader program of 'Wall' has a number out of range");
  CHECK(refusal(scene, program_of({code(Op::ColorRamp), 0, 3, 0, 0, 0, end}, {2, 1, 1, 1})) ==
        "the shader program of 'Wall' has a table beyond its constants");
  for (float count : {1.0f, -3.0f, 1e9f, INFINITY, std::numeric_limits<float>::quiet_NaN()})
    CHECK(refusal(scene,
                  program_of({code(Op::FloatCurve), 0, 0, 0, 0, 0, 0, 0, end}, {count, 1, 1, 1})) ==
          "the shader program of 'Wall' has a table of an impossible length");
  CHECK(refusal(scene,
                program_of({code(Op::TransformPoint), 0, 0, 1, end}, std::vector<float>(12))) ==
        "the shader program of 'Wall' has a table beyond its constants");
  CHECK(refusal(scene, program_of({end}, {}, 1u << 30)) ==
        "the shader program of 'Wall' uses more registers than there are");
}

TEST_CASE("a program is known to ask for the kind of ray, or of shadow rays alone") {
  using enum nodes::PathValue;
  for (const auto what : {IS_CAMERA_RAY, RAY_LENGTH, IS_SHADOW_RAY, IS_DIFFUSE_RAY,
                          IS_REFLECTION_RAY, IS_TRANSMISSION_RAY}) {
    ProgramWriter w;
    const uint32_t r = w.reg(1);
    w.emit(Op::LightPath, {{"out", r}, {"what", word_of(what)}});
    w.emit(Op::Transparent, {{"weight", r}, {"color", w.constant({1, 1, 1})}});
    w.emit(Op::End, {});
    look_at_program(w.program());
    CHECK(w.program().asks_kind ==
          (what != IS_CAMERA_RAY && what != RAY_LENGTH && what != IS_SHADOW_RAY));
    CHECK(w.program().asks_shadow == (what != IS_CAMERA_RAY && what != RAY_LENGTH));
  }
}

TEST_CASE("a ray is what the lobe that sent it makes it, as in Cycles") {
  using enum nodes::PathValue;
  const Scene scene(1);
  const auto told = [&](nodes::PathValue what, const RayInfo& ray) {
    ProgramWriter w;
    const uint32_t r = w.reg(1), color = w.reg();
    w.emit(Op::LightPath, {{"out", r}, {"what", word_of(what)}});
    w.emit(Op::Spread, {{"out", color}, {"value", r}});
    ShadingPoint point;
    point.position = point.ng = point.ns = point.wo = {0, 0, 1};
    point.ray = ray;
    return emitted(scene, w.emitting(color), point).x;
  };
  struct Case {
    bool diffuse, transmitted;
    float glossy, reflection, diffuse_depth, glossy_depth, transmission_depth;
  };
  for (const Case& c : {Case{true, false, 0, 1, 1, 0, 0}, Case{true, true, 0, 0, 0, 0, 1},
                        Case{false, false, 1, 1, 0, 1, 0}, Case{false, true, 1, 0, 0, 0, 1}}) {
    const RayInfo ray = RayInfo{}.scattered(c.diffuse, c.transmitted, false);
    CHECK(told(IS_CAMERA_RAY, ray) == 0);
    CHECK(told(IS_DIFFUSE_RAY, ray) == c.diffuse);
    CHECK(told(IS_GLOSSY_RAY, ray) == c.glossy);
    CHECK(told(IS_REFLECTION_RAY, ray) == c.reflection);
    CHECK(told(IS_TRANSMISSION_RAY, ray) == c.transmitted);
    CHECK(told(RAY_DEPTH, ray) == 1);
    CHECK(told(DIFFUSE_DEPTH, ray) == c.diffuse_depth);
    CHECK(told(GLOSSY_DEPTH, ray) == c.glossy_depth);
    CHECK(told(TRANSMISSION_DEPTH, ray) == c.transmission_depth);
  }
}

TEST_CASE("random words are refused or run") {
  Scene scene(1);
  fill_everything(scene, false);
  ShadingPoint point = point_on(scene, 0.2f, 0.3f);
  Random random(1, 1);
  int sound = 0;
  for (int i = 0; i < 20000; ++i) {
    Program p = program_of({}, std::vector<float>(16, 2.0f), 16);
    const size_t operations = static_cast<size_t>(Op::kCount);
    const size_t op = std::min(static_cast<size_t>(random.next() * static_cast<float>(operations)),
                               operations - 1);
    p.code.push_back(static_cast<uint32_t>(op));
    for (uint32_t w = 1; w < nodes::kWords[op]; ++w) {
      const float r = random.next();
      p.code.push_back(r < 0.97f   ? static_cast<uint32_t>(r * 4)
                       : r < 0.99f ? static_cast<uint32_t>(random.next() * 4e9f)
                                   : nodes::kConstant);
    }
    p.code.push_back(code(Op::End));
    if (!refusal(scene, p).empty()) continue;
    ++sound;
    CHECK(is_finite(emitted(scene, p, point)));
  }
  CHECK(sound > 2000);
}

TEST_CASE("no operation fails or lets out what is not a number, whatever numbers it is given") {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              tiny = std::numeric_limits<float>::denorm_min();
  const std::vector<float> hostile{
      0,         -0.0f,    1,        -1,        0.5f,  2,    1e-20f,        1e20f,          -1e20f,
      3.4e38f,   -3.4e38f, INFINITY, -INFINITY, nan,   tiny, 2147483648.0f, -2147483648.0f, 1e6f,
      100000.0f, 1e-3f,    15,       16,        -7.5f, 12000};
  Random random(2, 2);
  for (bool shared : {false, true}) {
    Scene scene(1);
    fill_everything(scene, shared);
    for (size_t op = 0; op < static_cast<size_t>(Op::kCount); ++op) {
      for (int i = 0; i < 150; ++i) {
        Program p = program_of({}, {}, 24);
        for (int k = 0; k < 64; ++k) {
          const float r = random.next();
          p.constants.push_back(
              r < 0.5f ? random.next() * 4 - 2
                       : hostile[std::min(static_cast<size_t>(random.next() * 24), size_t{23})]);
        }
        std::map<std::string, uint32_t> tables;
        const auto table = [&](const char* kind, std::initializer_list<float> start, int more) {
          tables[kind] = static_cast<uint32_t>(p.constants.size());
          for (float value : start) p.constants.push_back(value);
          for (int k = 0; k < more; ++k) p.constants.push_back(random.next());
        };
        table("T1", {3}, 3);
        table("T3", {2}, 6);
        table("T4", {4}, 16);
        table("M", {}, 12);
        table("P", {2, 3, 0, 6.2831f, 0, 1.5f, 3.14159f}, 6);
        const auto write = [&p](std::initializer_list<uint32_t> words) {
          for (uint32_t word : words) p.code.push_back(word);
        };
        for (uint32_t r = 0; r < 24; r += 3)
          write({code(Op::CopyVector), r,
                 static_cast<uint32_t>(random.next() * 62) | nodes::kConstant});
        append_random(p, static_cast<Op>(op), scene, random, 24, tables);
        if (static_cast<Op>(op) == Op::Offset)
          append_random(p, Op::TextureCoordinate, scene, random, 24, tables);
        write({code(Op::Emission), 3, 0, code(Op::Transparent), 9, 6, code(Op::Diffuse), 13, 10, 14,
               17, code(Op::End)});
        REQUIRE(refusal(scene, p) == "");
        ShadingPoint point = point_on(scene, random.next(), random.next(), i % 2 != 0);
        if (i % 5 == 0) point.instance = ShadingPoint::kNoInstance;
        if (i % 7 == 0) point.ray.footprint = 0;
        if (i % 3 == 0) point.ray.length = INFINITY;
        Bsdf bsdf(Transport::kRadiance, point.wo, point.ng, point.ns, point.back);
        run_program(scene, p, point, bsdf);
        bsdf.finish();
        const std::string& name = nodes::operations()[op].name;
        CAPTURE(name);
        CHECK(is_finite(bsdf.emission()));
        CHECK(is_finite(bsdf.transparency()));
        CHECK(is_finite(bsdf.gather()));
        float pdf = 0;
        CHECK(is_finite(bsdf.evaluate({0, 0, 1}, &pdf)));
        CHECK(std::isfinite(pdf));
      }
    }
  }
}

TEST_CASE("a program of many registers runs as one of few") {
  Scene scene(1);
  fill(scene, make_grid(1), {identity});
  ProgramWriter w;
  w.reg(100000);
  const uint32_t last = w.reg();
  w.emit(Op::CopyVector, {{"out", last}, {"value", w.constant({1, 2, 3})}});
  CHECK(length(emitted(scene, w.emitting(last), point_on(scene, 0.1f, 0.1f)) - Vec3{1, 2, 3}) == 0);
}
