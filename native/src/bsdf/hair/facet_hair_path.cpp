#include "bsdf/hair/facet_hair_path.h"

namespace photon_splat {
namespace {

constexpr float kLeastShare = 0.05f;  // of a boundary's light, in the choice among modes

// Angles about the strand count from Z towards X. An ellipse is a squeezed circle: from the angle
// of a point on the circle that of the normal on the ellipse; from that of a direction across the
// ellipse that of the direction across the circle (figure 5).
float squeezed(float gamma, float aspect) {
  return aspect == 1 ? gamma : std::atan2(aspect * std::sin(gamma), std::cos(gamma));
}
float squeezed(const Vec3& w, float aspect) { return squeezed(std::atan2(w.x, w.z), aspect); }

// Of a chord between two angles.
Rgb transmittance(const FacetHairShape& s, float gamma, float other, const Vec3& w) {
  const float x = std::sin(gamma) - std::sin(other),
              z = s.aspect * (std::cos(gamma) - std::cos(other));
  const float way =
      std::sqrt(sqr(x) + sqr(z)) / std::max(cos_along(w), FacetBoundary::kLeastCosine);
  return {std::exp(-s.absorption.x * way), std::exp(-s.absorption.y * way),
          std::exp(-s.absorption.z * way)};
}

// What goes on beyond the second reflection: a geometric series.
Rgb series(const Rgb& once, float through) {
  const float t = std::max(through, 1e-5f);
  const auto sum = [&](float a) { return a * t / (1 - a * (1 - t)); };
  return {sum(once.x), sum(once.y), sum(once.z)};
}

Rgb root(const Rgb& c) { return {std::sqrt(c.x), std::sqrt(c.y), std::sqrt(c.z)}; }

}  // namespace

FacetHairPath::FacetHairPath(const FacetHairShape& s, int number) {
  Random random(static_cast<uint64_t>(number), s.seed);
  const float place = (static_cast<float>(number) + random.next()) / static_cast<float>(s.paths);
  const float h = s.h_begin + place * (s.h_end - s.h_begin);
  choose(s, trace(s, squeezed(s.wo, s.aspect) - std::asin(h), random));
}

float FacetHairPath::trace(const FacetHairShape& s, float gamma, Random& random) {
  const auto boundary = [&](float at, float tilt, const Vec3& w, float ior) {
    return FacetBoundary(squeezed(at, s.aspect), tilt, w, s.alpha, ior);
  };
  entry = boundary(gamma, s.tilt, s.wo, s.ior);
  if (!entry.faces()) return 0;
  const Vec3 h1 = entry.facet(random.next2());
  const float r1 = entry.reflectance(h1);
  Vec3 in;
  if (!(dot(s.wo, h1) > 0) || !refract(s.wo, h1, s.ior, &in) || !(dot(entry.macro, in) < 0))
    return r1;

  const float gamma2 = 2 * squeezed(in, s.aspect) - gamma;
  exit = boundary(gamma2, -s.tilt, -in, 1 / s.ior);
  if (!exit.faces()) return r1;
  const Rgb on_way = transmittance(s, gamma, gamma2 + kPi, in);
  at_exit = on_way * ((1 - r1) * entry.scale * entry.seen(in));
  const Vec3 h2 = exit.facet(random.next2());
  const float r2 = exit.reflectance(h2);
  const Vec3 on = reflected(exit.w, h2);
  if (!(dot(exit.macro, on) > 0)) return r1;

  const float gamma3 = 2 * squeezed(on, s.aspect) - gamma2 - kPi;
  second = boundary(gamma3, -s.tilt, -on, 1 / s.ior);
  if (!second.faces()) return r1;
  const Rgb back = transmittance(s, gamma2 + kPi, gamma3 + kPi, on);
  at_second = at_exit * back * (r2 * exit.scale * exit.seen(on));
  const Vec3 h3 = second.facet(random.next2());
  const float r3 = second.reflectance(h3);
  const float left = second.seen(reflected(second.w, h3)) * second.scale;
  rest = at_second * series(root(on_way * back), 1 - 0.5f * (r2 + r3)) * (r3 * left);
  return r1;
}

void FacetHairPath::choose(const FacetHairShape& s, float first) {
  const float again = exit.faces() ? fresnel_dielectric(exit.cosine, 1 / s.ior) : 0;
  pick[kReflected] = entry.faces() ? s.factor[0] * std::max(first, kLeastShare) : 0;
  pick[kThrough] = s.factor[1] * average(at_exit) * std::max(1 - again, kLeastShare);
  pick[kSecondary] = s.factor[2] * average(at_second);
  pick[kRest] = average(rest);
  float total = 0;
  for (const float one : pick) total += one;
  for (float& one : pick) one = total > 0 ? one / total : 0;
}

}  // namespace photon_splat
