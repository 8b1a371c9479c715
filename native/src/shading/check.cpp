#include <optional>
#include <stdexcept>
#include <string_view>

#include "bsdf/lobe.h"
#include "scene/scene.h"
#include "shading/ops.h"

namespace photon_splat {
namespace {

using nodes::Operand;

class Checker {
 public:
  Checker(const Scene& scene, const Program& program) : scene_(scene), program_(program) {}

  void run() {
    const size_t size = program_.code.size();
    if (program_.registers > kMaxRegisters) fail("uses more registers than there are");
    std::vector<bool> starts(size, false);
    std::vector<uint32_t> targets;
    uint32_t last = 0;
    for (size_t at = 0; at < size;) {
      const uint32_t opcode = program_.code[at];
      if (opcode >= static_cast<uint32_t>(nodes::Op::kCount)) fail("has an unknown operation");
      const uint32_t words = nodes::kWords[opcode];
      if (words > size - at) fail("ends within an instruction");
      starts[at] = true;
      const auto& operands = nodes::operations()[opcode].operands;
      for (size_t i = 0; i < operands.size(); ++i) {
        const uint32_t word = program_.code[at + 1 + i];
        if (operands[i].code == Operand::Kind::kJump) {
          if (word <= at) fail("jumps backwards");
          targets.push_back(word);
        } else {
          check(operands[i], word);
        }
      }
      last = opcode;
      at += words;
    }
    if (size == 0 || last != static_cast<uint32_t>(nodes::Op::End)) fail("does not end with End");
    for (uint32_t target : targets)
      if (target >= size || !starts[target]) fail("jumps to where no instruction starts");
  }

 private:
  static constexpr uint32_t kMaxRegisters = 1u << 22;

  [[noreturn]] void fail(const char* what) const {
    throw std::invalid_argument("the shader program of '" + program_.name + "' " + what);
  }

  // `count` floats from `offset` on exist among `size`.
  void within(uint64_t offset, uint64_t count, uint64_t size, const char* what) const {
    if (offset + count > size) fail(what);
  }

  void read(uint32_t word, uint32_t count) const {
    if (word & nodes::kConstant)
      within(word & ~nodes::kConstant, count, program_.constants.size(),
             "reads beyond its constants");
    else
      within(word, count, program_.registers, "reads beyond its registers");
  }

  uint64_t constant_count(uint64_t at) const {
    within(at, 1, program_.constants.size(), "has a table beyond its constants");
    const float count = program_.constants[at];
    if (!(count >= 2 && count <= 1e6f)) fail("has a table of an impossible length");
    return static_cast<uint64_t>(count);
  }

  void table(uint64_t at, uint64_t components) const {
    within(at + 1, constant_count(at) * components, program_.constants.size(),
           "has a table beyond its constants");
  }

  void profile(uint64_t at) const {
    const uint64_t h = constant_count(at), v = constant_count(at + 1);
    within(at + 2, h + v + h * v, program_.constants.size(), "has a table beyond its constants");
  }

  void check(const Operand& operand, uint32_t word) const {
    using Kind = Operand::Kind;
    switch (operand.code) {
      case Kind::kOutFloat:
      case Kind::kOutVector:
        if (word != nodes::kUnused)
          within(word, operand.code == Kind::kOutVector ? 3 : 1, program_.registers,
                 "writes beyond its registers");
        break;
      case Kind::kFloat: read(word, 1); break;
      case Kind::kVector: read(word, 3); break;
      case Kind::kMode:
        if (word >= operand.modes.size()) fail("has an unknown mode");
        break;
      case Kind::kNumber:
        if (word > 65535) fail("has a number out of range");
        break;
      case Kind::kTexture:
        if (word != nodes::kNone && word >= scene_.textures.size())
          fail("names a texture that does not exist");
        break;
      case Kind::kAttribute:
      case Kind::kJump: break;
      case Kind::kTable1: table(word, 1); break;
      case Kind::kTable3: table(word, 3); break;
      case Kind::kTable4: table(word, 4); break;
      case Kind::kMatrix:
        within(word, 12, program_.constants.size(), "has a table beyond its constants");
        break;
      case Kind::kProfile: profile(word); break;
    }
  }

