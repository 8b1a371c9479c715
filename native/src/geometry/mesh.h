// A mesh, or strands, in coordinates of its own.
#pragma once

#include <memory>

#include "geometry/attributes.h"
#include "geometry/motion.h"
#include "geometry/strands.h"
#include "geometry/surface_tree.h"
#include "textures/volume_grid.h"

namespace photon_splat {

// Volume grids that programs read by the id of an attribute.
struct MeshGrid {
  uint32_t id = 0;
  std::shared_ptr<const VolumeGrid> grid;
};

struct Mesh {
  LargeArray<Vec3> positions;
  LargeArray<Triangle> triangles;
  LargeArray<Vec3> corner_normals;  // 3 per triangle, or empty: flat
  LargeArray<Vec2> uv;              // 3 per triangle (1 per strand), or empty
  std::vector<uint16_t> slots;      // per triangle, or empty
  std::vector<MeshAttribute> attributes;
  std::vector<MeshGrid> grids;  // of a volume object, whose bounds the triangles are
  GeneratedSpace generated;
  MeshMotion motion;
  Topology topology;
  std::unique_ptr<EdgeTree> edge_tree;
  std::unique_ptr<SurfaceTree> surface_tree;
  std::unique_ptr<Strands> strands;  // instead of triangles; slots are those of its segments

  // Makes the last three from the others. Throws Cancelled.
  void describe_surface(const CancelFlag& cancel);

  const MeshAttribute* attribute(uint32_t id) const {
    for (const MeshAttribute& a : attributes)
      if (a.id == id) return &a;
    return nullptr;
  }
  Vec3 position(uint32_t vertex, float time) const;
  // Normals of a triangle's three corners, in a row; `moved` is where steps have some. Not for a
  // flat mesh.
  const Vec3* normals(uint32_t triangle, float time, Vec3 moved[3]) const;
};

}  // namespace photon_splat
