#include "shading/ops.h"

#include <array>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace photon_splat::nodes {
namespace {

using Modes = std::map<std::string, std::vector<std::string>>;

// "A, B, C" -> A B C, with D2 turned into 2D.
std::vector<std::string> split_modes(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream in(list);
  for (std::string name; std::getline(in >> std::ws, name, ',');) {
    if (name.size() == 2 && name[0] == 'D' && name[1] >= '1' && name[1] <= '4')
      name = {name[1], 'D'};
    names.push_back(name);
  }
  return names;
}

const Modes& modes() {
  static const Modes known{
#define MODE(name, ...) {#name, split_modes(#__VA_ARGS__)},
#define OP(name, operands)
#include "shading/ops.def"
#undef MODE
#undef OP
  };
  return known;
}

Operand::Kind kind_of(const std::string& letters) {
  using Kind = Operand::Kind;
  static const std::map<std::string, Kind> kinds{
      {"F", Kind::kOutFloat}, {"V", Kind::kOutVector}, {"f", Kind::kFloat},
      {"v", Kind::kVector},   {"m", Kind::kMode},      {"n", Kind::kNumber},
      {"t", Kind::kTexture},  {"a", Kind::kAttribute}, {"j", Kind::kJump},
      {"T1", Kind::kTable1},  {"T3", Kind::kTable3},   {"T4", Kind::kTable4},
      {"M", Kind::kMatrix},   {"P", Kind::kProfile}};
  return kinds.at(letters);
}

Operation parse(const char* name, const char* spec) {
  Operation operation{name, {}};
  std::istringstream in(spec);
  for (std::string word; in >> word;) {
    const size_t colon = word.find(':'), equals = word.find('=');
    Operand operand;
    operand.kind = word.substr(0, colon);
    operand.code = kind_of(operand.kind);
    operand.name =
        word.substr(colon + 1, equals == std::string::npos ? equals : equals - colon - 1);
    if (equals != std::string::npos) operand.modes = modes().at(word.substr(equals + 1));
    operation.operands.push_back(std::move(operand));
  }
  return operation;
}

}  // namespace

const std::vector<Operation>& operations() {
  static const std::vector<Operation> all{
#define MODE(name, ...)
#define OP(name, operands) parse(#name, operands),
#include "shading/ops.def"
#undef MODE
#undef OP
  };
  return all;
}

}  // namespace photon_splat::nodes