  const Scene& scene_;
  const Program& program_;
};

}  // namespace

void check_program(const Scene& scene, const Program& program) { Checker(scene, program).run(); }

namespace {
std::optional<uint32_t> operand_of(nodes::Op op, const uint32_t* w, Operand::Kind kind,
                                   std::string_view name) {
  const auto& operands = nodes::operations()[static_cast<size_t>(op)].operands;
  for (size_t i = 0; i < operands.size(); ++i)
    if (operands[i].code == kind && std::string_view(operands[i].name) == name) return w[i];
  return {};
}

// The normal that a closure asks for: a register, or a constant that is zero where it has none.
std::optional<uint32_t> normal_of(nodes::Op op, const uint32_t* w) {
  return operand_of(op, w, Operand::Kind::kVector, "normal");
}

bool bends_subsurface(nodes::Op op, const uint32_t* w) {
  const auto normal = normal_of(op, w);
  return op == nodes::Op::BentNormal || (normal && !(*normal & nodes::kConstant));
}

// Whether a closure has a normal other than the surface's, which nothing need turn towards who sees
// it.
bool has_own_normal(const Program& program, nodes::Op op, const uint32_t* w,
                    std::string_view name) {
  const auto normal = operand_of(op, w, Operand::Kind::kVector, name);
  if (!normal || !(*normal & nodes::kConstant)) return normal.has_value();
  const float* n = &program.constants[*normal & ~nodes::kConstant];
  return n[0] != 0 || n[1] != 0 || n[2] != 0;
}

// A closure's number of that name, if it is a constant.
std::optional<float> constant_of(const Program& program, nodes::Op op, const uint32_t* w,
                                 std::string_view name) {
  const auto value = operand_of(op, w, Operand::Kind::kFloat, name);
  if (!value || !(*value & nodes::kConstant)) return {};
  return program.constants[*value & ~nodes::kConstant];
}

struct Mirrors {
  bool any = false, own = false;  // by a normal that it has of its own
};

// Whether a closure mirrors, or nearly, everywhere.
Mirrors mirrors(const Program& program, nodes::Op op, const uint32_t* w) {
  using enum nodes::Op;
  if (op != Glossy && op != Glass && op != Metallic && op != Principled) return {};
  const auto smooth = [&](std::string_view roughness) {
    return constant_of(program, op, w, roughness).value_or(1) <= Lobe::kTurned;
  };
  const bool base = smooth("roughness"), coat = op == Principled && smooth("coat_roughness") &&
                                                constant_of(program, op, w, "coat_weight") != 0.0f;
  return {base || coat, (base && has_own_normal(program, op, w, "normal")) ||
                            (coat && has_own_normal(program, op, w, "coat_normal"))};
}

// Whether it tells from which direction the surface is seen.
bool asks_view(nodes::Op op, const uint32_t* w) {
  using nodes::Coordinates, nodes::GeometryVector;
  switch (op) {
    case nodes::Op::Fresnel:
    case nodes::Op::LayerWeight: return true;
    case nodes::Op::Geometry: return static_cast<GeometryVector>(w[1]) == GeometryVector::INCOMING;
    case nodes::Op::TextureCoordinate:
      return static_cast<Coordinates>(w[1]) == Coordinates::REFLECTION;
    default: return false;
  }
}

// Or from which side.
bool asks_side(nodes::Op op, const uint32_t* w) {
  using nodes::Coordinates, nodes::GeometryVector;
  switch (op) {
    case nodes::Op::Backfacing: return true;
    case nodes::Op::Geometry:
      return asks_view(op, w) || static_cast<GeometryVector>(w[1]) == GeometryVector::NORMAL ||
             static_cast<GeometryVector>(w[1]) == GeometryVector::TRUE_NORMAL;
    case nodes::Op::TextureCoordinate:
      return asks_view(op, w) || static_cast<Coordinates>(w[1]) == Coordinates::NORMAL;
    default: return asks_view(op, w);
  }
}

}  // namespace

void look_at_program(Program& program) {
  using enum nodes::PathValue;
  if (program.features & kProgramSubsurface)
    for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
      const auto op = static_cast<nodes::Op>(program.code[at]);
      if (op == nodes::Op::BentNormal || op == nodes::Op::Principled || op == nodes::Op::Subsurface)
        program.bends_subsurface |= bends_subsurface(op, &program.code[at + 1]);
    }
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
    const auto op = static_cast<nodes::Op>(program.code[at]);
    if (op == nodes::Op::AmbientOcclusion || op == nodes::Op::Bevel || op == nodes::Op::Raycast)
      program.features |= kProgramMeetsItself;
  }
  program.asks_side = program.asks_view = program.has_own_normals = program.nearly_mirrors =
      program.own_mirrors = program.holds_out = false;
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
    const auto op = static_cast<nodes::Op>(program.code[at]);
    program.holds_out |= op == nodes::Op::Holdout;
    program.asks_side |= asks_side(op, &program.code[at + 1]);
    program.asks_view |= asks_view(op, &program.code[at + 1]);
    program.has_own_normals |= has_own_normal(program, op, &program.code[at + 1], "normal");
    const Mirrors found = mirrors(program, op, &program.code[at + 1]);
    program.nearly_mirrors |= found.any;
    program.own_mirrors |= found.own;
  }
  program.asks_shadow = program.asks_kind = program.asks_singular = program.asks_depth =
      program.asks_ray = program.asks_length = false;
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
    if (program.code[at] != static_cast<uint32_t>(nodes::Op::LightPath)) continue;
    program.asks_ray = true;
    const auto what = static_cast<nodes::PathValue>(program.code[at + 2]);
    program.asks_length |= what == RAY_LENGTH;
    program.asks_singular |= what == IS_SINGULAR_RAY;
    program.asks_depth |= what == RAY_DEPTH || what == DIFFUSE_DEPTH || what == GLOSSY_DEPTH ||
                          what == TRANSMISSION_DEPTH || what == TRANSPARENT_DEPTH;
    switch (what) {
      case IS_SHADOW_RAY: program.asks_shadow = true; break;
      case IS_DIFFUSE_RAY:
      case IS_GLOSSY_RAY:
      case IS_SINGULAR_RAY:
      case IS_REFLECTION_RAY:
      case IS_TRANSMISSION_RAY:
      case IS_VOLUME_SCATTER_RAY: program.asks_shadow = program.asks_kind = true; break;
      default: break;  // depths and lengths are guessed without choice
    }
  }
}

}  // namespace photon_splat
