// What surfaces of a scene look like: their materials' programs, and light that passes through
// them.
#include "scene/scene.h"

#include "media/media.h"

namespace photon_splat {
namespace {

ShadingPoint shading_point(const Surface& s, const Vec3& wo, const RayInfo& ray) {
  ShadingPoint p;
  p.position = s.position;
  p.ng = s.ng;
  p.ns = s.ns;
  p.wo = wo;
  p.back = s.back;
  p.instance = s.instance;
  p.triangle = s.triangle;
  p.u = s.u;
  p.v = s.v;
  p.ray = ray;
  p.ray.length = s.distance - ray.from;
  return p;
}

RayInfo shadow_ray(const RayInfo& before) {
  RayInfo ray = before;
  ray.kind = RayInfo::kShadow;
  ++ray.depth;  // as of the next ray
  ray.singular = ray.through = false;
  ray.from = 0;
  return ray;
}

// The share of light that a surface on a shadow ray lets through; counts the surface.
Rgb let_through(const Scene& scene, const Surface& s, const Vec3& direction, RayInfo& ray) {
  if (!scene.may_be_transparent(s)) return {};
  Bsdf bsdf(Transport::kRadiance, -direction, s.ng, s.ns, s.back);
  run_program(scene, *s.program, shading_point(s, -direction, ray), bsdf);
  ++ray.transparent_depth;
  return bsdf.transparency();
}

}  // namespace

void Scene::shade(const Surface& s, const Vec3& wo, const RayInfo& ray, Bsdf& bsdf) const {
  if (s.on_strand()) {
    bsdf.gather_nothing();
    if (lookups_[s.instance].strands->are_curves()) bsdf.lose_subsurface();
  }
  if (s.program) {
    if (s.program->turns_mirrors()) bsdf.leave_out_turned();
    run_program(*this, *s.program, shading_point(s, wo, ray), bsdf);
  } else {
    const Vec3 front_normal = s.back ? -s.ns : s.ns;
    bsdf.add_diffuse(albedo(s), front_normal, 0);
    bsdf.add_emission(textured(s.side->emission, s.side->emission_texture, s));
  }
  bsdf.finish();
}

Surface Scene::other_side(const Surface& s) {
  Surface other = s;
  other.ng = -s.ng;
  other.ns = -s.ns;
  other.back = !s.back;
  return other;
}

Rgb Scene::lets_through(const Surface& s, const Vec3& direction, const RayInfo& ray) const {
  const Surface other = s.on_strand() ? s : other_side(s);
  Bsdf bsdf(Transport::kRadiance, direction, other.ng, other.ns, other.back);
  run_program(*this, *other.program, shading_point(other, direction, ray), bsdf);
  return bsdf.transparency();
}

Vec3 Scene::value_at(const Program& program, const Surface& s, const Vec3& wo, const RayInfo& ray,
                     std::vector<float>& registers) const {
  return run_displacement(*this, program, shading_point(s, wo, ray), registers);
}

Rgb Scene::emission_at(const Material& material, uint32_t instance, uint32_t triangle, float u,
                       float v, bool back, const Vec3& wo, float time, uint16_t depth,
                       float length) const {
  const MaterialSide& side = back ? material.back : material.front;
  if (material.program < 0 && side.emission_texture < 0) return side.emission;
  RayInfo ray{RayInfo::kEmission};
  ray.time = time;
  ray.depth = depth;
  Surface s = surface_at(instance, triangle, u, v, back, time);
  s.distance = length > 0 ? length : near_radius();
  return emission(s, wo, ray);
}

Rgb Scene::emission(const Surface& s, const Vec3& wo, const RayInfo& ray) const {
  if (!s.program) return textured(s.side->emission, s.side->emission_texture, s);
  if (!(s.program->features & kProgramEmits)) return {};
  Bsdf bsdf(Transport::kRadiance, wo, s.ng, s.ns, s.back);
  run_program(*this, *s.program, shading_point(s, wo, ray), bsdf);
  return max(bsdf.emission(), Rgb{});
}

Rgb Scene::transmittance(const Vec3& origin, const Vec3& direction, float far, const RayInfo& ray,
                         uint64_t blockers) const {
  const RayMask kinds = ray_mask(ray, RayInfo::kShadow);
  if (!blockers || !occluded(origin, direction, 0, far, kinds, ray.time, ray.left))
    return {1, 1, 1};
  if (!~blockers && !(features_ & kProgramTransparent)) return {};
  Rgb through{1, 1, 1};
  RayInfo info = shadow_ray(ray);
  Surface s;
  for (bool found = intersect(origin, direction, 0, far, false, s, kinds, ray.time, ray.left);
       found; found = intersect_past(s, origin, direction, far, false, kinds, ray.time, ray.left)) {
    if (!(blockers & instances[s.instance].group)) continue;
    through *= let_through(*this, s, direction, info);
    if (max_component(through) < 1e-6f) return {};
  }
  return through;
}

Rgb Scene::transmittance(const Vec3& origin, const Vec3& direction, float far, const RayInfo& ray,
                         uint64_t blockers, MediumStack around, Random& random) const {
  const RayMask kinds = ray_mask(ray, RayInfo::kShadow);
  RayInfo info = shadow_ray(ray);
  Rgb through{1, 1, 1};
  Surface s;
  bool found = intersect(origin, direction, 0, far, false, s, kinds, ray.time, ray.left);
  for (float begin = 0;;
       found = intersect_past(s, origin, direction, far, false, kinds, ray.time, ray.left)) {
    if (found) media_->meet_touched(s, origin, direction, kinds, ray.time);
    if (found && blockers & instances[s.instance].group) {
      through *= let_through(*this, s, direction, info);
      if (!(max_abs(through) > 0)) return {};
    }
    through *= media_->transmittance(media_->seen(around, kinds), origin, direction, begin,
                                     found ? s.distance : far, info, random);
    if (!found || max_abs(through) < 1e-6f) break;
    begin = s.distance;
    media_->cross(around, s, gap_at(s, origin, direction), ray.time);
  }
  return through;
}

Rgb Scene::textured(const Rgb& factor, int texture, const Surface& s) const {
  if (texture < 0) return factor;
  return factor * textures[texture].lookup(uv_at(s.instance, s.triangle, s.u, s.v));
}

}  // namespace photon_splat
