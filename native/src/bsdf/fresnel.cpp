#include "bsdf/fresnel.h"

namespace photon_splat {

float fresnel_dielectric(float cos_i, float ior, float* cos_t) {
  const float sin2_t = (1 - sqr(cos_i)) / sqr(ior);
  if (cos_t) *cos_t = 0;
  if (!(sin2_t < 1)) return 1;
  const float c = std::sqrt(1 - sin2_t);
  if (cos_t) *cos_t = c;
  const float rs = (cos_i - ior * c) / (cos_i + ior * c),
              rp = (c - ior * cos_i) / (c + ior * cos_i);
  return 0.5f * (sqr(rs) + sqr(rp));
}

float ior_from_f0(float f0) {
  const float root = std::sqrt(std::clamp(f0, 0.0f, 0.99f));
  return (1 + root) / (1 - root);
}

namespace {

// Reflectance at normal incidence up to which a film is not tinted, as nothing else reflects
constexpr float kLeastTinted = 1e-5f;

// (1 - 1/7)^5: Schlick's curve at 82 degrees, cos 1/7.
constexpr float kEdge5 = 7776.0f / 16807;

// Schlick's curve bent so that at 82 degrees it takes its own value times `edge` (Kutz et al. 2021,
// "Novel aspects of the Adobe Standard Material"): F(c) = f0 + (1 - f0) (1 - c)^5 - b c (1 - c)^6.
// This is b.
float f82_bend(float f0, float edge) {
  constexpr float c = 1.0f / 7, d = 1 - c;
  return (f0 + (1 - f0) * kEdge5) * (1 - edge) / (c * kEdge5 * d);
}
float f82(float f0, float edge, float cos_i) {
  const float d = 1 - cos_i, d5 = d * sqr(sqr(d));
  return saturate(f0 + (1 - f0) * d5 - f82_bend(f0, edge) * cos_i * d5 * d);
}

// A film on a metal given by its colours. Its index from them by Gulbrandsen 2014 ("Artist friendly
// metallic Fresnel") with the reflectance at 82 degrees for the edge; the curve within the film is
// the F82 of that metal's reflectance there (as measured in Cycles).
Rgb film_on_f82(const FresnelTerms& f, float cos_i) {
  const float film = f.film_ior,
              cos_film = std::sqrt(std::max(0.0f, 1 - (1 - sqr(cos_i)) / sqr(film)));
  float n[3], k[3], under[3];
  for (int c = 0; c < 3; ++c) {
    const float r = std::clamp(f.f0[c], 0.0f, 0.999f), root = std::sqrt(r);
    const float g = f.f90[c] * (r + (1 - r) * kEdge5);
    n[c] = g * (1 - r) / (1 + r) + (1 - g) * (1 + root) / (1 - root);
    const float k2 = std::max(0.0f, (r * sqr(n[c] + 1) - sqr(n[c] - 1)) / (1 - r));
    k[c] = std::sqrt(k2);
    under[c] = f82((sqr(n[c] - film) + k2) / (sqr(n[c] + film) + k2), f.f90[c], cos_film);
  }
  const Rgb reflectance{under[0], under[1], under[2]};
  return film_reflectance(cos_i, f.film_thickness, film, {n[0], n[1], n[2]}, {k[0], k[1], k[2]},
                          &reflectance);
}

}  // namespace

namespace {

// Exact reflectance of a conductor n + ik seen from vacuum (Lagarde, "Memo on Fresnel equations").
float conductor(float cos_i, float n, float k) {
  const float c2 = sqr(cos_i), s2 = 1 - c2, t0 = sqr(n) - sqr(k) - s2;
  const float a2b2 = std::sqrt(std::max(0.0f, sqr(t0) + 4 * sqr(n * k)));
  const float a = std::sqrt(std::max(0.0f, 0.5f * (a2b2 + t0)));
  const float t1 = a2b2 + c2, t2 = 2 * a * cos_i, t3 = c2 * a2b2 + sqr(s2), t4 = t2 * s2;
  const float rs = (t1 - t2) / std::max(t1 + t2, 1e-12f),
              rp = rs * (t3 - t4) / std::max(t3 + t4, 1e-12f);
  return saturate(0.5f * (rs + rp));
}

}  // namespace

FresnelValue evaluate_fresnel(const FresnelTerms& f, float cos_i) {
  cos_i = saturate(cos_i);
  const bool film = f.film_thickness > kThinnestFilm;
  Rgb r{1, 1, 1};
  switch (f.kind) {
    case FresnelKind::kOne: break;
    case FresnelKind::kDielectric: {
      const float f0 = f0_from_ior(f.ior);
      const auto rise = [f0](float x) { return f0 < 1 ? saturate((x - f0) / (1 - f0)) : 1; };
      if (!film) {
        r = lerp(f.f0, f.f90, rise(fresnel_dielectric(cos_i, f.ior)));
      } else {
        // The tint of f0 fades towards grazing angles, as without the film.
        r = film_reflectance(cos_i, f.film_thickness, f.film_ior, kWhite * f.ior, {});
        const Rgb tint = f0 > kLeastTinted ? f.f0 / f0 : kWhite;
        r *= Rgb{tint.x + (f.f90.x - tint.x) * rise(r.x), tint.y + (f.f90.y - tint.y) * rise(r.y),
                 tint.z + (f.f90.z - tint.z) * rise(r.z)};
      }
      break;
    }
    case FresnelKind::kF82:
      r = film ? film_on_f82(f, cos_i)
               : Rgb{f82(f.f0.x, f.f90.x, cos_i), f82(f.f0.y, f.f90.y, cos_i),
                     f82(f.f0.z, f.f90.z, cos_i)};
      break;
    case FresnelKind::kConductor:
      r = film ? film_reflectance(cos_i, f.film_thickness, f.film_ior, f.f0, f.f90)
               : Rgb{conductor(cos_i, f.f0.x, f.f90.x), conductor(cos_i, f.f0.y, f.f90.y),
                     conductor(cos_i, f.f0.z, f.f90.z)};
      break;
  }
  return {r * f.reflect_tint, (kWhite - r) * f.transmit_tint};
}

Rgb mean_reflectance(const FresnelTerms& f) {
  switch (f.kind) {
    case FresnelKind::kOne: return f.reflect_tint;
    case FresnelKind::kDielectric: {
      // Fits of Kulla & Conty 2017, "Revisiting physically based shading at Imageworks".
      const float n = f.ior, f0 = f0_from_ior(n);
      const float mean = n < 1 ? 0.997118f + n * (0.1014f - n * (0.965241f + n * 0.130607f))
                               : (n - 1) / (4.08567f + 1.00071f * n);
      return f.reflect_tint * lerp(f.f0, f.f90, f0 < 1 ? saturate((mean - f0) / (1 - f0)) : 1);
    }
    case FresnelKind::kF82:
      return saturate(lerp(f.f0, kWhite, 1.0f / 21) - Rgb{f82_bend(f.f0.x, f.f90.x),
                                                          f82_bend(f.f0.y, f.f90.y),
                                                          f82_bend(f.f0.z, f.f90.z)} *
                                                          (1.0f / 126)) *
             f.reflect_tint;
    case FresnelKind::kConductor: {
      // Gauss-Legendre, 4 points.
      constexpr float x[4] = {0.0694318f, 0.3300095f, 0.6699905f, 0.9305682f},
                      w[4] = {0.1739274f, 0.3260726f, 0.3260726f, 0.1739274f};
      Rgb sum{};
      for (int i = 0; i < 4; ++i) sum += evaluate_fresnel(f, x[i]).reflect * (2 * x[i] * w[i]);
      return sum;
    }
  }
  return kWhite;
}

}  // namespace photon_splat
