// What the lobes of a surface scatter together, of light from a direction.
#include "bsdf/bsdf.h"
#include "math/bumps.h"

namespace photon_splat {
namespace {

// What photons estimate of the light that comes from wi, f |cos|, where there are no bumps.
Rgb gathered(const View& view, const Vec3& wi, const Rgb& same, const Rgb& through) {
  const float cosine = dot(wi, view.ns);
  if (dot(wi, view.ng) > 0) return cosine > 0 ? same * (cosine / kPi) : Rgb{};
  return cosine < 0 ? through * (-cosine / kPi) : Rgb{};
}

float strand_width(const Lobe& lobe) {
  return lobe.kind == LobeKind::kFacetHair ? lobe.facet_hair.width : 1;
}

// Light that comes from one direction meets a strand as wide as it is seen from there.
float around_strand(const Lobe& lobe_out, const Vec3& out, const Lobe& lobe_in, const Vec3& in) {
  const Vec3& tangent = lobe_out.t;
  const float seen_out = length(out - tangent * dot(tangent, out)) * strand_width(lobe_out),
              seen_in = length(in - tangent * dot(tangent, in)) * strand_width(lobe_in);
  return seen_out / std::max(seen_in, 1e-4f);
}

}  // namespace

Bsdf::Bsdf(Transport transport, const Vec3& wo, const Vec3& ng, const Vec3& ns, bool back)
    : transport_(transport), view_{wo, ng, ns, back} {}

// Of light that comes from wo and leaves along wi: by their cosines.
float Bsdf::scale_of_flux(const Vec3& wi) const {
  return std::abs(dot(wi, view_.ng)) / std::max(std::abs(dot(view_.wo, view_.ng)), 1e-6f);
}

// The radiance BSDF with the two directions exchanged: photons come from wo and leave along wi.
// Densities on a surface are per area of the surface proper: Veach 1997, section 5.3.
Rgb Bsdf::adjoint(const Vec3& wi, Rgb* rest, Rgb* diffuse) const {
  const View view = view_.towards(wi);
  const float scale = scale_of_flux(wi);
  LobeList lobes;
  expand(view, lobes);
  Rgb sum{}, soft{};
  for (int i = 0; i < lobes.size(); ++i) {
    const Lobe& lobe = lobes[i];
    if (turned_apart_ && lobe.turned()) continue;
    Rgb f = lobe.evaluate(view, view_.wo).f;
    if (lobe.of_hair()) f *= around_strand(lobe, wi, lobes_[i], view_.wo) / std::max(scale, 1e-20f);
    sum += f;
    if (lobe.diffuse()) soft += f;
  }
  if (rest) {
    Rgb same{}, through{};
    if (gathers_) lobes.sum_gather(&same, &through);
    *rest = (sum - photon_splat::gathered(view, view_.wo, same, through)) * scale;
  }
  if (diffuse) *diffuse = soft * scale;
  return sum * scale;
}

Rgb Bsdf::evaluate(const Vec3& wi, float* pdf, Rgb* rest, Rgb* diffuse, float* sharp) const {
  return evaluate_as(view_, wi, pdf, rest, diffuse, sharp, -1);
}

Rgb Bsdf::evaluate_light(const Vec3& wi, OfLight how, float* pdf, Rgb* diffuse,
                         float* sharp) const {
  if (!(dot(wi, view_.ng) < 0)) return evaluate_as(view_, wi, pdf, nullptr, diffuse, sharp, -1);
  View view = view_;
  view.lit = how.lit;
  if (how.bent && dot(wi, view.bent) > 0) view.ng = view.bent;
  return evaluate_as(view, wi, pdf, nullptr, diffuse, sharp, -1);
}

Rgb Bsdf::evaluate_as(const View& view, const Vec3& wi, float* pdf, Rgb* rest, Rgb* diffuse,
                      float* sharp, int sampled) const {
  const bool radiance = transport_ == Transport::kRadiance;
  Rgb sum{}, soft{};
  float density = 0, sharp_density = 0;
  for (int i = 0; i < lobes_.size(); ++i) {
    const Lobe& lobe = lobes_[i];
    if (lobe.pick <= 0) continue;
    const FacetValue value = lobe.evaluate(view, wi, i == sampled);
    density += lobe.pick * value.pdf;
    if (sharp && gathers_ && !lobe.diffuse() && !(turned_apart_ && lobe.turned()))
      sharp_density += lobe.pick * value.pdf * sharpness(lobe.roughness());
    if (!radiance) continue;
    sum += value.f;
    if (lobe.diffuse()) soft += value.f;
  }
  if (pdf) *pdf = density;
  if (sharp) *sharp = density > 0 ? sharp_density / density : 0;
  if (!radiance) return adjoint(wi, rest, diffuse);
  if (rest) *rest = rest_ ? sum - gathered(wi) : Rgb{};
  if (diffuse) *diffuse = soft;
  return sum;
}

Rgb Bsdf::gathered(const Vec3& wi) const {
  if (part_count_ == 0) return photon_splat::gathered(view_, wi, gather_, gather_through_);
  const bool through = !(dot(wi, view_.ng) > 0);
  const float side = through ? -1.0f : 1.0f, cosine = side * dot(wi, view_.ns);
  if (!(cosine > 0)) return {};
  const Vec3 ng = view_.ng * side;
  const Vec3 way = way_over_cosine(way_for_smooth(wi, ng, view_.ns * side), ng);
  Rgb sum{};
  for (const Part& part : gather_parts())
    if (part.through == through) sum += part.albedo * (1 + dot(part.offset, way));
  return sum * (cosine / kPi);
}

Rgb Bsdf::diffuse_share(const BsdfSample& s, float light_pdf) const {
  if (!has_rest() || !(s.pdf > 0)) return s.diffuse ? Rgb{1, 1, 1} : Rgb{};
  return diffuse_share(s.direction, light_pdf);
}

Rgb Bsdf::diffuse_share(const Vec3& wi, float light_pdf) const {
  float pdf;
  Rgb diffuse;
  const Rgb whole = evaluate(wi, &pdf, nullptr, &diffuse);
  const Rgb by_value = divided(diffuse, whole);
  if (!(light_pdf < INFINITY)) return by_value;
  const Drawn rays = drawn(wi);
  const float both = rays.pdf * rays.pdf + light_pdf * light_pdf;
  const float by_rays = both > 0 ? rays.pdf * rays.pdf / both : 1;
  return by_value * (1 - by_rays) + Rgb{1, 1, 1} * (rays.diffuse * by_rays);
}

Bsdf::Drawn Bsdf::drawn(const Vec3& wi) const {
  LobeList seen;
  const bool radiance = transport_ == Transport::kRadiance;
  const View view = radiance ? view_ : view_.towards(wi);
  if (!radiance) expand(view, seen);
  float all = 0, density = 0, diffuse = 0;
  for (const Lobe& lobe : radiance ? lobes_ : seen) {
    if (!(lobe.albedo > 0)) continue;
    const float part = lobe.albedo * lobe.evaluate(view, radiance ? wi : view_.wo).pdf;
    all += lobe.albedo;
    density += part;
    if (lobe.diffuse()) diffuse += part;
  }
  return density > 0 ? Drawn{density / all, diffuse / density} : Drawn{0, 0};
}

float Bsdf::ray_pdf(const Vec3& wi) const { return drawn(wi).pdf; }

}  // namespace photon_splat
