#include "density/cover.h"

#include "density/enclosure.h"

namespace photon_splat {
namespace {

constexpr float kTouching = 1e-3f;
constexpr int kMostInGap = 32;  // bounces of light below a cover

}  // namespace

float length_of_look(const Vec3& y, float h) {
  return kCover * h - std::max(kTouching * h, ray_epsilon(y, h));
}

std::optional<Cover> cover_of(const Scene& scene, RayMask kinds, const Vec3& y, const Vec3& normal,
                              float h) {
  Surface hit;
  const float far = length_of_look(y, h);
  if (!(far > 0) || !scene.intersect(y + normal * (kCover * h), -normal, 0, far, false, hit, kinds))
    return {};
  const auto gives = shines(scene, hit, normal);
  if (!gives) return {};
  return Cover{*gives, hit.back, hit.key};
}

FromRim light_from_rim(const Scene& scene, RayMask kinds, const Vec3& y, const Vec3& normal,
                       float h, Random& random) {
  Vec3 from = y + normal * ray_epsilon(y, h), n = normal;
  for (int bounce = 0; bounce < kMostInGap; ++bounce) {
    const Vec3 way = Basis(n).to_world(sample_cosine_hemisphere(random.next2()));
    Surface hit;
    if (!scene.intersect(from, way, 0, h, false, hit, kinds))
      return bounce ? FromRim::kThrown : FromRim::kStraight;
    Bsdf bsdf(Transport::kRadiance, -way, hit.ng, hit.ns, hit.back);
    scene.shade(hit, -way, {}, bsdf);
    if (!(random.next() < max_abs(bsdf.albedo()))) break;
    n = dot(hit.ng, way) < 0 ? hit.ng : -hit.ng;
    from = hit.position + n * ray_epsilon(hit.position, h);
  }
  return FromRim::kNone;
}

}  // namespace photon_splat
