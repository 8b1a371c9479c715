#include "bsdf/principled.h"

namespace photon_splat {

void make_clean(PrincipledInputs& in) {
  const auto unit = [](float& x, float otherwise) { x = clean(x, 0, 1, otherwise); };
  in.base_color = clean_color(in.base_color);
  in.specular_tint = clean_color(in.specular_tint);
  in.emission_color = clean_color(in.emission_color);
  unit(in.metallic, 0), unit(in.roughness, 0.5f), unit(in.diffuse_roughness, 0),
      unit(in.subsurface_weight, 0);
  unit(in.transmission_weight, 0), unit(in.alpha, 1);
  in.coat_weight = clean(in.coat_weight, 0, 1e6f, 0);
  in.sheen_weight = clean(in.sheen_weight, 0, 1e6f, 0);
  if (in.coat_weight > 0) {
    in.coat_tint = clean_color(in.coat_tint);
    unit(in.coat_roughness, 0);
    in.coat_ior = clean(in.coat_ior, 1, 1e5f, 1.5f);
  }
  if (in.sheen_weight > 0) {
    in.sheen_tint = clean_color(in.sheen_tint);
    unit(in.sheen_roughness, 0.5f);
  }
  in.ior = clean(in.ior, 1e-5f, 1e5f, 1.5f);
  in.specular_level = clean(in.specular_level, 0, 1e6f, 0.5f);
  unit(in.anisotropic, 0);
  in.anisotropic_rotation = clean(in.anisotropic_rotation, -1e4f, 1e4f, 0);
  in.emission_strength = clean(in.emission_strength, 0, 1e10f, 0);
  if (in.subsurface_weight > 0) make_clean(in.subsurface);
  in.thin_film_thickness = clean(in.thin_film_thickness, 0, 1e5f, 0);
  in.thin_film_ior = clean(in.thin_film_ior, 1e-5f, 1e5f, 1.33f);
  if (!is_finite(in.tangent)) in.tangent = {};
}

namespace {

constexpr float kSmoothest = 1e-5f;  // diffuse roughness that counts as none

// What is left under a layer whose albedo is given, without tinting it.
float under(const Rgb& albedo) { return saturate(1 - max_component(albedo)); }

Rgb power(const Rgb& c, float e) { return {std::pow(c.x, e), std::pow(c.y, e), std::pow(c.z, e)}; }

// What a pane of glass reflects and lets through by all ways between its two sides, seen under mu.
// `clear`: what is left of light on one way through it, at a right angle.
struct Pane {
  Rgb reflect, transmit;
};

Pane pane(const FresnelTerms& front, const Rgb& clear, float mu) {
  float inside;
  fresnel_dielectric(mu, front.ior, &inside);
  const FresnelValue outer = evaluate_fresnel(front, mu);
  if (!(inside > 0)) return {outer.reflect, {}};
  FresnelValue inner = outer;
  if (front.film_thickness > kThinnestFilm) {
    FresnelTerms back = front;
    back.ior = 1 / front.ior;
    back.film_ior = front.film_ior / front.ior;
    inner = evaluate_fresnel(back, inside);
  }
  const Rgb way = power(clear, 1 / inside), echo = way * inner.reflect;
  const auto series = [](float r) { return 1 / std::max(1 - r * r, 1e-6f); };
  const Rgb transmit =
      way * outer.transmit * inner.transmit * Rgb{series(echo.x), series(echo.y), series(echo.z)};
  return {outer.reflect + transmit * echo, transmit};
}

// Glass of two sides so close to each other that it bends nothing (the thin-walled case of
// OpenPBR). Rough, it scatters as two boundaries do (Kulla and Conty 2017, "Revisiting physically
// based shading at Imageworks"). Neither lobe loses energy between facets, as in Cycles (measured).
void add_thin_glass(const Rgb& weight, const PrincipledInputs& in, const View& view,
                    const Vec3& normal, const FacetShape& shape, LobeList& out) {
  FresnelTerms f;
  f.kind = FresnelKind::kDielectric;
  f.ior = in.ior;
  f.f0 = in.specular_tint * f0_from_ior(f.ior);
  f.transmit_tint = kWhite;
  f.film_thickness = in.thin_film_thickness;
  f.film_ior = in.thin_film_ior;
  const Pane share = pane(f, min(in.base_color, kWhite), saturate(dot(normal, view.wo)));
  const FresnelTerms all;
  FacetShape back = shape;
  back.between = min(in.specular_tint, kWhite);
  out.add([&] { return facet_lobe(view, weight * share.reflect, normal, back, all); });
  const float ior = in.ior,
              widening = std::max(3.4f * (ior - 1) * sqr(ior - 0.5f) / (ior * ior * ior), 0.0f);
  FacetShape through = shape;
  through.roughness = shape.roughness * std::sqrt(std::sqrt(widening));
  if (sqr(sqr(through.roughness)) <= Facets::kDeltaArea)
    return out.go_straight(weight * share.transmit);
  out.add([&] {
    Lobe lobe = facet_lobe(view, weight * share.transmit, normal, through, all);
    lobe.kind = LobeKind::kThinFacets;
    return lobe;
  });
}

// The layers, from the outermost in. Each takes from the weight what it keeps from those below.
struct Layers {
  const PrincipledInputs& in;
  const View& view;
  LobeList& out;
  Vec3 normal, coat_normal;
  Rgb base, weight;
  FacetShape shape;  // of the facets of metal and gloss

