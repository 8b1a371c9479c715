#include "shading/sees_view.h"

#include <algorithm>

#include "shading/ops.h"

namespace photon_splat {
namespace {

constexpr const char* kSeeing[] = {"CAMERA", "WINDOW"};

bool is_seeing(const nodes::Operand& operand, uint32_t word) {
  if (operand.code != nodes::Operand::Kind::kMode) return false;
  return std::any_of(std::begin(kSeeing), std::end(kSeeing),
                     [&](const char* mode) { return operand.modes[word] == mode; });
}

}  // namespace

bool sees_view(const Program& program) {
  for (size_t at = 0; at < program.code.size(); at += nodes::kWords[program.code[at]]) {
    if (program.code[at] == static_cast<uint32_t>(nodes::Op::CameraData)) return true;
    const auto& operands = nodes::operations()[program.code[at]].operands;
    for (size_t i = 0; i < operands.size(); ++i)
      if (is_seeing(operands[i], program.code[at + 1 + i])) return true;
  }
  return false;
}

}  // namespace photon_splat
