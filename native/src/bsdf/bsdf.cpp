// What the lobes of a surface scatter together: values, densities, samples.
#include "bsdf/bsdf.h"

#include "bsdf/turned_glass.h"

namespace photon_splat {
namespace {

constexpr float kOrenNayarRest = 0.3f;  // about the share of it that no Lambertian has
constexpr float kStraight = 1 - 1e-6f;  // cosine from which on a normal is taken for not bent
// Cosine below which a bent normal's light has less to do with what photons bring to the surface
// than what is then taken off: |n - ns|^2 is 1, the norm of a Lambertian, at 60 degrees.
constexpr float kMostBent = 0.5f;
constexpr float kLeastCover = 0.05f;  // of a bent glossy lobe's samples
// Of the samples at a surface whose sides may differ: by rough boundaries as the other side has
// them, or anywhere on that side; the latter beside the former.
constexpr float kSentThrough = 0.25f, kSentAnywhere = 0.1f;

Vec3 unit_or(const Vec3& sum, const Vec3& otherwise) {
  const float len = length(sum);
  return len > 0 && std::isfinite(len) ? sum / len : otherwise;
}

// Of light that comes from one direction and leaves along another: by their cosines.
float flux_scale(const Vec3& ng, const Vec3& from, const Vec3& to) {
  return std::abs(dot(to, ng)) / std::max(std::abs(dot(from, ng)), 1e-6f);
}

// On the wrong side of the surface proper, a lobe scatters nothing.
bool right_side(const Lobe& lobe, const View& view, const Vec3& wi) {
  if (lobe.of_hair()) return true;
  return (dot(wi, view.ng) > 0) == (dot(wi, lobe.n) > 0);
}

// Directional, about.
Rgb albedo_of(const Lobe& lobe) {
  return lobe.of_facets() || lobe.kind >= LobeKind::kPrincipledHair ? lobe.scale * lobe.layer
                                                                    : lobe.weight;
}

// What photons estimate of the light that comes from wi, f |cos|.
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

void sum_gather(const LobeList& lobes, Rgb* same, Rgb* through) {
  for (const Lobe& lobe : lobes)
    (lobe.kind == LobeKind::kTranslucent ? *through : *same) += lobe.gather;
}

}  // namespace

Bsdf::Bsdf(Transport transport, const Vec3& wo, const Vec3& ng, const Vec3& ns, bool back)
    : transport_(transport), view_{wo, ng, ns, back} {}

void Bsdf::finish() {
  if (loses_below_) lobes_.drop_below();
  gather_ = gather_through_ = {};
  for (Lobe& lobe : lobes_)
    if (dot(lobe.n, view_.ns) < kMostBent) lobe.gather = {};
  if (gathers_) sum_gather(lobes_, &gather_, &gather_through_);
  rest_ = false;
  float total = 0, largest = 0;
  for (Lobe& lobe : lobes_) {
    const bool plain = lobe.kind == LobeKind::kLambert || lobe.kind == LobeKind::kTranslucent;
    if (!is_black(lobe.weight) && !(gathers_ && plain && dot(lobe.n, view_.ns) > 1 - 1e-6f))
      rest_ = true;
    largest = std::max(largest, lobe.albedo);
  }
  // A photon's lobes are weighed anew for the direction it leaves in: none that may count there is
  // left out.
  const float least =
      transport_ == Transport::kFlux ? 0.01f * std::max(largest, 1e-6f) : 1e-4f * largest;
  for (Lobe& lobe : lobes_) {
    // Towards which side of the cone a photon may leave a toon surface does not depend on where it
    // came from.
    if (transport_ == Transport::kFlux && lobe.kind == LobeKind::kToonDiffuse)
      lobe.kind = LobeKind::kLambert;
    lobe.pick = is_black(lobe.weight) && transport_ == Transport::kRadiance
                    ? 0
                    : std::max(lobe.albedo, least);
    total += lobe.pick;
  }
  for (Lobe& lobe : lobes_) lobe.pick = total > 0 ? lobe.pick / total : 0;
  if (transport_ == Transport::kFlux) cover_hemispheres();
}

void Bsdf::prefer_rest(float kept) {
  if (!gathers_) return;
  float total = 0;
  for (Lobe& lobe : lobes_) {
    if (lobe.kind == LobeKind::kLambert || lobe.kind == LobeKind::kTranslucent)
      lobe.pick *= std::clamp(length(lobe.n - view_.ns), kept, 1.0f);
    else if (lobe.kind == LobeKind::kOrenNayar)
      lobe.pick *= std::max(kept, kOrenNayarRest);
    total += lobe.pick;
  }
  for (Lobe& lobe : lobes_) lobe.pick = total > 0 ? lobe.pick / total : 0;
  cover_gathered();
}

// What photons estimate is taken off wherever the surface's shading normal sees light, below a bent
// normal's horizon too: there a lobe of no weight finds the directions.
void Bsdf::cover_gathered() {
  float same = 0, through = 0;
  for (Lobe& lobe : lobes_) {
    if (lobe.pick <= 0 || is_black(lobe.gather) || dot(lobe.n, view_.ns) > kStraight) continue;
    lobe.pick *= 0.5f;
    (lobe.kind == LobeKind::kTranslucent ? through : same) += lobe.pick;
  }
  add_cover(view_.ns, same, through);
}

// A photon may leave in every direction from which a camera path would see the bent surface lit:
// with the surface proper as its horizon, not the bent normal. A Lambertian sends it there in exact
// proportion to the surface's own cosine.
void Bsdf::cover_hemispheres() {
  float same = 0, through = 0;
  for (Lobe& lobe : lobes_) {
    const float cosine = dot(lobe.n, view_.ng);
    if (lobe.pick <= 0 || lobe.delta() || lobe.of_hair() || cosine > kStraight) continue;
    if (lobe.diffuse()) {
      const Basis basis(view_.ng);
      lobe.n = view_.ng, lobe.t = basis.tangent, lobe.b = basis.bitangent;
      continue;
    }
    const float moved = lobe.pick * std::clamp(1 - cosine, kLeastCover, 0.5f);
    const bool transmits = lobe.transmits();
    lobe.pick -= moved;
    same += transmits ? 0.5f * moved : moved;
    through += transmits ? 0.5f * moved : 0;
  }
  add_cover(view_.ng, same, through);
}

// Lobes of no weight about n, of these chances.
void Bsdf::add_cover(const Vec3& n, float same, float through) {
  const auto add = [&](LobeKind kind, float pick) {
    if (!(pick > 0)) return;
    lobes_.add([&] {
      Lobe lobe = lambert_lobe({}, n);
      lobe.kind = kind;
      lobe.pick = pick;
      return lobe;
    });
  };
  add(LobeKind::kLambert, same);
  add(LobeKind::kTranslucent, through);
}

void Bsdf::send_through(const Bsdf& other) {
  const auto refracts = [](const Lobe& lobe) {
    return lobe.of_facets() && lobe.transmits() && !lobe.delta() && lobe.pick > 0;
  };
  float all = 0;
  for (const Lobe& lobe : other.lobes_) all += refracts(lobe) ? lobe.pick : 0;
  const bool only_smooth = std::ranges::none_of(
      other.lobes_, [](const Lobe& lobe) { return lobe.transmits() && !lobe.delta(); });
  if (only_smooth) return;
  const float cover = all > 0 ? kSentAnywhere : kSentThrough,
              by_facets = all > 0 ? kSentThrough : 0;
  for (Lobe& lobe : lobes_) lobe.pick *= 1 - cover - by_facets;
  add_cover(view_.ng, 0, cover);
  for (const Lobe& lobe : other.lobes_)
    if (refracts(lobe))
      lobes_.add([&] {
        Lobe copy = lobe;
        copy.weight = copy.scale = {};
        copy.albedo = 0;
        copy.pick = by_facets * lobe.pick / all;
        return copy;
      });
}

void Bsdf::send_back() {
  for (Lobe& lobe : lobes_) lobe.pick *= 1 - kSentAnywhere;
  add_cover(view_.ng, kSentAnywhere, 0);
}

Bsdf::SmoothWays Bsdf::smooth_ways(const Vec3& light) const {
  SmoothWays out;
  for (int i = 0; i < lobes_.size(); ++i) {
    const Lobe& lobe = lobes_[i];
    if (!lobe.delta() || !lobe.transmits()) continue;
    if (out.count == std::ssize(out.ways)) break;
    if (const auto way = way_through(view_, lobe.given, light, lobe.fresnel.ior))
      out.ways[out.count++] = {i, way->to, way->spread};
  }
  return out;
}

std::optional<Vec3> Bsdf::way_on() const {
  for (const Lobe& lobe : lobes_) {
    Vec3 way;
    if (lobe.of_facets() && lobe.transmits() && refract(view_.wo, lobe.n, lobe.fresnel.ior, &way) &&
        right_side(lobe, view_, way))
      return way;
  }
  return {};
}

bool Bsdf::has_smooth_glass() const {
  return std::ranges::any_of(lobes_,
                             [](const Lobe& lobe) { return lobe.delta() && lobe.transmits(); });
}

Rgb Bsdf::smooth_share(int lobe) const {
  if (lobe >= lobes_.size()) return {};
  const Lobe& l = lobes_[lobe];
  if (!l.delta() || !l.transmits()) return {};
  return l.weight * evaluate_fresnel(l.fresnel, dot(l.n, view_.wo)).transmit;
}

float Bsdf::smooth_chance(bool sharp) const {
  float all = 0, through = 0;
  for (const Lobe& lobe : lobes_) {
    all += sharp ? sharp_pick(lobe) : lobe.pick;
    Vec3 way;
    if (!lobe.delta() || !lobe.transmits() || !refract(view_.wo, lobe.n, lobe.fresnel.ior, &way) ||
        !right_side(lobe, view_, way))
      continue;
    const float cosine = dot(lobe.n, view_.wo);
    through += lobe.pick * (1 - reflect_probability(evaluate_fresnel(lobe.fresnel, cosine)));
  }
  return all > 0 ? through / all : 0;
}

bool Bsdf::keep_turned() {
  float total = 0;
  for (Lobe& lobe : lobes_) {
    if (!lobe.turned()) lobe.weight = {}, lobe.pick = 0;
    total += lobe.pick;
  }
  lobes_.drop_below();
  gather_ = gather_through_ = {};
  rest_ = total > 0;
  for (Lobe& lobe : lobes_) lobe.pick = total > 0 ? lobe.pick / total : 0;
  return total > 0;
}

bool Bsdf::transmits() const {
  for (const Lobe& lobe : lobes_) {
    if (lobe.pick <= 0) continue;
    if (lobe.transmits()) return true;
  }
  return false;
}

bool Bsdf::scatters() const {
  if (lobes_.below_count() > 0) return true;
  for (const Lobe& lobe : lobes_)
    if (lobe.pick > 0) return true;
  return false;
}

bool Bsdf::only_delta() const {
  for (const Lobe& lobe : lobes_)
    if (lobe.pick > 0 && !lobe.delta()) return false;
  return scatters();
}

Rgb Bsdf::below_weight() const {
  Rgb sum{};
  for (int i = 0; i < below_count(); ++i) sum += below(i).weight;
  return sum;
}

bool Bsdf::has_rest() const { return rest_; }

Rgb Bsdf::albedo() const { return below_weight() + sharp_albedo(1); }

Rgb Bsdf::sharp_albedo(float roughness) const {
  Rgb sum{};
  for (const Lobe& lobe : lobes_)
    if (roughness >= 1 || lobe.roughness() <= roughness) sum += albedo_of(lobe);
  return sum;
}

Bsdf::Colors Bsdf::colors() const {
  Colors sum;
  for (const Lobe& lobe : lobes_) {
    if (lobe.diffuse()) continue;
    const Rgb albedo = albedo_of(lobe);
    if (lobe.kind >= LobeKind::kPrincipledHair) {
      sum.glossy += albedo;
      sum.transmission += albedo;
      continue;
    }
    const bool passes =
        lobe.kind == LobeKind::kThinFacets || lobe.kind == LobeKind::kHairTransmission;
    const Rgb reflected = passes                           ? Rgb{}
                          : lobe.kind == LobeKind::kFacets ? albedo * reflected_share(lobe)
                                                           : albedo;
    sum.glossy += reflected;
    sum.transmission += albedo - reflected;
  }
  return sum;
}

Vec3 Bsdf::mean_normal() const {
  Vec3 sum{};
  for (const Lobe& lobe : lobes_) sum += lobe.n * lobe.albedo;
  for (int i = 0; i < below_count(); ++i) sum += below(i).n * average(below(i).weight);
  return unit_or(sum, view_.ns);
}

Vec3 Bsdf::mean_diffuse_normal() const {
  Vec3 sum{};
  for (const Lobe& lobe : lobes_)
    if (lobe.diffuse()) sum += lobe.n * average(lobe.weight);
  return unit_or(sum, view_.ns);
}

Rgb Bsdf::diffuse_albedo() const {
  Rgb sum = below_weight();
  for (const Lobe& lobe : lobes_)
    if (lobe.diffuse()) sum += albedo_of(lobe);
  return sum;
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

float Bsdf::scale_of_flux(const Vec3& wi) const { return flux_scale(view_.ng, view_.wo, wi); }

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
    if (gathers_) sum_gather(lobes, &same, &through);
    *rest = (sum - gathered(view, view_.wo, same, through)) * scale;
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
  if (rest) *rest = rest_ ? sum - gathered(view, wi, gather_, gather_through_) : Rgb{};
  if (diffuse) *diffuse = soft;
  return sum;
}

// A mirror's or smooth boundary's share; `out.direction` is known.
std::optional<BsdfSample> Bsdf::finish_delta(int index, BsdfSample out) const {
  const Lobe& lobe = lobes_[index];
  if (!right_side(lobe, view_, out.direction)) return std::nullopt;
  const float cosine = dot(lobe.n, view_.wo);
  const float reflect = reflect_probability(evaluate_fresnel(lobe.fresnel, cosine));
  const float chance = lobe.pick * (out.transmitted ? 1 - reflect : reflect);
  if (!(chance > 0)) return std::nullopt;
  const auto share = [&](const Lobe& l, float c) {
    const FresnelValue f = evaluate_fresnel(l.fresnel, c);
    return l.weight * (out.transmitted ? f.transmit : f.reflect);
  };
  if (transport_ == Transport::kRadiance) {
    out.weight = share(lobe, cosine) / chance;
  } else {
    const View view = view_.towards(out.direction);
    LobeList lobes;
    expand(view, lobes);
    const float cos_out = std::abs(dot(lobe.n, out.direction));
    float scale = scale_of_flux(out.direction);
    if (out.transmitted) scale *= cosine / std::max(sqr(lobe.fresnel.ior) * cos_out, 1e-6f);
    // Light goes out of a strand without another refraction, which would undo that
    if (out.transmitted && !gathers_) scale = 1;
    if (index < lobes.size()) out.weight = share(lobes[index], cos_out) * (scale / chance);
  }
  out.rest = out.weight;
  out.by_turned_normal = !out.transmitted && lobe.turned();
  return out;
}

std::optional<BsdfSample> Bsdf::sample(float choice, const Vec2& u) const {
  int index = -1;
  float along = u.x;
  for (int i = 0; i < lobes_.size(); ++i) {
    const float pick = lobes_[i].pick;
    if (pick <= 0) continue;
    index = i;
    if (along < pick) break;
    along -= pick;
  }
  if (index < 0) return std::nullopt;
  const Lobe& lobe = lobes_[index];
  const Vec2 left{std::clamp(along / lobe.pick, 0.0f, kBelowOne), u.y};
  return sample_lobe(index, lobe.delta() ? left.x : choice, left);  // a delta needs no place
}

float Bsdf::sharp_pick(const Lobe& lobe) const {
  return gathers_ && !lobe.diffuse() && sharpness(lobe.roughness()) > 0 ? lobe.pick : 0;
}

std::optional<BsdfSample> Bsdf::sample_sharp(float choice, const Vec2& u) const {
  float total = 0;
  int index = -1;
  for (const Lobe& lobe : lobes_) total += sharp_pick(lobe);
  choice *= total;
  for (int i = 0; i < lobes_.size(); ++i) {
    const float share = sharp_pick(lobes_[i]);
    if (share <= 0) continue;
    index = i;
    if (choice < share) break;
    choice -= share;
  }
  if (index < 0) return std::nullopt;
  auto s = sample_lobe(index, choice / lobes_[index].pick, u);
  if (s) s->weight *= total, s->rest *= total, s->per_value *= total;
  return s;
}

std::optional<BsdfSample> Bsdf::sample_lobe(int index, float choice, const Vec2& u) const {
  const Lobe& lobe = lobes_[index];
  BsdfSample out;
  if (!lobe.sample(view_, std::clamp(choice, 0.0f, 0.99999994f), u, &out.direction))
    return std::nullopt;
  out.transmitted = lobe.of_hair() ? hair_transmits(lobe, choice) : dot(out.direction, lobe.n) < 0;
  out.diffuse = lobe.diffuse();
  out.roughness = gathers_ ? lobe.roughness() : 1;
  if (lobe.delta()) return finish_delta(index, out);
  out.by_turned_normal = turned_apart_ && transport_ == Transport::kRadiance && lobe.turned();
  if (!right_side(lobe, view_, out.direction)) return std::nullopt;
  const Rgb f = evaluate_as(view_, out.direction, &out.pdf, &out.rest, nullptr, nullptr, index);
  if (!(out.pdf > 0) || !std::isfinite(out.pdf)) return std::nullopt;
  out.weight = f / out.pdf;
  if (transport_ == Transport::kFlux) out.per_value = scale_of_flux(out.direction) / out.pdf;
  out.rest = out.rest / out.pdf;
  if (!is_finite(out.weight) || !is_finite(out.rest)) return std::nullopt;
  return out;
}

}  // namespace photon_splat