  void sheen();
  void coat();
  void metal();
  void glass();
  float gloss();  // the index of refraction of what is below it
  // False where nothing is left of the light.
  bool thin_body();
  bool subsurface(float ior, SubsurfaceUse use);
  void diffuse(SubsurfaceUse use);

 private:
  FresnelTerms dielectric(float ior) const {
    FresnelTerms f;
    f.kind = FresnelKind::kDielectric;
    f.ior = ior;
    return f;
  }
  FacetShape isotropic() const {
    FacetShape s = shape;
    s.along = s.across = 1;
    return s;
  }
};

FacetShape facets_of(const PrincipledInputs& in) {
  FacetShape shape;
  shape.preserve_energy = in.distribution == Distribution::kMultiGgx;
  shape.beckmann = in.distribution == Distribution::kBeckmann;
  shape.roughness = in.roughness;
  const float aspect =
      std::sqrt(1 - 0.9f * in.anisotropic);  // Burley 2012, "Physically based shading at Disney"
  shape.along = 1 / aspect;
  shape.across = aspect;
  shape.rotation = in.anisotropic_rotation;
  shape.tangent = in.tangent;
  return shape;
}

void Layers::sheen() {
  const Vec3 mixed = lerp(normal, coat_normal, std::min(in.coat_weight, 1.0f));
  const Rgb tint = in.sheen_tint * in.sheen_weight;
  const Lobe whole = sheen_lobe(view, tint, length2(mixed) > 1e-12f ? normalize(mixed) : normal,
                                in.sheen_roughness);
  Lobe scaled = whole;
  scaled.weight *= weight;
  scaled.gather *= weight;
  scaled.albedo = average(scaled.weight);
  out.add([&] { return scaled; });
  weight *= under(whole.weight);
}

void Layers::coat() {
  FresnelTerms f = dielectric(in.coat_ior);
  const float f0 = f0_from_ior(f.ior);
  f.f0 = {f0, f0, f0};
  FacetShape smooth;
  smooth.preserve_energy = true;
  smooth.roughness = in.coat_roughness;
  const Lobe& lobe =
      out.add([&] { return facet_lobe(view, weight * in.coat_weight, coat_normal, smooth, f); });
  weight *= under(lobe.layer * in.coat_weight);
  if (in.coat_tint.x == 1 && in.coat_tint.y == 1 && in.coat_tint.z == 1) return;
  // Absorption along the refracted ray's way through the coat and back.
  const float cos_i = saturate(dot(lobe.n, view.wo));
  const float cos_t = std::sqrt(std::max(1e-6f, 1 - (1 - sqr(cos_i)) / sqr(in.coat_ior)));
  weight *=
      max(lerp(kWhite, min(power(in.coat_tint, 1 / cos_t), kWhite * 1e4f), in.coat_weight), {});
}

void Layers::metal() {
  FresnelTerms f;
  f.kind = FresnelKind::kF82;
  f.f0 = base;
  f.f90 = min(in.specular_tint, kWhite);
  f.film_thickness = in.thin_film_thickness;
  f.film_ior = in.thin_film_ior;
  out.add([&] { return facet_lobe(view, weight * in.metallic, normal, shape, f); });
  weight *= 1 - in.metallic;
}

void Layers::glass() {
  FacetShape round = isotropic();
  const Rgb share = weight * in.transmission_weight;
  weight *= 1 - in.transmission_weight;
  if (in.thin_wall) {
    round.preserve_energy = true;
    return add_thin_glass(share, in, view, normal, round, out);
  }
  FresnelTerms f = dielectric(view.back ? 1 / in.ior : in.ior);
  f.f0 = in.specular_tint * f0_from_ior(f.ior);
  f.transmit_tint = {std::sqrt(base.x), std::sqrt(base.y), std::sqrt(base.z)};
  f.film_thickness = in.thin_film_thickness;
  f.film_ior = view.back ? in.thin_film_ior / in.ior : in.thin_film_ior;
  if (bends_nothing(in.ior))
    add_straight_glass(view, share, normal, round, f, out);
  else
    out.add([&] { return facet_lobe(view, share, normal, round, f); });
}

float Layers::gloss() {
  FresnelTerms f = dielectric(in.ior);
  float f0 = f0_from_ior(in.ior);
  if (in.specular_level != 0.5f) {
    f0 *= 2 * in.specular_level;
    f.ior = ior_from_f0(f0);
    if (in.ior < 1) f.ior = 1 / f.ior;
  }
  f.f0 = min(in.specular_tint * f0, kWhite);
  f.film_thickness = in.thin_film_thickness;
  f.film_ior = in.thin_film_ior;
  if (f.ior != 1 || f.film_thickness > kThinnestFilm)
    weight *= under(out.add([&] { return facet_lobe(view, weight, normal, shape, f); }).layer);
  return f.ior;
}

bool Layers::thin_body() {
  const Rgb thin = weight * base * in.subsurface_weight;
  const float back = 0.5f * (1 - in.subsurface.anisotropy);
  if (in.diffuse_roughness > kSmoothest)
    out.add([&] { return oren_nayar_lobe(view, thin * back, normal, in.diffuse_roughness, base); });
  else
    out.add([&] { return lambert_lobe(thin * back, normal); });
  out.add([&] { return translucent_lobe(view, thin * (1 - back), normal); });
  weight *= 1 - in.subsurface_weight;
  return in.subsurface_weight != 1;
}

bool Layers::subsurface(float ior, SubsurfaceUse use) {
  SubsurfaceInputs below = in.subsurface;
  below.normal = in.normal;
  below.color = base;
  below.alpha = sqr(in.roughness);
  if (below.method != SubsurfaceMethod::kRandomWalkSkin) below.ior = ior;
  make_clean(below);
  expand_subsurface(weight * base * in.subsurface_weight, below, view, use, out);
  weight *= 1 - in.subsurface_weight;
  return in.subsurface_weight != 1;
}

void Layers::diffuse(SubsurfaceUse use) {
  const bool rough = in.diffuse_roughness > kSmoothest;
  const bool whole = use != SubsurfaceUse::kNone || in.thin_wall;  // `weight` lacks the rest
  const float rough_share = !rough ? 0 : whole ? 1 : 1 - in.subsurface_weight;
  const Rgb color = weight * in.base_color;
  if (rough_share > 0)
    out.add([&] {
      return oren_nayar_lobe(view, color * rough_share, normal, in.diffuse_roughness,
                             in.base_color);
    });
  if (rough_share < 1) out.add([&] { return lambert_lobe(color * (1 - rough_share), normal); });
}

}  // namespace

// Which lobes come out depends on the inputs alone, never on the view: adjoints match lobes of two
// views by number.
void expand_principled(const Rgb& outer, const PrincipledInputs& in, const View& view,
                       SubsurfaceUse use, LobeList& out) {
  const Vec3 normal = view.turned(in.normal);
  if (in.alpha < 1) out.transparency += outer * (1 - in.alpha);
  Layers layers{in,
                view,
                out,
                normal,
                in.coat_weight > 0 ? view.turned(in.coat_normal) : normal,
                min(in.base_color, kWhite),
                outer * in.alpha,
                facets_of(in)};
  if (in.sheen_weight > 0) layers.sheen();
  if (in.coat_weight > 0) layers.coat();
  if (in.emission_strength > 0)
    out.emission += layers.weight * in.emission_color * in.emission_strength;
  if (in.metallic > 0) layers.metal();
  if (in.transmission_weight > 0) layers.glass();
  if (in.metallic >= 1 || in.transmission_weight >= 1) return;
  const float ior = layers.gloss();
  if (in.subsurface_weight > 0) {
    if (in.thin_wall) {
      if (!layers.thin_body()) return;
    } else if (use != SubsurfaceUse::kNone && !layers.subsurface(ior, use)) {
      return;
    }
  }
  layers.diffuse(use);
}

}  // namespace photon_splat
