// One path of light through a strand of facets: see FacetHairShape, whose coordinates are used.
#pragma once

#include "bsdf/hair/facet_hair.h"
#include "bsdf/microfacet.h"
#include "bsdf/tables.h"

namespace photon_splat {

inline float cos_along(const Vec3& w) { return std::sqrt(sqr(w.x) + sqr(w.z)); }
inline Vec3 reflected(const Vec3& w, const Vec3& h) { return h * (2 * dot(w, h)) - w; }

// Facets about a mean normal, seen from w.
struct FacetBoundary {
  static constexpr float kLeastCosine = 1e-4f;
  Vec3 macro, n, w;  // macro: of the strand without scales
  float cosine = 0, lambda = 0, scale = 0;
  float alpha = 0, ior = 1;  // beyond over before

  FacetBoundary() = default;
  // phi: of the normal about the strand; tilt: of the scales, rad
  FacetBoundary(float phi, float tilt, const Vec3& seen_from, float roughness, float index)
      : w(seen_from), alpha(roughness), ior(index) {
    const float s = std::sin(phi), c = std::cos(phi);
    macro = {s, 0, c};
    n = {s * std::cos(tilt), std::sin(tilt), c * std::cos(tilt)};
    cosine = dot(n, w);
    if (!faces()) return;
    lambda = lambda_of(cosine);
    // Light that facets scatter among each other goes on as the rest does: Turquin 2019, "Practical
    // multiple scattering compensation for microfacet models".
    scale = 1 / std::max(glass_albedo(std::sqrt(alpha), cosine, ior).directional, 0.01f);
  }
  float reflectance(const Vec3& h) const {
    const float c = dot(w, h);
    return c > 0 ? fresnel_dielectric(c, ior) : 0;
  }
  bool faces() const { return cosine > kLeastCosine && dot(macro, w) > 0; }
  float lambda_of(float c) const {
    const float c2 = std::max(sqr(c), 1e-12f);
    return 0.5f * (std::sqrt(1 + sqr(alpha) * std::max(1 / c2 - 1, 0.0f)) - 1);
  }
  // Of light that leaves along v, the share that is not shadowed.
  float seen(const Vec3& v) const { return (1 + lambda) / (1 + lambda + lambda_of(dot(n, v))); }
  float density(const Vec3& h) const {
    const float c = dot(n, h), a2 = sqr(alpha);
    return c > 0 ? a2 / (kPi * sqr(length2(cross(n, h)) + a2 * sqr(c))) : 0;
  }
  Vec3 facet(const Vec2& u) const {  // of those seen from w
    const Basis basis(n);
    Facets facets;
    facets.ax = facets.ay = alpha;
    const Vec3 own{dot(w, basis.tangent), dot(w, basis.bitangent), cosine};
    const Vec3 h = facets.sample_visible(own, u);
    return basis.tangent * h.x + basis.bitangent * h.y + n * h.z;
  }

  // f |cos| and density of what it reflects, and, from inside the strand, of what it lets out.
  FacetValue reflect(const Vec3& v) const {
    const Vec3 sum = w + v;
    const float len = length(sum);
    if (!(len > 1e-6f) || !(dot(macro, v) > 0)) return {};
    const Vec3 h = sum / len;
    const float pdf = density(h) / (4 * cosine * (1 + lambda));
    const float f = fresnel_dielectric(dot(w, h), ior) * scale * seen(v) * pdf;
    return {{f, f, f}, pdf};
  }
  FacetValue refract(const Vec3& v) const {
    const Vec3 sum = w + v * ior;
    const float len = length(sum);
    if (!(len > 1e-6f)) return {};
    const Vec3 h = sum / len;
    const float c = dot(w, h), beyond = -dot(v, h);
    if (!(c > 0) || !(beyond > 0) || !(dot(macro, v) < 0) || !(dot(n, v) < 0)) return {};
    const float pdf = density(h) * c * beyond * sqr(ior / len) / (cosine * (1 + lambda));
    const float f = (1 - fresnel_dielectric(c, ior)) * scale * seen(v) * pdf;
    return {{f, f, f}, pdf};
  }
};

// What leaves a strand: reflected, gone through, reflected inside once, and more often.
enum FacetHairMode { kReflected, kThrough, kSecondary, kRest, kFacetHairModes };

// The boundaries that it meets, from wo on, and what comes to each of them.
struct FacetHairPath {
  FacetBoundary entry, exit, second;
  Rgb at_exit{}, at_second{}, rest{};
  float pick[kFacetHairModes] = {};

  FacetHairPath(const FacetHairShape& s, int number);

 private:
  // The reflectance of the facet that is met first
  float trace(const FacetHairShape& s, float gamma, Random& random);
  void choose(const FacetHairShape& s, float first);
};

}  // namespace photon_splat
