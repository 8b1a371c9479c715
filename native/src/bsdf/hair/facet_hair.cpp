#include "bsdf/hair/facet_hair.h"

#include "bsdf/hair/facet_hair_path.h"
#include "bsdf/hair/hair_along.h"
#include "bsdf/lobe.h"

namespace photon_splat {
namespace {

FacetValue evaluate_path(const FacetHairShape& s, const FacetHairPath& path, const Vec3& wi,
                         bool sampled) {
  FacetValue sum{};
  const auto add = [&](FacetHairMode mode, const Rgb& weight, const FacetValue& value) {
    sum.f += weight * value.f;
    sum.pdf += path.pick[mode] * value.pdf;
  };
  const auto grey = [](float x) { return Rgb{x, x, x}; };
  if (path.pick[kReflected] > 0) add(kReflected, grey(s.factor[0]), path.entry.reflect(wi));
  if (path.pick[kThrough] > 0) add(kThrough, path.at_exit * s.factor[1], path.exit.refract(wi));
  if (path.pick[kSecondary] > 0)
    add(kSecondary, path.at_second * s.factor[2], path.second.refract(wi));
  if (path.pick[kRest] > 0) {
    const float d =
        density_along(wi.y, cos_along(wi), s.wo.y, cos_along(s.wo), 4 * s.alpha) * (0.5f / kPi);
    // Without the secondary reflection light samples lack it, as in Cycles
    const bool counts = sampled || s.factor[2] > 0;
    add(kRest, path.rest, {grey(counts ? d : 0), d});
  }
  return sum;
}

// How light is thought to leave a smooth round strand, met here, of weight 1.
Rgb albedo_of(const FacetHairShape& s, float across) {
  float cos_t = 0;
  const float cosine = cos_of(across) * cos_along(s.wo);
  const float f = fresnel_dielectric(std::max(cosine, FacetBoundary::kLeastCosine), s.ior, &cos_t);
  const float way = 2 * cos_t / std::max(1 - sqr(s.wo.y / s.ior), FacetBoundary::kLeastCosine);
  const auto one = [&](float absorption) {
    const float a = std::exp(-absorption * way);
    return (a - 2 * f * a + f) / std::max(1 - f * a, FacetBoundary::kLeastCosine);
  };
  return {one(s.absorption.x), one(s.absorption.y), one(s.absorption.z)};
}

void set_axes(const FacetHairInputs& in, const Vec3& wo, FacetHairShape& out) {
  out.y = in.frame.tangent;
  const Vec3 across = cross(out.y, wo);
  const bool elliptic = in.aspect != 1 && length2(in.major) > 0;
  const Vec3 x = elliptic ? in.major - out.y * dot(in.major, out.y) : across;
  out.x = length2(x) > 1e-12f ? normalize(x) : Basis(out.y).tangent;
  out.z = cross(out.x, out.y);
}

}  // namespace

float facet_hair_width(const FacetHairInputs& in, const Vec3& wo) {
  if (in.aspect == 1 || !(length2(in.major) > 0)) return 1;
  FacetHairShape s;
  set_axes(in, wo, s);
  const float x = sqr(dot(wo, s.x)), z = sqr(dot(wo, s.z)), b = std::min(in.aspect, 1 / in.aspect);
  return x + z > 0 ? std::sqrt((z + sqr(b) * x) / (x + z)) : 1;
}

Lobe facet_hair_lobe(const View& view, const Vec3& weight, const Vec3& n,
                     const FacetHairInputs& in) {
  Lobe lobe;
  lobe.kind = LobeKind::kFacetHair;
  lobe.weight = lobe.layer = weight;
  lobe.albedo = average(weight);
  FacetHairShape& s = lobe.facet_hair;
  set_axes(in, view.wo, s);
  s.wo = {dot(view.wo, s.x), dot(view.wo, s.y), dot(view.wo, s.z)};
  s.absorption = in.absorption;
  s.alpha = in.roughness;
  s.ior = in.ior;
  s.tilt = -in.offset;
  // As in Cycles the major axis stays where it is for ratios above 1
  s.aspect = length2(in.major) > 0 ? std::min(in.aspect, 1 / in.aspect) : in.aspect;
  s.factor[0] = in.reflection, s.factor[1] = in.transmission, s.factor[2] = in.secondary;
  s.width = facet_hair_width(in, view.wo);
  // Of the side of wo alone, so that what a photon meets says nothing of where it leaves
  s.seed = view.towards_end ? hash_combine(in.seed, 1u) : in.seed;

  const bool whole = view.towards_end || in.coverage >= s.width;
  const float across = view.towards_end ? -in.frame.across : in.frame.across;
  const float half = in.coverage / s.width, at = -across / s.width;
  s.h_begin = whole ? -1 : std::clamp(at - half, -1.0f, 1.0f);
  s.h_end = whole ? 1 : std::clamp(at + half, -1.0f, 1.0f);
  const float wanted = 0.75f * (s.h_end - s.h_begin) / s.alpha;
  s.paths = static_cast<int>(std::clamp(wanted + 1, 3.0f, 1.0f * FacetHairShape::kMostPaths));

  lobe.t = s.y;
  const Basis facing(lobe.t);
  const Vec3 side = cross(s.y, view.wo);
  lobe.b = length2(side) > 1e-12f ? normalize(side) : facing.tangent;
  const Vec3 front = cross(lobe.b, s.y);
  lobe.n = in.frame.rounded ? lobe.b * across + front * cos_of(across) : n;
  lobe.scale = albedo_of(s, across);
  return lobe;
}

FacetValue evaluate_facet_hair(const Lobe& lobe, const Vec3& wi, bool sampled) {
  const FacetHairShape& s = lobe.facet_hair;
  const Vec3 own{dot(wi, s.x), dot(wi, s.y), dot(wi, s.z)};
  FacetValue sum{};
  for (int i = 0; i < s.paths; ++i) {
    const FacetValue value = evaluate_path(s, FacetHairPath(s, i), own, sampled);
    if (!is_finite(value.f) || !std::isfinite(value.pdf)) continue;
    sum.f += value.f;
    sum.pdf += value.pdf;
  }
  const float share = 1 / static_cast<float>(s.paths);
  return {sum.f * lobe.weight * share, sum.pdf * share};
}

bool sample_facet_hair(const Lobe& lobe, float choice, const Vec2& u, Vec3* wi) {
  const FacetHairShape& s = lobe.facet_hair;
  const float scaled = choice * static_cast<float>(s.paths);
  const int number = std::min(static_cast<int>(scaled), s.paths - 1);
  const FacetHairPath path(s, number);
  float left = scaled - static_cast<float>(number);
  int mode = 0;
  while (mode + 1 < kFacetHairModes && left >= path.pick[mode]) left -= path.pick[mode++];
  if (!(path.pick[mode] > 0)) return false;
  Vec3 own;
  if (mode == kRest) {
    const float x = std::clamp(left / path.pick[kRest], 0.0f, 1.0f);
    const float sine = sample_along(s.wo.y, cos_along(s.wo), 4 * s.alpha, {x, u.y});
    const float phi = 2 * kPi * u.x, cosine = cos_of(sine);
    own = {std::sin(phi) * cosine, sine, std::cos(phi) * cosine};
  } else {
    const FacetBoundary& last = mode == kReflected ? path.entry
                                : mode == kThrough ? path.exit
                                                   : path.second;
    const Vec3 h = last.facet(u);
    if (mode == kReflected)
      own = reflected(last.w, h);
    else if (!(dot(last.w, h) > 0) || !refract(last.w, h, last.ior, &own))
      return false;
    // Other paths may lead where this one does not
    if (!((mode == kReflected ? last.reflect(own) : last.refract(own)).pdf > 0)) return false;
  }
  *wi = normalize(s.x * own.x + s.y * own.y + s.z * own.z);
  return is_finite(*wi);
}

}  // namespace photon_splat
