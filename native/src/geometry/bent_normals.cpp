#include "geometry/bent_normals.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh.h"

namespace photon_splat {
namespace {

constexpr float kBent = 0.87f;  // cosine of 30 degrees

struct Areas {
  double bent = 0, all = 0;
};

}  // namespace

std::vector<float> bent_shares(const Mesh& mesh) {
  if (!mesh.is_smooth() || mesh.strands) return {};
  std::vector<Areas> slots(1);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    const Vec3 origin = mesh.positions[corners[0]];
    const Vec3 face =
        cross(mesh.positions[corners[1]] - origin, mesh.positions[corners[2]] - origin);
    const float area = length(face);
    if (!(area > 0)) continue;
    Vec3 made[3];
    const Vec3* n = mesh.normals(t, made);
    const float cosines = dot(n[0], face) / length(n[0]) + dot(n[1], face) / length(n[1]) +
                          dot(n[2], face) / length(n[2]);
    const size_t slot = mesh.slots.empty() ? 0 : mesh.slots[t];
    if (slot >= slots.size()) slots.resize(slot + 1);
    slots[slot].all += area;
    if (std::abs(cosines) < 3 * kBent * area) slots[slot].bent += area;
  }
  if (std::ranges::none_of(slots, [](const Areas& a) { return a.bent > 0; })) return {};
  std::vector<float> out;
  for (const Areas& a : slots) out.push_back(a.all > 0 ? static_cast<float>(a.bent / a.all) : 0);
  return out;
}

}  // namespace photon_splat
