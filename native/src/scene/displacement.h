// True displacement: programs that move the vertices of a mesh, and the normals that it has then.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace photon_splat {

// What a material slot does to the surface.
struct SlotDisplacement {
  int program = -1;  // into Scene::programs; none: nothing moves
  // The material's bump does the rest: normals stay what they were
  bool bumps = false;
};

struct DisplacedMesh {
  std::vector<Vec3> positions;
  std::vector<Vec3> corner_normals;  // 3 per triangle, or
  std::vector<Vec3> vertex_normals;  // where corners at a vertex agree; both empty: flat everywhere
  size_t not_finite = 0;             // vertices that were to go nowhere, and stay where they are
};

// The mesh of an instance of a scene that is not built, moved in its own coordinates as Cycles does
// it: each vertex once, along the mesh's normals (which it must have), with what the first
// corner at it of a moving slot knows.
//   smooth       per triangle; empty: all
//   own_corners  its corner normals are more than those of its vertices: they keep their difference
//                to these
DisplacedMesh displace(Scene& scene, uint32_t instance, const std::vector<SlotDisplacement>& slots,
                       const std::vector<bool>& smooth, bool own_corners, const CancelFlag& cancel);

}  // namespace photon_splat
