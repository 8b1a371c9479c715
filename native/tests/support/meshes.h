// Meshes and scenes for tests.
#pragma once

#include "scene/scene.h"

namespace photon_splat {

// An n x n grid of quads (2 triangles each) over [0, size]^2 at z = 0, facing +Z.
inline Mesh make_grid(int n, float size = 1) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      mesh.positions.push_back({size * float(i) / float(n), size * float(j) / float(n), 0});
  const auto at = [n](int i, int j) { return static_cast<uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      mesh.triangles.own().push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.own().push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

// A sphere of radius 1 by latitude and longitude, closed.
inline Mesh make_sphere(int rings, int segments) {
  Mesh mesh;
  mesh.positions.push_back({0, 0, 1});
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < segments; ++s) {
      const float theta = kPi * float(r) / float(rings), phi = 2 * kPi * float(s) / float(segments);
      mesh.positions.push_back(
          {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  mesh.positions.push_back({0, 0, -1});
  const auto at = [&](int r, int s) {
    return static_cast<uint32_t>(1 + (r - 1) * segments + s % segments);
  };
  const uint32_t last = static_cast<uint32_t>(mesh.positions.size() - 1);
  for (int s = 0; s < segments; ++s) {
    mesh.triangles.own().push_back({0, at(1, s), at(1, s + 1)});
    for (int r = 1; r + 1 < rings; ++r) {
      mesh.triangles.own().push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.own().push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
    mesh.triangles.own().push_back({at(rings - 1, s), last, at(rings - 1, s + 1)});
  }
  return mesh;
}

// A cube [0, 1]^3 of 12 triangles that share 8 vertices.
inline Mesh make_cube() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({float(i & 1), float(i >> 1 & 1), float(i >> 2)});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// Embree may read 16 bytes at the last vertex: a mesh that goes into a scene has one vertex more
// than it uses.
inline Mesh padded(Mesh mesh) {
  mesh.positions.push_back({});
  return mesh;
}

using Placement = std::array<double, 12>;  // rows of a 3x4 matrix
inline constexpr Placement identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

// Builds a scene of this mesh, placed once or several times.
inline void fill(Scene& scene, Mesh mesh, const std::vector<Placement>& places) {
  scene.materials.resize(1);
  scene.meshes.push_back(padded(std::move(mesh)));
  for (const Placement& place : places) scene.add_instance(0, place, {0});
  scene.build(CancelFlag());
}

}  // namespace photon_splat
