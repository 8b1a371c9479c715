#include "fresnel.h"

namespace photon_splat {

float fresnel_dielectric(float cos_i, float ior, float* cos_t) {
  const float sin2_t = (1 - sqr(cos_i)) / sqr(ior);
  if (cos_t) *cos_t = 0;
  if (!(sin2_t < 1)) return 1;
  const float c = std::sqrt(1 - sin2_t);
  if (cos_t) *cos_t = c;
  const float rs = (cos_i - ior * c) / (cos_i + ior * c), rp = (c - ior * cos_i) / (c + ior * cos_i);
  return 0.5f * (sqr(rs) + sqr(rp));
}

float ior_from_f0(float f0) {
  const float root = std::sqrt(std::clamp(f0, 0.0f, 0.99f));
  return (1 + root) / (1 - root);
}

Rgb f82_factor(const Rgb& base, const Rgb& tint) {
  constexpr float c = 1.0f / 7, d = 1 - c, d5 = d * d * d * d * d;
  const Rgb schlick = lerp(base, kWhite, d5);
  return schlick * (kWhite - tint) * (1 / (c * d5 * d));
}

namespace {

// Exact reflectance of a conductor n + ik seen from vacuum (Lagarde, "Memo on Fresnel equations").
float conductor(float cos_i, float n, float k) {
  const float c2 = sqr(cos_i), s2 = 1 - c2, t0 = sqr(n) - sqr(k) - s2;
  const float a2b2 = std::sqrt(std::max(0.0f, sqr(t0) + 4 * sqr(n * k)));
  const float a = std::sqrt(std::max(0.0f, 0.5f * (a2b2 + t0)));
  const float t1 = a2b2 + c2, t2 = 2 * a * cos_i, t3 = c2 * a2b2 + sqr(s2), t4 = t2 * s2;
  const float rs = (t1 - t2) / std::max(t1 + t2, 1e-12f), rp = rs * (t3 - t4) / std::max(t3 + t4, 1e-12f);
  return saturate(0.5f * (rs + rp));
}

}  // namespace

FresnelValue evaluate_fresnel(const FresnelTerms& f, float cos_i) {
  cos_i = saturate(cos_i);
  Rgb r{1, 1, 1};
  switch (f.kind) {
    case FresnelKind::kOne:
      break;
    case FresnelKind::kDielectric: {
      const float real = fresnel_dielectric(cos_i, f.ior), f0 = f0_from_ior(f.ior);
      const float s = f0 < 1 ? saturate((real - f0) / (1 - f0)) : 1;
      r = lerp(f.f0, f.f90, s);
      break;
    }
    case FresnelKind::kF82: {
      const float d = 1 - cos_i, d5 = d * sqr(sqr(d));
      r = saturate(lerp(f.f0, kWhite, d5) - f.f90 * (cos_i * d5 * d));
      break;
    }
    case FresnelKind::kConductor:
      r = {conductor(cos_i, f.f0.x, f.f90.x), conductor(cos_i, f.f0.y, f.f90.y), conductor(cos_i, f.f0.z, f.f90.z)};
      break;
  }
  return {r * f.reflect_tint, (kWhite - r) * f.transmit_tint};
}

Rgb mean_reflectance(const FresnelTerms& f) {
  switch (f.kind) {
    case FresnelKind::kOne:
      return f.reflect_tint;
    case FresnelKind::kDielectric: {
      // Fits of Kulla & Conty 2017, "Revisiting physically based shading at Imageworks".
      const float n = f.ior, f0 = f0_from_ior(n);
      const float mean = n < 1 ? 0.997118f + n * (0.1014f - n * (0.965241f + n * 0.130607f))
                               : (n - 1) / (4.08567f + 1.00071f * n);
      return f.reflect_tint * lerp(f.f0, f.f90, f0 < 1 ? saturate((mean - f0) / (1 - f0)) : 1);
    }
    case FresnelKind::kF82:
      return saturate(lerp(f.f0, kWhite, 1.0f / 21) - f.f90 * (1.0f / 126)) * f.reflect_tint;
    case FresnelKind::kConductor: {
      // Gauss-Legendre, 4 points.
      constexpr float x[4] = {0.0694318f, 0.3300095f, 0.6699905f, 0.9305682f}, w[4] = {0.1739274f, 0.3260726f, 0.3260726f, 0.1739274f};
      Rgb sum{};
      for (int i = 0; i < 4; ++i) sum += evaluate_fresnel(f, x[i]).reflect * (2 * x[i] * w[i]);
      return sum;
    }
  }
  return kWhite;
}

}  // namespace photon_splat
