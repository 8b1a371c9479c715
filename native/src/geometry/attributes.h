// What shader programs read from meshes and instances beyond positions, normals and the
// render-active UV map. Only what some program asks for is exported; ids are the exporter's and
// mean the same on every mesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/mesh_array.h"
#include "math/vec.h"

namespace photon_splat {

struct MeshAttribute {
  enum class Domain : uint8_t { kPoint, kCorner, kFace };

  uint32_t id = 0;
  Domain domain = Domain::kPoint;
  uint32_t components = 1;  // 1 to 4
  // Element after element (corner: 3 per triangle; face: per triangle), or
  MeshArray<float> floats;
  // sRGB-encoded RGBA (the fourth linear), decoded before interpolation
  std::vector<uint8_t> bytes;

  // Value at barycentric (u, v) of a triangle, which may lie outside of it; absent components 0.
  std::array<float, 4> at(const std::array<uint32_t, 3>& vertices, uint32_t triangle, float u,
                          float v) const;
  // Exchanges the values of two corners; nothing where the domain is another.
  void swap_corners(size_t a, size_t b);
};

// Per instance, in the order of Scene::instances.
struct InstanceAttribute {
  uint32_t id = 0, components = 1;
  std::vector<float> values;
};

// How a mesh's own coordinates become Blender's Generated ones: position * scale + offset.
struct GeneratedSpace {
  Vec3 scale{1, 1, 1}, offset{};
};

}  // namespace photon_splat
