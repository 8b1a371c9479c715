#include "bsdf/lobe.h"
#include "bsdf/tables.h"

namespace photon_splat {

Vec3 View::turned(const Vec3& normal) const {
  const float l2 = length2(normal);
  if (!(l2 > 1e-12f && l2 < 1e12f)) return ns;
  return std::abs(l2 - 1) < 1e-6f ? (back ? -normal : normal)
                                  : normal * ((back ? -1 : 1) / std::sqrt(l2));
}

float Lobe::roughness() const {
  switch (kind) {
    case LobeKind::kThinFacets:
    case LobeKind::kFacets: return facets.delta() ? 0 : std::sqrt(std::sqrt(facets.ax * facets.ay));
    case LobeKind::kAshikhminShirley: return p[2];
    case LobeKind::kToonGlossy: return std::sqrt(std::min(p[2], 1.0f));
    default: return 1;
  }
}

// In the plane of ng and n, with wo = (x, z) there and n at the angle a from ng, the mirror
// direction's height over the surface is x sin 2a + z cos 2a.
Vec3 valid_reflection(const View& view, const Vec3& n) {
  const float z = dot(view.wo, view.ng), ngn = dot(view.ng, n);
  const float least = std::min(0.9f * z, 0.01f);
  const Vec3 mirror = n * (2 * dot(n, view.wo)) - view.wo;
  if (!(z > 0) || dot(view.ng, mirror) >= least) return n;
  const Vec3 across = n - view.ng * ngn;
  const float across2 = length2(across);
  if (!(across2 > 1e-12f)) return n;
  const Vec3 axis = across / std::sqrt(across2);
  const float x = dot(view.wo, axis), r = std::sqrt(sqr(x) + sqr(z));
  const float a = 0.5f * (std::atan2(x, z) + std::acos(std::clamp(least / r, -1.0f, 1.0f)));
  return normalize(view.ng * std::cos(a) + axis * std::sin(a));
}

namespace {

// What a facet lobe of weight 1 reflects and refracts, about, if nothing is lost between facets.
FresnelValue layer_albedo(const FresnelTerms& f, float roughness, float mu) {
  if (f.kind == FresnelKind::kDielectric && f.ior != 1 && f.film_thickness <= kThinnestFilm) {
    const Rgb r = lerp(f.f0, f.f90, dielectric_rise(roughness, mu, f.ior));
    return {r * f.reflect_tint, (kWhite - r) * f.transmit_tint};
  }
  return evaluate_fresnel(f, mu);
}

float roughness_of(const Facets& facets) { return std::sqrt(std::sqrt(facets.ax * facets.ay)); }

Vec3 rotate(const Vec3& v, const Vec3& axis, float angle) {  // Rodrigues
  const float c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

}  // namespace

Lobe facet_lobe(const View& view, const Rgb& weight, const Vec3& normal, const FacetShape& shape,
                const FresnelTerms& fresnel) {
  Lobe lobe;
  lobe.kind = LobeKind::kFacets;
  lobe.weight = lobe.scale = weight;
  lobe.fresnel = fresnel;
  lobe.facets.beckmann = shape.beckmann;
  const bool through = !is_black(fresnel.transmit_tint);
  lobe.facets.ax = saturate(sqr(shape.roughness) * shape.along);
  lobe.facets.ay = saturate(sqr(shape.roughness) * shape.across);
  lobe.n = valid_reflection(view, normal);
  lobe.given = normal;
  Vec3 tangent = shape.tangent - lobe.n * dot(lobe.n, shape.tangent);
  const float length2_tangent = length2(tangent);
  if (shape.along != shape.across && length2_tangent > 1e-12f && length2_tangent < 1e12f) {
    tangent = tangent / std::sqrt(length2_tangent);
    lobe.t = shape.rotation != 0 ? rotate(tangent, lobe.n, 2 * kPi * shape.rotation) : tangent;
    lobe.b = cross(lobe.n, lobe.t);
  } else {
    const Basis basis(lobe.n);
    lobe.t = basis.tangent, lobe.b = basis.bitangent;
  }

  lobe.from = lobe.to_local(view.wo);
  lobe.masked = lobe.facets.lambda(lobe.from);
  Rgb kept = kWhite;
  const float mu = lobe.from.z, rough = roughness_of(lobe.facets);
  if (!(mu > 0)) lobe.weight = kept = {};
  if (shape.preserve_energy && !lobe.facets.delta() && mu > 0) {
    // Turquin 2019, "Practical multiple scattering compensation for microfacet models".
    const Albedo e = through ? glass_albedo(rough, mu, lobe.fresnel.ior) : ggx_albedo(rough, mu);
    const float missing = (1 - e.directional) / std::max(e.directional, 1e-3f);
    const auto scale = [&](float f) {
      return 1 + missing * f * e.mean / std::max(1 - f * (1 - e.mean), 1e-6f);
    };
    const Rgb f =
        saturate(through ? fresnel.transmit_tint : mean_reflectance(fresnel) * shape.between);
    const Rgb scales{scale(f.x), scale(f.y), scale(f.z)};
    lobe.weight *= scales;
    kept = scales * e.directional;
  }
  // It attenuates what is under it. Without energy compensation it is taken for as much as if none
  // were lost, as Cycles does (measured).
  const FresnelValue layer = layer_albedo(lobe.fresnel, rough, saturate(mu));
  lobe.layer = (layer.reflect + layer.transmit) * kept;
  lobe.albedo = average(weight * lobe.layer);
  return lobe;
}

void add_straight_glass(const View& view, const Rgb& weight, const Vec3& n, const FacetShape& shape,
                        FresnelTerms fresnel, LobeList& out) {
  if (fresnel.film_thickness <= kThinnestFilm)
    return out.go_straight(weight * fresnel.transmit_tint);
  const float cosine = saturate(dot(view.wo, valid_reflection(view, n)));
  out.go_straight(weight * evaluate_fresnel(fresnel, cosine).transmit);
  fresnel.transmit_tint = {};
  out.add([&] { return facet_lobe(view, weight, n, shape, fresnel); });
}

Rgb reflected_share(const Lobe& lobe) {
  const FresnelValue layer =
      layer_albedo(lobe.fresnel, roughness_of(lobe.facets), saturate(lobe.from.z));
  return divided(layer.reflect, layer.reflect + layer.transmit);
}

}  // namespace photon_splat
