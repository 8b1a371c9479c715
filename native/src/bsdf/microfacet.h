// Microfacet reflection and refraction in the frame of the macroscopic normal (z up, wo.z > 0),
// Walter et al. 2007.
#pragma once

#include "bsdf/fresnel.h"
#include "math/sampling.h"

namespace photon_splat {

struct Facets {
  bool beckmann = false;
  float ax = 0, ay = 0;  // slopes along x and y

  // Under this a lobe is a mirror.
  static constexpr float kDeltaArea = 2e-9f;
  bool delta() const { return ax * ay <= kDeltaArea; }
  float density(const Vec3& m) const;                        // D(m), m.z > 0
  float lambda(const Vec3& w) const;                         // Smith's: G1 = 1/(1 + lambda)
  Vec3 sample_visible(const Vec3& wo, const Vec2& u) const;  // pdf D(m) G1(wo) (wo.m)/wo.z
  // A visible normal from a uniform point of the unit disc; GGX only
  Vec3 visible(const Vec3& wo, const Vec2& disk) const;
};

// Direction beyond the facet m with `ior` = index there over index here; z component of the result
// has the other sign. False: total internal reflection.
bool refract(const Vec3& wo, const Vec3& m, float ior, Vec3* wi);

struct FacetValue {
  Rgb f;  // f |cos wi|, with Fresnel
  float pdf = 0;
};

// wi.z > 0: reflection, < 0: refraction, in the basic-radiance convention. lambda_o:
// facets.lambda(wo). No deltas here. `lit`: wi leads to a light sample. Then refraction by facets
// that look away from wo or wi counts, too, which no ray finds: so it is in Cycles (measured), and
// rough glass under lamps is brighter than its rays alone would have it.
FacetValue evaluate_facets(const Facets& facets, const FresnelTerms& fresnel, const Vec3& wo,
                           float lambda_o, const Vec3& wi, bool lit);

// `choice` in [0, 1) decides between reflection and refraction.
bool sample_facets(const Facets& facets, const FresnelTerms& fresnel, const Vec3& wo, float choice,
                   const Vec2& u, Vec3* wi);

// Probability that a facet under cos_i reflects, when it may do both.
float reflect_probability(const FresnelValue& value);

}  // namespace photon_splat
