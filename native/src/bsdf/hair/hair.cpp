#include "bsdf/hair/hair.h"

#include "bsdf/hair/hair_along.h"
#include "bsdf/lobe.h"

namespace photon_splat {
namespace {

// The strand's own axes as they are seen from wo.
void set_axes(const HairFrame& frame, const Vec3& wo, HairShape& out) {
  out.x = frame.tangent;
  const Vec3 across = cross(out.x, wo);
  out.y = length2(across) > 1e-12f ? normalize(across) : Basis(out.x).tangent;
  out.z = cross(out.x, out.y);
}

float across_of(const View& view, const HairFrame& frame) {
  return view.towards_end ? -frame.across : frame.across;
}

Lobe make(LobeKind kind, const View& view, const Rgb& weight, const Vec3& n,
          const HairFrame& frame) {
  Lobe lobe;
  lobe.kind = kind;
  lobe.weight = weight;
  lobe.albedo = average(weight);
  lobe.t = frame.tangent;
  set_axes(frame, view.wo, lobe.hair);
  lobe.b = lobe.hair.y;
  const float across = across_of(view, frame);
  lobe.n = frame.rounded ? lobe.hair.y * across - lobe.hair.z * cos_of(across) : n;
  return lobe;
}

float fresnel(float cosine, float ior) {
  const float g2 = sqr(ior) - 1 + sqr(cosine);
  if (!(g2 > 0)) return 1;
  const float g = std::sqrt(g2), a = (g - cosine) / (g + cosine),
              b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
  return 0.5f * sqr(a) * (1 + sqr(b));
}

// Logistic distribution on [-pi, pi].
float logistic_below(float x, float scale) {
  const float e = -x / scale;
  return e > 88 ? 0 : 1 / (1 + std::exp(e));
}
float trimmed_logistic(float x, float scale) {
  const float e = std::exp(-std::abs(x) / scale), whole = 1 - 2 * logistic_below(-kPi, scale);
  return whole > 0 ? e / (scale * sqr(1 + e)) / whole : 0;
}
float sample_trimmed_logistic(float u, float scale) {
  const float least = logistic_below(-kPi, scale);
  const float x = -scale * std::log(1 / std::max(u * (1 - 2 * least) + least, 1e-30f) - 1);
  return std::clamp(x, -kPi, kPi);
}

float wrap(float angle) { return angle - 2 * kPi * std::floor((angle + kPi) / (2 * kPi)); }

// Modified Bessel function of the first kind, order 0: x up to some 12.
float bessel(float x) {
  const float q = 0.25f * sqr(x);
  float sum = 1, term = 1;
  for (int i = 1; i < 40 && term > 1e-7f * sum; ++i) {
    term *= q / sqr(static_cast<float>(i));
    sum += term;
  }
  return sum;
}
float log_bessel(float x) {
  if (x > 12) return x + 0.5f * (1 / (8 * x) - std::log(2 * kPi) - std::log(x));
  return std::log(bessel(x));
}

// Tilts of the scales that turn wo, for the first three modes.
constexpr float kTilts[3] = {2, -1, -4};

FacetValue evaluate_principled(const Lobe& lobe, const Vec3& wi) {
  const HairShape& hair = lobe.hair;
  const float sine = std::clamp(dot(wi, hair.x), -1.0f, 1.0f), cosine = cos_of(sine);
  // Azimuth of wi around the strand, where that of wo is -pi/2
  const float around = std::atan2(dot(wi, hair.z), dot(wi, hair.y)) + 0.5f * kPi;
  FacetValue sum{};
  for (int mode = 0; mode < HairShape::kModes; ++mode) {
    const bool last = mode + 1 == HairShape::kModes;
    const float share =
        density_along(sine, cosine, hair.sin_o[mode], hair.cos_o[mode], hair.variance[mode]) *
        (last ? 0.5f / kPi : trimmed_logistic(wrap(around - hair.turn[mode]), hair.scale));
    sum.f += hair.attenuation[mode] * share;
    sum.pdf += hair.pick[mode] * share;
  }
  sum.f *= lobe.weight;
  if (!is_finite(sum.f) || !std::isfinite(sum.pdf)) return {};
  return sum;
}

int pick_mode(const HairShape& hair, float& choice) {
  int mode = 0;
  while (mode + 1 < HairShape::kModes && choice >= hair.pick[mode]) choice -= hair.pick[mode++];
  while (mode > 0 && !(hair.pick[mode] > 0)) --mode;
  choice = std::clamp(choice / std::max(hair.pick[mode], 1e-20f), 0.0f, 1.0f);
  return mode;
}

bool sample_principled(const Lobe& lobe, float choice, const Vec2& u, Vec3* wi) {
  const HairShape& hair = lobe.hair;
  const int mode = pick_mode(hair, choice);
  const bool last = mode + 1 == HairShape::kModes;
  const float sine =
      sample_along(hair.sin_o[mode], hair.cos_o[mode], hair.variance[mode], {choice, u.y});
  const float cosine = cos_of(sine);
  const float turn =
      last ? 2 * kPi * u.x : hair.turn[mode] + sample_trimmed_logistic(u.x, hair.scale);
  const float angle = turn - 0.5f * kPi;
  *wi = normalize(hair.x * sine + (hair.y * std::cos(angle) + hair.z * std::sin(angle)) * cosine);
  return is_finite(*wi);
}

// Hair BSDF, after Marschner et al. 2003 as Open Shading Language simplified it.
struct Simple {
  float along, around, offset, theta_o, from, to;  // from, to: the range of the angle's arctangent
  Vec3 y;                                          // the side that faces us, across the strand
  Simple(const Lobe& lobe, const Vec3& wo)
      : along(lobe.p[0]), around(lobe.p[1]), offset(lobe.p[2]), y(-lobe.hair.z) {
    theta_o = std::asin(std::clamp(dot(lobe.t, wo), -1.0f, 1.0f));
    to = std::atan(((0.5f * kPi + theta_o) * 0.5f - offset) / along);
    from = std::atan(((-0.5f * kPi + theta_o) * 0.5f - offset) / along);
  }
  // Density in solid angle of an angle along the strand.
  float density(float theta_i) const {
    const float t = 0.5f * (theta_i + theta_o) - offset;
    return along / (2 * (sqr(t) + sqr(along)) * (to - from) * std::cos(theta_i));
  }
};

constexpr float kPole = 0.001f;  // rad: nearer to the strand's own direction there is nothing

FacetValue evaluate_simple(const Lobe& lobe, const Vec3& wo, const Vec3& wi, bool sampled) {
  const bool transmits = lobe.kind == LobeKind::kHairTransmission;
  if (!sampled && (dot(lobe.n, wi) < 0) != transmits) return {};
  const Simple s(lobe, wo);
  const float sine = std::clamp(dot(lobe.t, wi), -1.0f, 1.0f), theta_i = std::asin(sine);
  if (0.5f * kPi - std::abs(theta_i) < kPole) return {};
  const Vec3 across = wi - lobe.t * sine;
  const float phi =
      std::acos(std::clamp(dot(across, s.y) / std::max(length(across), 1e-20f), -1.0f, 1.0f));
  float around;
  if (transmits) {
    const float p = kPi - phi, whole = 2 * std::atan(0.5f * kPi / s.around);
    around = s.around / (whole * (sqr(p) + sqr(s.around)));
  } else {
    if (phi > 0.5f * kPi && !sampled) return {};
    around = std::cos(std::min(0.5f * phi / s.around, 0.5f * kPi)) * 0.25f / s.around;
  }
  const float pdf = std::max(0.0f, around * s.density(theta_i));
  if (!std::isfinite(pdf)) return {};
  return {lobe.weight * pdf, pdf};
}

bool sample_simple(const Lobe& lobe, const Vec3& wo, const Vec2& u, Vec3* wi) {
  const Simple s(lobe, wo);
  const float t = s.along * std::tan(u.x * (s.to - s.from) + s.from);
  const float theta_i = 2 * (t + s.offset) - s.theta_o;
  if (0.5f * kPi - std::abs(theta_i) < kPole) return false;
  float phi;
  if (lobe.kind == LobeKind::kHairTransmission)
    phi = kPi + s.around * std::tan(2 * std::atan(0.5f * kPi / s.around) * (u.y - 0.5f));
  else
    phi = 2 * std::asin(std::clamp(1 - 2 * u.y, -1.0f, 1.0f)) * s.around;
  const Vec3 x = cross(s.y, lobe.t);
  *wi = normalize((s.y * std::cos(phi) - x * std::sin(phi)) * std::cos(theta_i) +
                  lobe.t * std::sin(theta_i));
  return is_finite(*wi);
}

// Polynomial of Chiang et al., section 4.2.
float color_scale(float around) {
  const float x = around;
  return (((((0.245f * x) + 5.574f) * x - 10.73f) * x + 2.532f) * x - 0.215f) * x + 5.969f;
}

float power(float x, int n) {
  float result = 1;
  for (int i = 0; i < n; ++i) result *= x;
  return result;
}
float variance_of(float roughness) {
  const float r = roughness;
  return sqr(0.726f * r + 0.812f * sqr(r) + 3.7f * power(r, 20));
}

}  // namespace

float density_along(float sin_i, float cos_i, float sin_o, float cos_o, float variance) {
  const float inverse = 1 / variance, c = cos_i * cos_o * inverse, s = sin_i * sin_o * inverse;
  if (variance <= 0.1f)
    return std::exp(log_bessel(c) - s - inverse + std::log(2.0f) + std::log(0.5f * inverse));
  return std::exp(-s) * bessel(c) / (std::sinh(inverse) * 2 * variance);
}

Vec3 absorption_of_color(const Vec3& color, float around) {
  const float scale = color_scale(around);
  const auto one = [&](float c) { return sqr(std::log(std::clamp(c, 1e-5f, 1.0f)) / scale); };
  return {one(color.x), one(color.y), one(color.z)};
}

Vec3 absorption_of_melanin(float melanin, float redness) {
  const float all = -std::log(std::max(1 - melanin, 1e-4f));
  // Eumelanin and pheomelanin, which is reddish
  return Vec3{0.506f, 0.841f, 1.653f} * (all * (1 - redness)) +
         Vec3{0.343f, 0.733f, 1.924f} * (all * redness);
}

Lobe hair_lobe(const View& view, const Vec3& weight, const Vec3& n, const HairInputs& in) {
  Lobe lobe = make(in.transmits ? LobeKind::kHairTransmission : LobeKind::kHairReflection, view,
                   weight, n, in.frame);
  lobe.p[0] = in.along, lobe.p[1] = in.around, lobe.p[2] = in.offset;
  return lobe;
}

Lobe principled_hair_lobe(const View& view, const Vec3& weight, const Vec3& n,
                          const PrincipledHairInputs& in) {
  Lobe lobe = make(LobeKind::kPrincipledHair, view, weight, n, in.frame);
  HairShape& hair = lobe.hair;
  const float variance = variance_of(in.along);
  hair.variance[0] = variance_of(std::clamp((1 - in.coat) * in.along, 0.001f, 1.0f));
  hair.variance[1] = 0.25f * variance;
  hair.variance[2] = hair.variance[3] = 4 * variance;
  const float r = in.around;
  hair.scale = (0.265f * r + 1.194f * sqr(r) + 5.372f * power(r, 22)) * std::sqrt(kPi / 8);

  const float sin_o = std::clamp(dot(view.wo, hair.x), -1.0f, 1.0f), cos_o = cos_of(sin_o);
  for (int mode = 0; mode < HairShape::kModes; ++mode) {
    const bool last = mode + 1 == HairShape::kModes;
    const float tilt = last ? 0 : kTilts[mode] * in.offset;
    const float s = std::sin(tilt), c = std::cos(tilt);
    hair.sin_o[mode] = sin_o * c + cos_o * s;
    hair.cos_o[mode] = std::abs(cos_o * c - sin_o * s);
  }
  const float sin_gamma_o = std::clamp(-across_of(view, in.frame), -1.0f, 1.0f);
  const float cos_theta_t = cos_of(sin_o / in.ior);
  const float sin_gamma_t =
      std::clamp(sin_gamma_o * cos_o / std::sqrt(sqr(in.ior) - sqr(sin_o)), -1.0f, 1.0f);
  const float gamma_o = std::asin(sin_gamma_o), gamma_t = std::asin(sin_gamma_t);
  for (int p = 0; p < 3; ++p) {
    const float times = static_cast<float>(p);
    hair.turn[p] = 2 * times * gamma_t - 2 * gamma_o + times * kPi;
  }

  const float way = 2 * cos_of(sin_gamma_t) / std::max(cos_theta_t, 1e-6f);
  const auto through = [&](float a) { return std::exp(-a * way); };
  const Rgb inside{through(in.absorption.x), through(in.absorption.y), through(in.absorption.z)};
  const float f = fresnel(cos_o * cos_of(sin_gamma_o), in.ior);
  hair.attenuation[0] = {f, f, f};
  hair.attenuation[1] = inside * sqr(1 - f);
  hair.attenuation[2] = hair.attenuation[1] * inside * f;
  const auto rest = [&](float a, float t) { return a * t * f / std::max(1 - t * f, 1e-6f); };
  hair.attenuation[3] = {rest(hair.attenuation[2].x, inside.x),
                         rest(hair.attenuation[2].y, inside.y),
                         rest(hair.attenuation[2].z, inside.z)};
  float total = 0;
  for (int mode = 0; mode < HairShape::kModes; ++mode)
    total += hair.pick[mode] = luminance(hair.attenuation[mode]);
  for (float& pick : hair.pick) pick /= std::max(total, 1e-20f);

  const float scale = color_scale(in.around);
  const auto colored = [&](float a) { return std::exp(-std::sqrt(a) * scale); };
  lobe.scale = {colored(in.absorption.x), colored(in.absorption.y), colored(in.absorption.z)};
  lobe.layer = weight;
  return lobe;
}

FacetValue evaluate_hair(const Lobe& lobe, const Vec3& wo, const Vec3& wi, bool sampled) {
  if (lobe.kind == LobeKind::kPrincipledHair) return evaluate_principled(lobe, wi);
  if (lobe.kind == LobeKind::kFacetHair) return evaluate_facet_hair(lobe, wi, sampled);
  return evaluate_simple(lobe, wo, wi, sampled);
}

bool sample_hair(const Lobe& lobe, const Vec3& wo, float choice, const Vec2& u, Vec3* wi) {
  if (lobe.kind == LobeKind::kPrincipledHair) return sample_principled(lobe, choice, u, wi);
  if (lobe.kind == LobeKind::kFacetHair) return sample_facet_hair(lobe, choice, u, wi);
  return sample_simple(lobe, wo, u, wi);
}

bool hair_transmits(const Lobe& lobe, float choice) {
  if (lobe.kind == LobeKind::kPrincipledHair) return pick_mode(lobe.hair, choice) > 0;
  return lobe.kind == LobeKind::kHairTransmission;
}

}  // namespace photon_splat
