// Shadow linking: light that passes through what blocks the light of others.
#include "lights/lights.h"

namespace photon_splat {

// Light samples pass the same surfaces, so both ways of finding a light see the same light.
// Surfaces of the emitter itself block or not like any other: each place where the ray meets it
// counts.
Rgb Lights::linked_met(const Receiver& to, const Vec3& origin, const Vec3& direction,
                       float bsdf_pdf, const RayInfo& ray, const Through& through,
                       GroupLight* groups) const {
  Rgb sum{};
  const auto add = [&](const Rgb& light, const Emitter& e) {
    sum += light;
    if (groups) groups->add(light, e.light_group);
  };
  bool meshes = false;
  for (const uint32_t i : shadow_linked_) {
    const Emitter& e = emitters_[i];
    if (!(e.lit_groups & to.group)) continue;
    if (e.lamp < 0) {
      meshes = true;
      continue;
    }
    float distance = INFINITY;
    const Rgb light = lamp_met(i, to, direction, 0, INFINITY, bsdf_pdf, &distance);
    if (!is_black(light)) add(light * through(distance * (1 - 1e-5f), e.blockers), e);
  }
  Surface s;
  RayInfo info = ray;
  const RayMask kinds = ray_mask(ray);
  for (bool found =
           meshes && scene_.intersect(origin, direction, 0, INFINITY, false, s, kinds, to.time);
       found;
       found = scene_.intersect_past(s, origin, direction, INFINITY, false, kinds, to.time)) {
    const int32_t index = emitter_of_instance_[s.instance];
    if (index < 0) continue;
    const Emitter& e = emitters_[index];
    if (!~e.blockers || !(e.lit_groups & to.group)) continue;
    info.length = s.distance;
    Rgb light = scene_.emission(s, -direction, info);
    if (!is_black(light)) light *= mesh_mis_weight(index, to, s, bsdf_pdf);
    if (is_black(light)) continue;
    const float far = s.distance - ray_epsilon(s.position, s.distance);
    add(far > 0 ? light * through(far, e.blockers) : light, e);
  }
  return sum;
}

}  // namespace photon_splat
