// A mesh, or strands, in coordinates of its own.
#pragma once

#include <memory>

#include "geometry/attributes.h"
#include "geometry/bent_normals.h"
#include "geometry/mesh_array.h"
#include "geometry/motion.h"
#include "geometry/rounding.h"
#include "geometry/strands.h"
#include "geometry/surface_tree.h"
#include "math/sampling.h"
#include "textures/volume_grid.h"

namespace photon_splat {

// Volume grids that programs read by the id of an attribute.
struct MeshGrid {
  uint32_t id = 0;
  std::shared_ptr<const VolumeGrid> grid;
};

struct Mesh {
  LargeArray<Vec3> positions;
  MeshArray<Triangle> triangles;
  MeshArray<Vec3> corner_normals;  // 3 per triangle, or
  MeshArray<Vec3> vertex_normals;  // one per vertex; both empty: flat
  MeshArray<Vec2> uv;              // 3 per triangle (1 per strand), or empty
  std::vector<uint16_t> slots;     // per triangle, or empty
  std::vector<MeshAttribute> attributes;
  std::vector<MeshGrid> grids;  // of a volume object, whose bounds the triangles are
  GeneratedSpace generated;
  MeshMotion motion;
  Topology topology;
  std::unique_ptr<EdgeTree> edge_tree;
  std::unique_ptr<SurfaceTree> surface_tree;
  std::unique_ptr<Strands> strands;  // instead of triangles; slots are those of its segments
  std::vector<float> bent;           // bent_shares()
  float rounding = 0;                // the largest rounding_of() a triangle
  float farthest = 0;                // the largest coordinate

  float rounding_of(uint32_t triangle) const {
    const Triangle& t = triangles[triangle];
    const Vec3 a = positions[t[0]];
    return photon_splat::rounding_of(positions[t[1]] - a, positions[t[2]] - a);
  }
  // Makes topology, trees and what follows them from the others. Throws Cancelled.
  void describe_surface(ScratchMemory& scratch, const CancelFlag& cancel);

  const MeshAttribute* attribute(uint32_t id) const {
    for (const MeshAttribute& a : attributes)
      if (a.id == id) return &a;
    return nullptr;
  }
  Vec3 position(uint32_t vertex, float time) const;
  bool is_smooth() const { return !corner_normals.empty() || !vertex_normals.empty(); }
  // Normals of a triangle's three corners, in a row; `made` is where they are put that are not so
  // in memory. Not for a flat mesh.
  const Vec3* normals(uint32_t triangle, float time, Vec3 made[3]) const;
  // The same of a mesh at rest.
  const Vec3* normals(uint32_t triangle, Vec3 made[3]) const {
    return normals_of(triangle, corner_normals.data(),
                      vertex_normals.empty() ? nullptr : triangles.data(), vertex_normals.data(),
                      made);
  }
  // vertices: triangles of a mesh that has `of_vertices`, else null
  static const Vec3* normals_of(uint32_t triangle, const Vec3* of_corners, const Triangle* vertices,
                                const Vec3* of_vertices, Vec3 made[3]) {
    if (!vertices) return of_corners + 3 * static_cast<size_t>(triangle);
    for (int k = 0; k < 3; ++k) made[k] = of_vertices[vertices[triangle][k]];
    return made;
  }
  // Has normals of corners instead of those of vertices.
  void spread_normals(ThreadPool& pool);
};

}  // namespace photon_splat
