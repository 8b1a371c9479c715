// Directions drawn in proportion to the lobes.
#include "bsdf/bsdf.h"

namespace photon_splat {

// A mirror's or smooth boundary's share; `out.direction` is known.
std::optional<BsdfSample> Bsdf::finish_delta(int index, BsdfSample out) const {
  const Lobe& lobe = lobes_[index];
  if (!lobe.on_right_side(view_, out.direction)) return std::nullopt;
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
    if (!out.transmitted) out.per_value = scale / chance;
  }
  out.rest = out.weight;
  out.by_turned_normal = !out.transmitted && lobe.turned();
  return out;
}

std::optional<BsdfSample> Bsdf::sample(float choice, const Vec2& u, const Towards& towards) const {
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
  // A delta needs no place
  return sample_lobe(index, lobe.delta() ? left.x : choice, left, towards);
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

// What those drawn towards a cone add to the density.
float Bsdf::more_towards(const Towards& towards, const Vec3& wi) const {
  float picks = 0;
  for (const Lobe& lobe : lobes_)
    if (lobe.pick > 0 && lobe.diffuse() && lobe.on_right_side(view_, wi)) picks += lobe.pick;
  return picks * towards.pdf(wi);
}

std::optional<BsdfSample> Bsdf::sample_lobe(int index, float choice, const Vec2& u,
                                            const Towards& towards) const {
  const Lobe& lobe = lobes_[index];
  BsdfSample out;
  out.lobe = index;
  if (towards.drawn && !lobe.diffuse()) return std::nullopt;
  if (towards.drawn)
    out.direction = towards.cone.sample(u);
  else if (!lobe.sample(view_, std::clamp(choice, 0.0f, 0.99999994f), u, &out.direction))
    return std::nullopt;
  out.transmitted = lobe.of_hair() ? hair_transmits(lobe, choice) : dot(out.direction, lobe.n) < 0;
  out.diffuse = lobe.diffuse();
  out.roughness = gathers_ ? lobe.roughness() : 1;
  if (lobe.delta()) return finish_delta(index, out);
  out.by_turned_normal = turned_apart_ && transport_ == Transport::kRadiance && lobe.turned();
  if (!lobe.on_right_side(view_, out.direction)) return std::nullopt;
  const Rgb f = evaluate_as(view_, out.direction, &out.pdf, &out.rest, nullptr, nullptr, index);
  if (towards.chance > 0) {
    const float own = out.pdf;
    out.pdf += more_towards(towards, out.direction);
    out.favour = own / out.pdf;
  }
  if (!(out.pdf > 0) || !std::isfinite(out.pdf)) return std::nullopt;
  out.weight = f / out.pdf;
  if (transport_ == Transport::kFlux) out.per_value = scale_of_flux(out.direction) / out.pdf;
  out.rest = out.rest / out.pdf;
  if (!is_finite(out.weight) || !is_finite(out.rest)) return std::nullopt;
  return out;
}

}  // namespace photon_splat
