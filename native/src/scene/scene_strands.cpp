// What rays find on strands.
#include "scene/scene.h"

namespace photon_splat {

// Normals in the strands' own coordinates, as in Cycles. A ribbon faces the ray; `v` runs across it
// from -1 to 1 and says which normal a round one would have there.
void Scene::fill_strand(const RawHit& hit, const Vec3& direction, Surface& s) const {
  const Lookup& lookup = lookups_[hit.instance];
  const Strands& strands = *lookup.strands;
  s.back = false;
  Vec3 normal = hit.normal;
  if (strands.shape() == StrandShape::kRibbon) {
    const Affine to_local = lookup.shared ? pose_at(hit.instance, hit.time).to_local : Affine{};
    const Vec3 to_viewer = normalize(-to_local.vector(direction)),
               along = normalize(strands.tangent(hit.triangle, hit.u, hit.time));
    const Vec3 side = cross(along, to_viewer);
    const float wide = length(side), sine = std::clamp(hit.v, -1.0f, 1.0f);
    normal = wide > 0
                 ? side * (sine / wide) - cross(along, side) * (std::sqrt(1 - sine * sine) / wide)
                 : to_viewer;
    if (lookup.shared) normal = to_local.transposed_vector(normal);
  }
  // Normals of stretched balls too, as in Cycles
  if (lookup.shared && !strands.are_curves())
    normal = s.position - pose_at(hit.instance, hit.time)
                              .to_world.point(strands.key(hit.triangle, hit.time).position);
  normal = normalize(normal);
  if (dot(normal, direction) > 0) normal = -normal;       // within a round one
  s.ng = s.ns = is_finite(normal) ? normal : -direction;  // of what has no extent
  s.key = lookup.seed << 1;
  s.mark = Strands::mark(hit.instance, strands.strand(hit.triangle));
  s.rounding = 0;
}

}  // namespace photon_splat
