// Share of light reflected at a smooth boundary, by angle.
#pragma once

#include "math/vec.h"

namespace photon_splat {

inline constexpr float kThinnestFilm = 0.1f;  // nm; there is no film of that or less

enum class FresnelKind : uint8_t { kOne, kDielectric, kF82, kConductor };

// What a microfacet does with light: reflect + transmit <= 1 in each channel for physical
// parameters.
struct FresnelTerms {
  FresnelKind kind = FresnelKind::kOne;
  float ior = 1;  // dielectric: index behind the boundary over the index before it
  // dielectric: reflectance at 0 and 90 degrees; F82: base and edge tint; conductor: n and k
  Rgb f0{1, 1, 1}, f90{1, 1, 1};
  Rgb reflect_tint{1, 1, 1}, transmit_tint{};
  float film_thickness = 0, film_ior = 1.33f;  // nm; see kThinnestFilm
};

struct FresnelValue {
  Rgb reflect, transmit;
};

inline Rgb saturate(const Rgb& c) { return {saturate(c.x), saturate(c.y), saturate(c.z)}; }
inline Rgb lerp(const Rgb& a, const Rgb& b, float t) { return a + (b - a) * t; }
inline constexpr Rgb kWhite{1, 1, 1};

// Unpolarised reflectance of a boundary between dielectrics, cos_i > 0; `cos_t` (optional): of the
// refracted ray, 0 when there is none (total internal reflection, reflectance 1).
float fresnel_dielectric(float cos_i, float ior, float* cos_t = nullptr);

// Whether a boundary bends light by so little that it goes straight on, however rough it is; the
// same from either side.
inline bool bends_nothing(float ior) { return std::max(ior, 1 / ior) < 1.002f; }

inline float f0_from_ior(float ior) { return sqr((ior - 1) / (ior + 1)); }
float ior_from_f0(float f0);

FresnelValue evaluate_fresnel(const FresnelTerms& terms, float cos_i);

// Mean of the reflectance over a hemisphere, 2 integral F(c) c dc: what energy loses at each
// further bounce between facets.
Rgb mean_reflectance(const FresnelTerms& terms);

// Reflectance as RGB of a film of the index `film_ior` over a surface of the index n + ik, indices
// relative to the outside; `under` (optional): reflectance of the surface within the film, instead
// of what n and k say.
Rgb film_reflectance(float cos_i, float thickness_nm, float film_ior, const Rgb& n, const Rgb& k,
                     const Rgb* under = nullptr);

}  // namespace photon_splat
