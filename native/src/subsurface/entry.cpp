#include "subsurface/entry.h"

#include "bsdf/microfacet.h"

namespace photon_splat {
namespace {

constexpr float kDiffuseShare = 0.5f;  // of skin

Vec3 local(const Basis& basis, const Vec3& v) {
  return {dot(v, basis.tangent), dot(v, basis.bitangent), dot(v, basis.normal)};
}

Facets rough_facets(const Subsurface& closure) {
  const float alpha = std::max(closure.alpha, kRough);
  return {false, alpha, alpha};
}

// Density of `to` among what facets refract of `from`, in the frame of their normal, from.z > 0;
// `ior`: index there over index here. Walter et al. 2007, section 5.3, for visible facets.
float refraction_pdf(const Facets& facets, const Vec3& from, const Vec3& to, float ior) {
  if (!(from.z > 0) || !(to.z < 0)) return 0;
  Vec3 m = -(from + to * ior);
  const float len2 = length2(m);
  if (!(len2 > 1e-16f)) return 0;
  m = m / std::sqrt(len2);
  if (m.z < 0) m = -m;
  const float c = dot(from, m), there = -dot(to, m);
  if (!(c > 0) || !(there > 0)) return 0;
  return facets.density(m) / from.z * sqr(ior) * c * there / len2 / (1 + facets.lambda(from));
}

}  // namespace

bool sample_entry(const Subsurface& closure, const Vec3& wo, Vec2 u, Vec3* wi) {
  const Basis basis(closure.n);
  if (closure.method == SubsurfaceMethod::kRandomWalkSkin) {
    if (u.x < kDiffuseShare) {
      *wi = -basis.to_world(sample_cosine_hemisphere({u.x / kDiffuseShare, u.y}));
      return true;
    }
    u.x = (u.x - kDiffuseShare) / (1 - kDiffuseShare);
  }
  const Vec3 from = local(basis, wo);
  if (!(from.z > 0)) return false;
  const Facets facets{false, closure.alpha, closure.alpha};
  Vec3 into;
  if (!refract(from, facets.sample_visible(from, u), closure.ior, &into)) return false;
  *wi = basis.to_world(into);
  return true;
}

float entry_pdf(const Subsurface& closure, const Vec3& wo, const Vec3& wi) {
  const Basis basis(closure.n);
  const Vec3 to = local(basis, wi);
  const float refracted = refraction_pdf(rough_facets(closure), local(basis, wo), to, closure.ior);
  if (closure.method != SubsurfaceMethod::kRandomWalkSkin) return refracted;
  return kDiffuseShare * std::max(-to.z, 0.0f) / kPi + (1 - kDiffuseShare) * refracted;
}

// Half of it as a diffuse surface scatters it, so that no direction is rare.
std::optional<Leaving> sample_leaving(const Subsurface& closure, const Vec3& n, const Vec3& ng,
                                      const Vec3& wi, float choice, const Vec2& u) {
  const Basis inside(-n);
  const Vec3 from = local(inside, wi);
  const Facets facets = rough_facets(closure);
  Vec3 wo;
  if (choice < 0.5f) {
    wo = Basis(ng).to_world(sample_cosine_hemisphere(u));
  } else {
    Vec3 out;
    if (!(from.z > 0) || !refract(from, facets.sample_visible(from, u), 1 / closure.ior, &out))
      return std::nullopt;
    wo = inside.to_world(out);
  }
  const float cosine = dot(wo, ng);
  if (!(cosine > 0)) return std::nullopt;
  const float refracted = refraction_pdf(facets, from, local(inside, wo), 1 / closure.ior);
  return Leaving{wo, 0.5f * (cosine / kPi + refracted)};
}

}  // namespace photon_splat
