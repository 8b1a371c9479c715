// Ashikhmin and Shirley 2000, "An anisotropic Phong BRDF model": its glossy part, without Fresnel.
#include "bsdf/lobe.h"

namespace photon_splat {

namespace {

// The exponent whose highlight is about as wide as that of facets with the slope `alpha`; uniform
// half vectors at 1.
float exponent_of(float alpha) { return std::max(0.0f, 2 / sqr(std::max(alpha, 1e-4f)) - 2); }

}  // namespace

Lobe ashikhmin_shirley_lobe(const View& view, const Rgb& weight, const Vec3& normal,
                            const FacetShape& shape) {
  Lobe lobe = facet_lobe(view, weight, normal, shape, {});
  if (lobe.facets.delta()) return lobe;
  lobe.kind = LobeKind::kAshikhminShirley;
  lobe.p[0] = exponent_of(lobe.facets.ax), lobe.p[1] = exponent_of(lobe.facets.ay);
  lobe.p[2] = std::sqrt(std::sqrt(lobe.facets.ax * lobe.facets.ay));
  return lobe;
}

FacetValue evaluate_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, const Vec3& wi) {
  const Vec3 sum = wo + wi;
  const float len2 = length2(sum);
  if (!(len2 > 1e-16f)) return {};
  const Vec3 h = sum / std::sqrt(len2);
  const float oh = dot(wo, h), nu = lobe.p[0], nv = lobe.p[1];
  if (!(oh > 0)) return {};
  const float across2 = sqr(h.x) + sqr(h.y);
  const float exponent = across2 > 1e-14f ? (nu * sqr(h.x) + nv * sqr(h.y)) / across2 : nu;
  // Density of wi, 1/sr
  const float density =
      std::sqrt((nu + 1) * (nv + 1)) / (8 * kPi) * std::pow(saturate(h.z), exponent) / oh;
  return {lobe.weight * (density * wi.z / std::max(wi.z, wo.z)), density};
}

Vec3 sample_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, const Vec2& u) {
  const float nu = lobe.p[0], nv = lobe.p[1];
  // One quadrant's azimuth, tan phi = sqrt((nu + 1)/(nv + 1)) tan(pi x/2), mirrored into the
  // others.
  const float turn = 4 * u.x, x = turn - std::floor(turn), a = kPi / 2 * x;
  float c = std::sqrt(nv + 1) * std::cos(a), s = std::sqrt(nu + 1) * std::sin(a);
  const float r = std::sqrt(c * c + s * s);
  c /= r, s /= r;
  switch (static_cast<int>(turn) & 3) {
    case 1: c = -c; break;
    case 2: c = -c, s = -s; break;
    case 3: s = -s; break;
    default: break;
  }
  const float exponent = nu * sqr(c) + nv * sqr(s);
  const float z = std::pow(1 - std::min(u.y, 0.99999994f), 1 / (exponent + 1)),
              across = std::sqrt(std::max(0.0f, 1 - sqr(z)));
  const Vec3 h{across * c, across * s, z};
  const float oh = dot(wo, h);
  return oh > 0 ? h * (2 * oh) - wo : Vec3{0, 0, -1};
}

}  // namespace photon_splat
