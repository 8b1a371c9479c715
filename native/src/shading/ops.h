// The list of operations (ops.def) as C++ sees it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace photon_splat::nodes {

#define MODE(name, ...) enum class name : uint32_t { __VA_ARGS__ };
#define OP(name, operands)
#include "shading/ops.def"
#undef MODE
#undef OP

enum class Op : uint32_t {
#define MODE(name, ...)
#define OP(name, operands) name,
#include "shading/ops.def"
#undef MODE
#undef OP
  kCount
};

inline constexpr uint32_t kUnused = 0x7fffffffu;  // an output that nobody wants
inline constexpr uint32_t kNone = 0xffffffffu;    // no texture, no attribute
inline constexpr uint32_t kConstant = 0x80000000u;

// What a word of an instruction means; the letters of ops.def.
struct Operand {
  enum class Kind : uint8_t {
    kOutFloat,
    kOutVector,
    kFloat,
    kVector,
    kMode,
    kNumber,
    kTexture,
    kAttribute,
    kJump,
    kTable1,
    kTable3,
    kTable4,
    kMatrix,
    kProfile
  };
  std::string kind;  // as in ops.def
  Kind code;
  std::string name;
  std::vector<std::string> modes;  // kMode: the identifiers, in order
};

struct Operation {
  std::string name;
  std::vector<Operand> operands;
};

const std::vector<Operation>& operations();  // by opcode

// Words of an instruction with its opcode.
constexpr uint32_t words_of(const char* operands) {
  uint32_t n = 1;
  for (; *operands; ++operands) n += *operands == ':';
  return n;
}
inline constexpr uint32_t kWords[] = {
#define MODE(name, ...)
#define OP(name, operands) words_of(operands),
#include "shading/ops.def"
#undef MODE
#undef OP
};

}  // namespace photon_splat::nodes
