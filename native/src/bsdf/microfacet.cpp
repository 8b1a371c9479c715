#include "bsdf/microfacet.h"

namespace photon_splat {

float Facets::density(const Vec3& m) const {
  const float s = sqr(m.x / ax) + sqr(m.y / ay), z2 = sqr(m.z);
  if (beckmann) {
    const float exponent = -s / z2;
    return exponent < -80 ? 0 : std::exp(exponent) / (kPi * ax * ay * sqr(z2));
  }
  return 1 / (kPi * ax * ay * sqr(s + z2));
}

float Facets::lambda(const Vec3& w) const {
  const float z2 = sqr(w.z), a2 = sqr(w.x * ax) + sqr(w.y * ay);  // a2/z2 = (alpha tan)^2
  if (!beckmann) return 0.5f * (std::sqrt(1 + a2 / std::max(z2, 1e-16f)) - 1);
  if (sqr(1.6f) * a2 <= z2) return 0;
  const float a = std::sqrt(z2 / a2);  // rational fit of Walter et al. 2007
  return ((0.396f * a - 1.259f) * a + 1) / ((2.181f * a + 3.535f) * a + 1e-12f);
}

Vec3 Facets::sample_visible(const Vec3& wo, const Vec2& u) const {
  if (beckmann) {
    // All facets, seen or not: pdf D(m) m.z.
    const float tan2 = -std::log(std::max(1 - u.x, 1e-20f)), phi = 2 * kPi * u.y;
    const float r = std::sqrt(tan2);
    return normalize({r * ax * std::cos(phi), r * ay * std::sin(phi), 1});
  }
  return visible(wo, sample_disk(u));
}

Vec3 Facets::visible(const Vec3& wo, const Vec2& d) const {
  // Heitz 2018, "Sampling the GGX distribution of visible normals".
  const Vec3 v = normalize({ax * wo.x, ay * wo.y, wo.z});
  const float len2 = sqr(v.x) + sqr(v.y);
  const Vec3 t1 = len2 > 1e-14f ? Vec3{-v.y, v.x, 0} / std::sqrt(len2) : Vec3{1, 0, 0};
  const Vec3 t2 = cross(v, t1);
  const float s = 0.5f * (1 + v.z), y = (1 - s) * std::sqrt(std::max(0.0f, 1 - sqr(d.x))) + s * d.y;
  const Vec3 n = t1 * d.x + t2 * y + v * std::sqrt(std::max(0.0f, 1 - sqr(d.x) - sqr(y)));
  return normalize({ax * n.x, ay * n.y, std::max(n.z, 1e-6f)});
}

bool refract(const Vec3& wo, const Vec3& m, float ior, Vec3* wi) {
  const float c = dot(wo, m), inverse = 1 / ior, k = 1 - sqr(inverse) * (1 - sqr(c));
  if (!(k > 0)) return false;
  *wi = m * (inverse * c - std::copysign(std::sqrt(k), c)) - wo * inverse;
  return true;
}

float reflect_probability(const FresnelValue& value) {
  const float r = average(value.reflect), t = average(value.transmit);
  return r + t > 0 ? r / (r + t) : 1;
}

namespace {

bool transmits(const FresnelTerms& f) { return !is_black(f.transmit_tint); }

}  // namespace

FacetValue evaluate_facets(const Facets& facets, const FresnelTerms& fresnel, const Vec3& wo,
                           float lambda_o, const Vec3& wi, bool lit) {
  const bool through = wi.z < 0, glass = transmits(fresnel);
  if (!(wo.z > 0) || wi.z == 0 || (through && !glass)) return {};
  Vec3 m = through ? -(wo + wi * fresnel.ior) : wo + wi;
  float len2 = length2(m);
  if (!(len2 > 1e-16f)) return {};
  m = m / std::sqrt(len2);
  if (m.z < 0) {  // refraction into the thinner medium gives m the other way round
    if (!through) return {};
    m = -m;
  }
  const float om = dot(wo, m), im = dot(wi, m);
  const bool reached = om > 0 && (through ? im < 0 : im > 0) && m.z > 0;
  if (!reached && !(through && lit && om != 0)) return {};
  const FresnelValue value = evaluate_fresnel(fresnel, std::abs(om));
  const float p = glass ? reflect_probability(value) : 1;
  const float lambda_i = facets.lambda(wi);
  // Density of wi per density of visible facets, times D/|wo.n|.
  const float d = facets.density(m);
  const float common = d / wo.z * (through ? sqr(fresnel.ior) * std::abs(om * im) / len2 : 0.25f);
  const float choice = through ? 1 - p : p;
  float pdf = common * choice / (1 + lambda_o);
  if (facets.beckmann && reached) pdf = common * choice * m.z * wo.z / om;
  return {(through ? value.transmit : value.reflect) * (common / (1 + lambda_o + lambda_i)), pdf};
}

bool sample_facets(const Facets& facets, const FresnelTerms& fresnel, const Vec3& wo, float choice,
                   const Vec2& u, Vec3* wi) {
  if (!(wo.z > 0)) return false;
  const Vec3 m = facets.delta() ? Vec3{0, 0, 1} : facets.sample_visible(wo, u);
  const float om = dot(wo, m);
  if (!(om > 0)) return false;
  if (!transmits(fresnel) || choice < reflect_probability(evaluate_fresnel(fresnel, om))) {
    *wi = m * (2 * om) - wo;
    return wi->z > 0;
  }
  return refract(wo, m, fresnel.ior, wi) && wi->z < 0;
}

}  // namespace photon_splat
