// Where moving things come by.
#pragma once

#include <vector>

#include "math/vec.h"

namespace photon_splat {

// Boxes in a tree, to be asked for a point.
class SweptBoxes {
 public:
  explicit SweptBoxes(std::vector<Bounds> boxes);
  bool hold(const Vec3& x) const;

 private:
  struct Node {
    Bounds bounds;
    uint32_t right = 0;  // second child, the first being the next node; 0: a box itself
  };
  void build(Bounds* first, Bounds* end);

  std::vector<Node> nodes_;
};

}  // namespace photon_splat
