// Writing shader programs in tests.
#pragma once

#include <map>

#include "bsdf/bsdf.h"
#include "shading/ops.h"
#include "support/meshes.h"

namespace photon_splat {

// Collects instructions; operands are given by name, those left out are 0, the first mode, or not
// wanted.
class ProgramWriter {
 public:
  using Values = std::map<std::string, uint32_t>;

  uint32_t reg(uint32_t floats = 3) {
    program_.registers += floats;
    return program_.registers - floats;
  }
  uint32_t constant(std::initializer_list<float> values) {
    const size_t at = program_.constants.size();
    for (float value : values) program_.constants.push_back(value);
    return static_cast<uint32_t>(at) | nodes::kConstant;
  }
  void emit(nodes::Op op, const Values& values) {
    using Kind = nodes::Operand::Kind;
    program_.code.push_back(static_cast<uint32_t>(op));
    for (const nodes::Operand& operand : nodes::operations()[static_cast<size_t>(op)].operands) {
      const auto given = values.find(operand.name);
      uint32_t word = 0;
      if (given != values.end())
        word = given->second;
      else if (operand.code == Kind::kOutFloat || operand.code == Kind::kOutVector)
        word = nodes::kUnused;
      else if (operand.code == Kind::kFloat || operand.code == Kind::kVector)
        word = constant({0, 0, 0});
      else if (operand.code == Kind::kTexture || operand.code == Kind::kAttribute)
        word = nodes::kNone;
      program_.code.push_back(word);
    }
  }
  // Emission of a vector, and the end.
  const Program& emitting(uint32_t color) {
    emit(nodes::Op::Emission, {{"weight", constant({1})}, {"color", color}});
    emit(nodes::Op::End, {});
    return program_;
  }
  Program& program() { return program_; }

 private:
  Program program_;
};

inline uint32_t word_of(auto mode) { return static_cast<uint32_t>(mode); }

// What a checked program emits at a point.
inline Rgb emitted(const Scene& scene, const Program& program, const ShadingPoint& point) {
  check_program(scene, program);
  Bsdf bsdf(Transport::kRadiance, point.wo, point.ng, point.ns, point.back);
  run_program(scene, program, point, bsdf);
  bsdf.finish();
  return bsdf.emission();
}

// Looking straight down onto triangle 0 of instance 0 of a flat scene, at barycentric (u, v).
inline ShadingPoint point_on(const Scene& scene, float u, float v, bool back = false) {
  const Mesh& mesh = scene.meshes[scene.instances[0].mesh];
  const Triangle& t = mesh.triangles[0];
  ShadingPoint point;
  point.position =
      mesh.positions[t[0]] * (1 - u - v) + mesh.positions[t[1]] * u + mesh.positions[t[2]] * v;
  point.ng = point.ns = point.wo = Vec3{0, 0, back ? -1.0f : 1.0f};
  point.back = back;
  point.instance = point.triangle = 0;
  point.u = u;
  point.v = v;
  point.ray.footprint = 0.01f;
  return point;
}

// The mesh of a cube [0, 1]^3 of a medium behind a surface that lets everything pass; its programs
// and its material are all that the scene has.
inline void add_cube_of(Scene& scene, const Program& medium) {
  ProgramWriter clear;
  clear.emit(nodes::Op::Transparent,
             {{"weight", clear.constant({1})}, {"color", clear.constant({1, 1, 1})}});
  clear.emit(nodes::Op::End, {});
  clear.program().features = kProgramTransparent;
  scene.programs = {clear.program(), medium};
  Material material;
  material.program = 0;
  material.volume = 1;
  scene.materials = {material};
  scene.meshes.push_back(padded(make_cube()));
}

}  // namespace photon_splat
