// Diffuse-like lobes: Lambert, Oren-Nayar, translucent, sheen, velvet, toon.
#include "bsdf/lobe.h"

namespace photon_splat {
namespace {

Lobe make(LobeKind kind, const Rgb& weight, const Vec3& n) {
  Lobe lobe;
  lobe.kind = kind;
  lobe.weight = weight;
  lobe.albedo = average(weight);
  const Basis basis(n);
  lobe.n = n, lobe.t = basis.tangent, lobe.b = basis.bitangent;
  return lobe;
}

}  // namespace

Lobe lambert_lobe(const Rgb& weight, const Vec3& n) {
  Lobe lobe = make(LobeKind::kLambert, weight, n);
  lobe.gather = weight;
  return lobe;
}

Lobe translucent_lobe(const View& view, const Rgb& weight, const Vec3& n) {
  Lobe lobe = make(LobeKind::kTranslucent, weight, valid_reflection(view, n));
  lobe.gather = weight;
  return lobe;
}

// Directions w above n and below the bump's horizon, in proportion to its -bump . w. n and bump
// span a plane, and its normal is the frame's t: w = sin(a) t + cos(a) v with v in the plane, and
// the density is cos(a)^2 sin(f), f being the angle of v below the horizon.
Lobe below_bump_lobe(const Vec3& n, const Vec3& bump, bool through) {
  Lobe lobe;
  lobe.kind = through ? LobeKind::kBelowBumpThrough : LobeKind::kBelowBump;
  lobe.weight = {};
  lobe.albedo = 0;
  lobe.n = through ? -n : n;
  lobe.t = normalize(cross(n, bump));
  lobe.b = bump;
  lobe.p[0] = kPi / 4 * length2(bump - n);
  return lobe;
}

namespace {

// Integral over the hemisphere of the improved Oren-Nayar model's second term (Fujii, "A tiny
// improvement of Oren-Nayar reflectance model"): with A and B of the model, its directional albedo
// is pi A + B G(mu).
float oren_nayar_g(float mu) {
  const float s = std::sqrt(std::max(0.0f, 1 - sqr(mu)));
  if (mu < 1e-4f) return kPi / 2 - 2.0f / 3 - mu;
  return s * (std::acos(std::min(mu, 1.0f)) - 2.0f / 3 - s * mu) +
         2.0f / 3 * s / mu * (1 - s * s * s);
}

}  // namespace

// Energy-preserving Oren-Nayar (Fujii's model; compensation as in Portsmouth et al. 2025, "EON").
Lobe oren_nayar_lobe(const View& view, const Rgb& weight, const Vec3& n, float roughness,
                     const Rgb& color) {
  Lobe lobe = make(LobeKind::kOrenNayar, weight, n);
  const float a = 1 / (kPi + roughness * (kPi / 2 - 2.0f / 3)), b = roughness * a;
  const float e_mean = kPi * a + b * (2 * kPi - 5.6f) / 3;
  const float e_view = kPi * a + b * oren_nayar_g(std::max(0.0f, dot(n, view.wo)));
  const float lost = std::max(0.0f, 1 - e_mean);
  const auto multiple = [&](float c) {
    return c * c * e_mean / std::max(lost, 1e-6f) / (kPi * (1 - c * lost));
  };
  lobe.p[0] = a, lobe.p[1] = b, lobe.p[2] = std::max(0.0f, 1 - e_view);
  const Rgb c = saturate(color);
  lobe.multiple = {multiple(c.x), multiple(c.y), multiple(c.z)};
  lobe.gather = weight * (kWhite * e_mean + lobe.multiple * (kPi * lost * lost));
  return lobe;
}

namespace {

// A layer of fibres as a linearly transformed cosine (Zeltner et al. 2022, "Practical
// multiple-scattering sheen using linearly transformed cosines"): the inverse transform's a and b
// and the albedo. Measured on renders by Cycles.
constexpr int kSheenSteps = 32;
constexpr int16_t kSheen[kSheenSteps][kSheenSteps][3] = {
#include "bsdf/sheen_table.inc"
};

}  // namespace

Lobe sheen_lobe(const View& view, const Rgb& weight, const Vec3& n, float roughness) {
  Lobe lobe = make(LobeKind::kSheen, weight, n);
  const float x = saturate(dot(n, view.wo)) * (kSheenSteps - 1),
              y = saturate(roughness) * (kSheenSteps - 1);
  const int i = std::min(static_cast<int>(x), kSheenSteps - 2),
            j = std::min(static_cast<int>(y), kSheenSteps - 2);
  const float s = x - static_cast<float>(i), t = y - static_cast<float>(j);
  float value[3];
  for (int k = 0; k < 3; ++k)
    value[k] = 1e-4f * ((1 - t) * ((1 - s) * kSheen[j][i][k] + s * kSheen[j][i + 1][k]) +
                        t * ((1 - s) * kSheen[j + 1][i][k] + s * kSheen[j + 1][i + 1][k]));
  const Vec3 across = view.wo - n * dot(n, view.wo);
  if (length2(across) > 1e-10f) lobe.t = normalize(across), lobe.b = cross(n, lobe.t);
  lobe.p[0] = value[0], lobe.p[1] = value[1];
  lobe.weight *= value[2];
  lobe.albedo *= value[2];
  lobe.gather = lobe.weight;
  return lobe;
}

Lobe velvet_lobe(const View& view, const Rgb& weight, const Vec3& n, float sigma) {
  Lobe lobe = make(LobeKind::kVelvet, weight, n);
  lobe.p[0] = 1 / sqr(std::max(sigma, 0.01f));
  if (!(dot(n, view.wo) > 0)) lobe.weight = {}, lobe.albedo = 0;
  return lobe;
}

Lobe toon_lobe(const Rgb& weight, const Vec3& n, bool glossy, float size, float smooth) {
  Lobe lobe = make(glossy ? LobeKind::kToonGlossy : LobeKind::kToonDiffuse, weight, n);
  const float reach = std::min((size + smooth) * kPi / 2, kPi / 2);
  lobe.p[0] = std::max(size * kPi / 2, 5e-3f);  // nothing smaller: a cone must hold something
  lobe.p[1] = smooth * kPi / 2;
  // 1 - cos of the cone
  lobe.p[2] = std::max(2 * sqr(std::sin(0.5f * std::max(reach, 1e-3f))), 1e-6f);
  return lobe;
}

namespace {

// Softens the terminator that a bumped normal draws (Estevez et al. 2019, "A microfacet-based
// shadowing function to solve the bump terminator problem"): the bump as a GGX surface of its own.
float bump_shadow(const View& view, const Vec3& n, const Vec3& wi) {
  const float d = dot(view.bent, n), i = dot(view.bent, wi);
  if (d > 1 - 1e-6f) return 1;
  if (!(d >= 0 && i > 1e-6f)) return 0;
  const float alpha2 = saturate(0.125f * (1 / sqr(d) - 1)), tan2 = std::max(1 / sqr(i) - 1, 0.0f);
  return 2 / (1 + std::sqrt(1 + alpha2 * tan2));
}

float toon_intensity(const Lobe& lobe, float angle) {
  if (angle < lobe.p[0]) return 1;
  return angle < lobe.p[0] + lobe.p[1] ? 1 - (angle - lobe.p[0]) / lobe.p[1] : 0;
}

Vec3 toon_axis(const Lobe& lobe, const Vec3& wo) {
  return lobe.kind == LobeKind::kToonGlossy ? lobe.n * (2 * dot(lobe.n, wo)) - wo : lobe.n;
}

// A place x, y in the unit disc has x as sin(a) is spread, and y's share of its range whatever x
// is.
Vec3 sample_below_bump(const Lobe& lobe, const Vec2& u) {
  const float r = std::sqrt(u.x), x = r * std::cos(2 * kPi * u.y), y = r * std::sin(2 * kPi * u.y);
  const float width = std::sqrt(std::max(0.0f, 1 - x * x));
  const float share = width > 0 ? saturate(0.5f * (y / width + 1)) : 0.5f;
  const float fall = share * lobe.p[0] * (2 / kPi);  // 1 - cos(f)
  const float cosine = 1 - fall, sine = std::sqrt(std::max(0.0f, fall * (2 - fall)));
  const Vec3 along = cross(lobe.b, lobe.t);  // the bump's horizon, above n's
  return normalize(lobe.t * x + (along * cosine - lobe.b * sine) * width);
}

}  // namespace

FacetValue Lobe::evaluate(const View& view, const Vec3& wi, bool sampled) const {
  const float side = dot(view.ng, wi), cosine = dot(n, wi);
  switch (kind) {
    case LobeKind::kLambert:
    case LobeKind::kOrenNayar: {
      if (!(side > 0 && cosine > 0)) return {};
      Rgb f = weight * (cosine / kPi);
      if (kind == LobeKind::kOrenNayar) {
        const float nv = std::max(0.0f, dot(n, view.wo));
        float t = dot(wi, view.wo) - cosine * nv;
        if (t > 0) t /= std::max(cosine, nv) + 1e-30f;
        const float lost = std::max(0.0f, 1 - (kPi * p[0] + p[1] * oren_nayar_g(cosine)));
        f = weight * (kWhite * (p[0] + p[1] * t) + multiple * (p[2] * lost)) * cosine;
      }
      return {f * bump_shadow(view, n, wi), cosine / kPi};
    }
    case LobeKind::kTranslucent:
      if (!(side < 0 && cosine < 0)) return {};
      // As in Cycles, whose rays go through without that (measured)
      return {weight * (-cosine / kPi * (view.lit ? bump_shadow(view, n, -wi) : 1)), -cosine / kPi};
    case LobeKind::kBelowBump:
    case LobeKind::kBelowBumpThrough: {
      const float on = kind == LobeKind::kBelowBump ? 1.0f : -1.0f, below = -dot(b, wi);
      return {{}, on * side > 0 && on * cosine > 0 && below > 0 ? below / p[0] : 0};
    }
    case LobeKind::kSheen: {
      if (!(side > 0 && cosine > 0)) return {};
      const Vec3 w = to_local(wi);
      const float len2 = sqr(p[0] * w.x + p[1] * w.z) + sqr(p[0] * w.y) + sqr(w.z);
      const float pdf = w.z / kPi * sqr(p[0] / len2);
      return {weight * (pdf * bump_shadow(view, n, wi)), pdf};
    }
    case LobeKind::kVelvet: {
      const float cos_o = dot(n, view.wo);
      if (!(side > 0 && cosine > 0 && cos_o > 0)) return {};
      const Vec3 h = normalize(view.wo + wi);
      const float nh = dot(n, h), oh = std::abs(dot(view.wo, h)), pdf = 1 / (2 * kPi);
      if (!(std::abs(nh) < 1 - 1e-5f && oh > 1e-5f)) return {{}, pdf};
      const float ratio = std::max(nh / oh, 1e-5f), sin2 = 1 - sqr(nh);
      const float g = std::min(1.0f, 2 * ratio * std::min(cos_o, cosine));
      const float d = std::exp(-sqr(nh) / sin2 * p[0]) * p[0] / (kPi * sqr(sin2));
      return {weight * (0.25f * d * g / cos_o), pdf};
    }
    case LobeKind::kToonDiffuse:
    case LobeKind::kToonGlossy: {
      if (!(side > 0 && cosine > 0) || !(dot(n, view.wo) > 0 || kind == LobeKind::kToonDiffuse))
        return {};
      const float c = dot(toon_axis(*this, view.wo), wi), pdf = 1 / (2 * kPi * p[2]);
      if (c < 1 - p[2]) return {};
      const float shadow = kind == LobeKind::kToonDiffuse ? bump_shadow(view, n, wi) : 1;
      return {weight * (toon_intensity(*this, std::acos(std::min(c, 1.0f))) * pdf * shadow), pdf};
    }
    case LobeKind::kAshikhminShirley: {
      if (!(side > 0 && cosine > 0) || !(dot(n, view.wo) > 0)) return {};
      return evaluate_ashikhmin_shirley(*this, to_local(view.wo), to_local(wi));
    }
    case LobeKind::kFacets: {
      if (facets.delta()) return {};
      if ((side < 0) != (cosine < 0)) return {};
      FacetValue value = evaluate_facets(facets, fresnel, from, masked, to_local(wi), view.lit);
      value.f *= weight;
      return value;
    }
    case LobeKind::kThinFacets: {
      if (!(side < 0 && cosine < 0)) return {};
      Vec3 mirrored = to_local(wi);
      mirrored.z = -mirrored.z;
      FacetValue value = evaluate_facets(facets, fresnel, from, masked, mirrored, false);
      value.f *= weight;
      return value;
    }
    case LobeKind::kHairReflection:
    case LobeKind::kHairTransmission:
    case LobeKind::kPrincipledHair:
    case LobeKind::kFacetHair: return evaluate_hair(*this, view.wo, wi, sampled);
  }
  return {};
}

bool Lobe::sample(const View& view, float choice, const Vec2& u, Vec3* wi) const {
  Vec3 w;
  switch (kind) {
    case LobeKind::kLambert:
    case LobeKind::kOrenNayar: w = sample_cosine_hemisphere(u); break;
    case LobeKind::kTranslucent: w = -sample_cosine_hemisphere(u); break;
    case LobeKind::kBelowBump:
    case LobeKind::kBelowBumpThrough: *wi = sample_below_bump(*this, u); return true;
    case LobeKind::kSheen: {
      const Vec3 c = sample_cosine_hemisphere(u);
      w = normalize({c.x - c.z * p[1], c.y, c.z * p[0]});
      break;
    }
    case LobeKind::kVelvet: {
      const float r = std::sqrt(std::max(0.0f, 1 - sqr(u.x)));
      w = {r * std::cos(2 * kPi * u.y), r * std::sin(2 * kPi * u.y), u.x};
      break;
    }
    case LobeKind::kToonDiffuse: w = sample_cone(u, p[2]); break;
    case LobeKind::kToonGlossy:
      *wi = Basis(toon_axis(*this, view.wo)).to_world(sample_cone(u, p[2]));
      return dot(*wi, n) > 0;
    case LobeKind::kAshikhminShirley:
      w = sample_ashikhmin_shirley(*this, to_local(view.wo), u);
      if (!(w.z > 0)) return false;
      break;
    case LobeKind::kFacets:
      if (!sample_facets(facets, fresnel, from, choice, u, &w)) return false;
      break;
    case LobeKind::kThinFacets:
      if (!sample_facets(facets, fresnel, from, choice, u, &w)) return false;
      w.z = -w.z;
      break;
    case LobeKind::kHairReflection:
    case LobeKind::kHairTransmission:
    case LobeKind::kPrincipledHair:
    case LobeKind::kFacetHair: return sample_hair(*this, view.wo, choice, u, wi);
  }
  *wi = normalize(to_world(w));
  return true;
}

}  // namespace photon_splat
