#include "media/phase.h"

namespace photon_splat {
namespace {

constexpr float kMostForward = 0.999f;  // |g|: beyond it is a delta

float henyey_greenstein(float cosine, float g) {
  const float d = 1 + g * g - 2 * g * cosine;
  return (1 - g * g) / (4 * kPi * d * std::sqrt(d));
}

// Particles of many sizes in water (Fournier and Forand, Analytic phase function for ocean water,
// 1994, by the share that they scatter backwards: Fournier and Jonasz, Computer-based underwater
// imaging analysis, 1999). Of t = sin^2(angle / 2).
class FournierForand {
 public:
  FournierForand(float index, float backwards) {
    const double n = index >= 1.001f ? std::min(index, 100.0f) : 1.001, share = std::abs(backwards),
                 b = share >= 1e-6 ? std::min(share, 0.499) : 1e-6;
    per_t_ = 4 / (3 * (n - 1) * (n - 1));
    const double across = off_one(0.5 * per_t_);
    exponent_ = -std::log(2 * b * (across - 1) + 1) / std::log(across);
    even_ = (std::pow(per_t_, -exponent_) - 1) / (off_one(per_t_) - 1);
  }

  double evaluate(double t) const {
    const double d = off_one(per_t_ * t), power = std::pow(d, exponent_), cosine = 1 - 2 * t;
    return ((exponent_ * (1 - d) - (1 - power) + (d * (1 - power) - exponent_ * (1 - d)) / t) /
                ((1 - d) * (1 - d) * power) +
            even_ / 4 * (3 * cosine * cosine - 1)) /
           (4 * kPi);
  }

  // The share that goes to smaller angles.
  double below(double t) const {
    const double d = off_one(per_t_ * t), power = std::pow(d, exponent_);
    return (1 - d * power - (1 - power) * t) / ((1 - d) * power) +
           even_ / 2 * (1 - 2 * t) * t * (1 - t);
  }

  // Where below() is u. Small angles follow a power of t.
  double sample(double u) const {
    const double power = std::clamp(-exponent_, 0.02, 1.0);
    double low = 0, high = 1, at_low = -u, at_high = 1 - u;
    int side = 0;
    double t = 1;
    for (int step = 0; step < kMostSteps; ++step) {  // regula falsi, after Dowell and Jarratt 1971
      const double q = std::clamp((low * at_high - high * at_low) / (at_high - at_low), low, high);
      t = std::max(std::pow(q, 1 / power), kLeastT);
      const double here = below(t) - u;
      if (std::abs(here) < 1e-7 || high - low < 1e-9) break;
      if (here > 0) {
        if (side > 0) at_low /= 2;
        high = q, at_high = here, side = 1;
      } else {
        if (side < 0) at_high /= 2;
        low = q, at_low = here, side = -1;
      }
    }
    return t;
  }

  static constexpr double kLeastT = 1e-12;

 private:
  static constexpr int kMostSteps = 40;
  // Formulas are 0 / 0 at 1
  static double off_one(double d) { return std::abs(d - 1) < 1e-4 ? 1 + 1e-4 : d; }

  double per_t_, exponent_, even_;
};

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
    case PhaseKind::kFournierForand:
      return static_cast<float>(FournierForand(g, alpha).evaluate(
          std::clamp((1 - static_cast<double>(cosine)) / 2, FournierForand::kLeastT, 1.0)));
    case PhaseKind::kHenyeyGreenstein: break;
  }
  return henyey_greenstein(cosine, bounded_g(g));
}

float Phase::pdf(float cosine) const {
  return kind == PhaseKind::kRayleigh || kind == PhaseKind::kFournierForand
             ? evaluate(cosine)
             : henyey_greenstein(cosine, bounded_g(g));
}

float Phase::sample_cosine(float u) const {
  if (kind == PhaseKind::kRayleigh) {  // the root of a cubic (Frisvad 2011)
    const float a = 4 * u - 2, v = std::cbrt(a + std::sqrt(a * a + 1));
    return std::clamp(v - 1 / v, -1.0f, 1.0f);
  }
  if (kind == PhaseKind::kFournierForand)
    return static_cast<float>(1 - 2 * FournierForand(g, alpha).sample(u));
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
