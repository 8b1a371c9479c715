#include "density/cover.h"

#include "density/enclosure.h"

namespace photon_splat {
namespace {

constexpr float kTouching = 1e-3f;
constexpr int kMostInGap = 32;  // bounces of light below a cover
constexpr int kMostPanes = 8;   // that let light through, over a cover

}  // namespace

float length_of_look(const Vec3& y, float h) {
  return kCover * h - std::max(kTouching * h, ray_epsilon(y, h));
}

std::optional<Cover> cover_of(const Scene& scene, RayMask kinds, const Vec3& y, const Vec3& normal,
                              float h) {
  Surface hit;
  const float far = length_of_look(y, h);
  const Vec3 from = y + normal * (kCover * h);
  float near = 0;
  for (int pane = 0; pane < kMostPanes && near < far; ++pane) {
    if (!scene.intersect(from, -normal, near, far, false, hit, kinds)) return {};
    if (const auto gives = shines(scene, hit, normal)) return Cover{*gives, hit.back, hit.key};
    near = hit.distance + ray_epsilon(hit.position, hit.distance);
  }
  return {};
}

FromRim light_from_rim(const Scene& scene, RayMask kinds, const Vec3& y, const Vec3& normal,
                       float h, Random& random) {
  Vec3 from = y + normal * ray_epsilon(y, h),
       way = Basis(normal).to_world(sample_cosine_hemisphere(random.next2()));
  FromRim light = FromRim::kStraight;
  for (int bounce = 0; bounce < kMostInGap; ++bounce) {
    Surface hit;
    if (!scene.intersect(from, way, 0, h, false, hit, kinds)) return light;
    Bsdf bsdf(Transport::kRadiance, -way, hit.ng, hit.ns, hit.back);
    scene.shade(hit, -way, {}, bsdf);
    const Vec3 n = dot(hit.ng, way) < 0 ? hit.ng : -hit.ng,
               apart = n * ray_epsilon(hit.position, h);
    const float passes = max_abs(bsdf.transparency());
    if (passes > 0 && random.next() < passes) {
      from = hit.position - apart;
      continue;
    }
    if (!(random.next() * (1 - passes) < max_abs(bsdf.albedo()))) break;
    light = FromRim::kThrown;
    from = hit.position + apart;
    way = Basis(n).to_world(sample_cosine_hemisphere(random.next2()));
  }
  return FromRim::kNone;
}

}  // namespace photon_splat
