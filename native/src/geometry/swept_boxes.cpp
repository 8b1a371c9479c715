#include "geometry/swept_boxes.h"

namespace photon_splat {
namespace {

bool holds(const Bounds& b, const Vec3& x) {
  return x.x >= b.lower.x && x.y >= b.lower.y && x.z >= b.lower.z && x.x <= b.upper.x &&
         x.y <= b.upper.y && x.z <= b.upper.z;
}

}  // namespace

SweptBoxes::SweptBoxes(std::vector<Bounds> boxes) {
  std::erase_if(boxes, [](const Bounds& b) { return b.empty(); });
  nodes_.reserve(2 * boxes.size());
  if (!boxes.empty()) build(boxes.data(), boxes.data() + boxes.size());
}

void SweptBoxes::build(Bounds* first, Bounds* end) {
  const size_t index = nodes_.size();
  Bounds all;
  for (const Bounds* b = first; b != end; ++b) all.add(*b);
  nodes_.push_back({all});
  if (end - first == 1) return;
  const Vec3 extent = all.upper - all.lower;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  Bounds* const middle = first + (end - first) / 2;
  std::nth_element(first, middle, end, [axis](const Bounds& a, const Bounds& b) {
    return a.center()[axis] < b.center()[axis];
  });
  build(first, middle);
  nodes_[index].right = static_cast<uint32_t>(nodes_.size());
  build(middle, end);
}

bool SweptBoxes::hold(const Vec3& x) const {
  uint32_t stack[64], depth = 0;
  if (!nodes_.empty()) stack[depth++] = 0;
  while (depth) {
    const uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (!holds(node.bounds, x)) continue;
    if (!node.right) return true;
    stack[depth++] = node.right;
    stack[depth++] = index + 1;
  }
  return false;
}

}  // namespace photon_splat
