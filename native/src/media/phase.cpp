#include "media/phase.h"

namespace photon_splat {
namespace {

constexpr float kMostForward = 0.999f;  // |g|: beyond it is a delta

float henyey_greenstein(float cosine, float g) {
  const float d = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * kPi * d * std::sqrt(d));
}

float bounded_g(float g) { return g == g ? std::clamp(g, -kMostForward, kMostForward) : 0; }

}  // namespace

float Phase::evaluate(float cosine) const {
  switch (kind) {
    case PhaseKind::kRayleigh: return 3 / (16 * kPi) * (1 + cosine * cosine);
    case PhaseKind::kDraine: {
      const float a = std::max(alpha, 0.0f), b = bounded_g(g);
      return henyey_greenstein(cosine, b) * (1 + a * cosine * cosine) /
             (1 + a * (1 + 2 * b * b) / 3);
    }
    case PhaseKind::kHenyeyGreenstein: break;
  }
  return henyey_greenstein(cosine, bounded_g(g));
}

float Phase::pdf(float cosine) const {
  return kind == PhaseKind::kRayleigh ? evaluate(cosine) : henyey_greenstein(cosine, bounded_g(g));
}

float Phase::sample_cosine(float u) const {
  if (kind == PhaseKind::kRayleigh) {  // the root of a cubic (Frisvad 2011)
    const float a = 4 * u - 2, v = std::cbrt(a + std::sqrt(a * a + 1));
    return std::clamp(v - 1 / v, -1.0f, 1.0f);
  }
  const float b = bounded_g(g);
  if (std::abs(b) < 1e-3f) return 1 - 2 * u;
  const float k = (1 - b * b) / (1 - b + 2 * b * u);
  return std::clamp((1 + b * b - k * k) / (2 * b), -1.0f, 1.0f);
}

MieFit fit_mie(float diameter) {
  const float d = diameter == diameter ? std::clamp(diameter, 1e-3f, 50.0f) : 1e-3f;
  const float l = std::log(d);
  float hg, g, alpha, share;
  if (d <= 0.1f) {
    hg = 13.8f * d * d;
    g = 1.1456f * d * std::sin(9.29044f * d);
    alpha = 250;
    share = 0.252977f - 312.983f * std::pow(d, 4.3f);
  } else if (d < 1.5f) {
    hg = 0.862f - 0.143f * l * l;
    g = 0.379685f * std::cos(1.19692f * std::cos((l - 0.238604f) * (l + 1.00667f) /
                                                 (0.507522f - 0.15677f * l)) +
                             1.37932f * l + 0.0625835f) +
        0.344213f;
    alpha = 250;
    share = 0.146209f * std::cos(3.38707f * l + 2.11193f) + 0.316072f + 0.0778917f * l;
  } else if (d < 5) {
    const float ll = std::log(l);
    hg = 0.0604931f * ll + 0.940256f;
    g = 0.500411f - 0.081287f / (-2 * l + std::tan(l) + 1.27551f);
    alpha = 7.30354f * l + 6.31675f;
    share = 0.026914f * (l - std::cos(5.68947f * (ll - 0.0292149f))) + 0.376475f;
  } else {
    hg = std::exp(-0.0990567f / (d - 1.67154f));
    g = std::exp(-2.20679f / (d + 3.91029f) - 0.428934f);
    alpha = std::exp(3.62489f - 8.29288f / (d + 5.52825f));
    share = std::exp(-0.599085f / (d - 0.641583f) - 0.665888f);
  }
  return {{PhaseKind::kHenyeyGreenstein, hg, 0},
          {PhaseKind::kDraine, g, alpha},
          std::clamp(share, 0.0f, 1.0f)};
}

}  // namespace photon_splat
