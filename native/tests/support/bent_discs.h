// Bent surfaces, and kernel discs on them by their definition.
#pragma once

#include "density/point_block.h"
#include "support/meshes.h"

namespace photon_splat {

// An n x n grid with waves whose least radius of curvature is about a quarter.
inline Mesh make_waves(int n) {
  Mesh mesh = make_grid(n);
  for (Vec3& p : mesh.positions) p.z = 0.06f * std::sin(8 * p.x) * std::cos(7 * p.y);
  return mesh;
}

// Every triangle about x in `cut` squared parts: add(place, squared distance from x in h^2, area
// times the weight of its normal, in units of the flat kernel's sum).
template <class Add>
void sum_over_disc(const Scene& scene, uint32_t instance, const Vec3& x, const Vec3& normal,
                   float h, int cut, Add&& add) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  for (const Triangle& t : mesh.triangles) {
    Vec3 corner[3];
    for (int i = 0; i < 3; ++i) corner[i] = placed.to_world.point(mesh.positions[t[i]]);
    if (std::min({length2(corner[0] - x), length2(corner[1] - x), length2(corner[2] - x)}) >
        4 * h * h)
      continue;
    const Vec3 n =
        cross(corner[1] - corner[0], corner[2] - corner[0]) * (placed.mirrored ? -1.0f : 1.0f);
    const double weight = std::clamp(kNormalWeightSlope * dot(n, normal) / length(n), 0.0f, 1.0f);
    const double part = weight * 0.5 * length(n) / (double(cut) * cut) * 2 / (M_PI * double(h) * h);
    const auto add_at = [&](float u, float v) {
      const Vec3 y = corner[0] + (corner[1] - corner[0]) * u + (corner[2] - corner[0]) * v;
      add(y, length2(y - x) / (double(h) * h), part);
    };
    for (int j = 0; j < cut; ++j)
      for (int i = 0; i + j < cut; ++i) {
        add_at((float(i) + 1.0f / 3) / float(cut), (float(j) + 1.0f / 3) / float(cut));
        if (i + j + 1 < cut)
          add_at((float(i) + 2.0f / 3) / float(cut), (float(j) + 2.0f / 3) / float(cut));
      }
  }
}

}  // namespace photon_splat
