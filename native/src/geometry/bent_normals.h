// How much of a mesh is shaded as another shape than its triangles have: a cube shaded smooth.
#pragma once

#include <vector>

namespace photon_splat {

struct Mesh;

// By slot the share of its area whose normals are bent off the triangles' own by more than 30
// degrees (mean of the corners' cosines). Empty: none anywhere.
std::vector<float> bent_shares(const Mesh& mesh);

}  // namespace photon_splat
