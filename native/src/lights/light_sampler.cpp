// Direct light: one light drawn from a place in about its share of the light there, and rays that
// meet lights, weighted by multiple importance sampling.
#include <bit>

#include "lights/lights.h"

namespace photon_splat {
namespace {

constexpr float kGolden = 0.61803399f;
constexpr float kGuided = 0.85f;  // of the world's samples, where there is a guide

// On the circle of circumference 1.
float shifted(float u, float by) { return std::min(u + by - std::floor(u + by), kBelowOne); }

// Where u lies in [begin, begin + share), 0 to 1. Whoever chooses by a number of a pair and places
// by what is left of it keeps the order of low-discrepancy points within each choice.
float left_of(float u, float begin, float share) {
  return std::clamp((u - begin) / share, 0.0f, kBelowOne);
}

// At least, of a share of light that is known for the middle of an emitter alone
constexpr float kLeastShare = 0.1f;

// About the mean cosine to what reaches `radius` around a middle that far away.
float mean_cosine(float along, float distance, float radius) {
  const float reach = 0.5f * radius;
  return std::clamp((along + reach) / (distance + reach), kLeastShare, 1.0f);
}

// Chance that Cycles is thought to give the world where there are lights too
constexpr float kWorldBesideLights = 0.5f;
// Of Environment::contrast(), where light samples have a part of the world's light to themselves
constexpr float kLeastOfSharing = 0.5f;

float power_heuristic(float a, float b) {
  if (!(a < 1e18f)) return 1;  // a delta
  return a * a / (a * a + b * b);
}

}  // namespace

float Lights::emitter_weight(const Emitter& e, const Receiver& to) const {
  if (!(e.lit_groups & to.group)) return 0;
  const Lamp* const lamp = e.lamp >= 0 ? &lamps_[e.lamp] : nullptr;
  const Vec3 horizon = to.horizon();
  const bool cosine = !to.sharp && !is_black(horizon);
  if (lamp && lamp->s.kind == LampKind::kSun) {
    const float height = dot(horizon, -lamp->forward), reach = std::sqrt(2 * lamp->one_minus_cos);
    if (height + reach < 0) return 0;
    return e.importance * (cosine ? mean_cosine(height, 1, reach) : 1);
  }
  const Vec3 to_center = e.center - to.x;
  const float height = dot(horizon, to_center);
  if (height < -e.radius) return 0;  // wholly below the horizon
  const float distance2 = length2(to_center), distance = std::sqrt(distance2);
  const float near2 = std::max(distance2, e.radius * e.radius);
  if (near2 < 1e-30f) return 0;  // in a point lamp, which has no direction there
  float weight = e.importance / near2;
  if (cosine) weight *= mean_cosine(height, distance, e.radius);
  if (lamp && lamp->s.kind == LampKind::kArea) {
    const float before = -dot(lamp->forward, to_center);
    if (before <= 0) return 0;
    weight *= mean_cosine(before, distance, e.radius);
  } else if (lamp && lamp->s.kind == LampKind::kSpot && distance > e.radius) {
    weight *= std::max(kLeastShare, spot_attenuation(*lamp, to_center / -distance));
  }
  return weight;
}

bool Lights::see_close(const Emitter& e, const Receiver& to, CloseLight& out) const {
  if (e.exact) return false;  // its places are to be known to the last bit
  if (e.lamp < 0 && scene_.moves(e.instance)) return false;
  if (!is_close(e.center, e.radius, to.x)) return false;
  return e.lamp < 0 ? photon_splat::see_close(e.mesh, to, out)
                    : photon_splat::see_close(lamps_[e.lamp], to, out);
}

bool Lights::shares_with_rays(const Emitter& e, const Receiver& to) const {
  if (!e.met_by_rays || e.past_surface < 1) return false;
  if (to.sharp) return true;
  // The others are sampled by solid angle
  if (e.lamp >= 0 && lamps_[e.lamp].s.kind != LampKind::kArea) return false;
  if (!(length2(e.center - to.x) < 4 * e.radius * e.radius)) return false;
  if (!to.diffuse()) return true;
  CloseLight close;  // sampled by the cosine: there is nothing that rays do better
  return !(see_close(e, to, close) && close.by_cosine);
}

bool Lights::wants_bsdf_ray(const Receiver& to) const {
  if (!environment_.black()) return true;
  if (to.sharp) return !emitters_.empty();
  if (!tree_.empty()) return tree_.reached(to.x);
  for (const Emitter& e : emitters_)
    if (shares_with_rays(e, to)) return true;
  return false;
}

float Lights::emitters_weight(const Receiver& to) const {
  float sum = 0;
  if (emitters_.size() > kFewEmitters) {
    for (uint32_t sun : suns_) sum += emitter_weight(emitters_[sun], to);
    return sum + tree_.importance(to.x, to.horizon());
  }
  for (const Emitter& e : emitters_) sum += emitter_weight(e, to);
  return sum;
}

// The world is drawn from as far as that is better than leaving it to the rays that BSDFs draw.
float Lights::world_probability(const Receiver& to, float emitters) const {
  if (environment_.constant() || to.guide || !(scene_.world_seen_by & kScatteredRays)) return 0;
  const float worth = std::max(environment_.contrast(), world_shares() ? kLeastOfSharing : 0.0f);
  const float world = environment_.irradiance(to.n) * worth;
  return world > 0 ? world / (world + emitters) : 0;
}

float Lights::world_density(const Vec3& direction) const {
  if (environment_.constant()) return 0;
  return environment_.pdf(direction) * (emitters_.empty() ? 1.0f : kWorldBesideLights);
}

float Lights::ray_share_of_world(const Vec3& direction, float ray_pdf) const {
  return ray_pdf < INFINITY ? power_heuristic(ray_pdf, world_density(direction)) : 1;
}

float Lights::ray_share_of_lamp(uint32_t emitter, const Receiver& to, const Vec3& direction,
                                float ray_pdf) const {
  if (!(ray_pdf < INFINITY)) return 1;
  float pdf = 0;
  lamp_radiance_met(lamps_[emitters_[emitter].lamp], to.x, direction, 0, INFINITY, pdf);
  return pdf > 0 ? power_heuristic(ray_pdf, pdf * choice_probability(emitter, to)) : 0;
}

float Lights::unshadowed_share(uint32_t emitter, const Receiver& to, const Vec3& direction,
                               float ray_pdf) const {
  if (!(ray_pdf < INFINITY)) return 0;
  if (!shares_with_rays(emitters_[emitter], to)) return 1;
  return 1 - ray_share_of_lamp(emitter, to, direction, ray_pdf);
}

float Lights::choice_probability(uint32_t emitter, const Receiver& to) const {
  if (emitters_.size() > kFewEmitters) {
    const float all = emitters_weight(to);
    if (!(all > 0)) return 0;
    const float others = 1 - world_probability(to, all);
    if (tree_item_[emitter] < 0) return others * emitter_weight(emitters_[emitter], to) / all;
    return others * tree_.importance(to.x, to.horizon()) / all *
           tree_.probability(tree_item_[emitter], to.x, to.horizon());
  }
  float sum = 0, chosen = 0;
  for (uint32_t i = 0; i < emitters_.size(); ++i) {
    const float w = emitter_weight(emitters_[i], to);
    sum += w;
    if (i == emitter) chosen = w;
  }
  return sum > 0 ? chosen / sum * (1 - world_probability(to, sum)) : 0;
}

// weight: of all emitters.
std::optional<Lights::Pick> Lights::pick_of_many(const Receiver& to, float weight,
                                                 float choice) const {
  float target = choice * weight;
  const float near_by = tree_.importance(to.x, to.horizon());
  if (target < near_by) {
    const auto c = tree_.pick(to.x, to.horizon(), std::min(target / near_by, kBelowOne));
    if (!c) return std::nullopt;
    return Pick{tree_emitters_[c->item], c->probability * near_by / weight};
  }
  target -= near_by;
  std::optional<Pick> last;
  for (uint32_t sun : suns_) {
    const float w = emitter_weight(emitters_[sun], to);
    if (!(w > 0)) continue;
    last = Pick{sun, w / weight};
    if (target < w) break;
    target -= w;
  }
  return last;
}

// Where the guide is wrong the world's own density makes up for it.
float Lights::guided_pdf(const EnvironmentGuide::Cell& cell,
                         const Environment::Density& density) const {
  return kGuided * cell.pdf(environment_, density) + (1 - kGuided) * environment_.pdf(density);
}

std::optional<LightSample> Lights::sample_world(const Receiver& to, uint32_t i,
                                                const Vec2& all) const {
  if (environment_.black() || !to.guide) return std::nullopt;
  // Parts of the world are drawn by u.x: each sample takes its share of them, and the others of
  // what else there is to draw.
  const float count = static_cast<float>(to.world_samples), n = static_cast<float>(i);
  const Vec2 u{std::min((all.x + n) / count, kBelowOne), shifted(all.y, n * kGolden)};
  LightSample out{};
  const Environment::Sample s =
      u.x < kGuided ? to.guide->sample(environment_, {left_of(u.x, 0, kGuided), u.y})
                    : environment_.sample({left_of(u.x, kGuided, 1 - kGuided), u.y});
  out.direction = s.direction;
  out.distance = INFINITY;
  out.pdf = count * guided_pdf(*to.guide, s.density);
  if (!(out.pdf > 0)) return std::nullopt;
  out.weight = environment_.radiance(out.direction) / out.pdf;
  out.use_mis = true;
  out.light_group = scene_.world_light_group;
  out.seen_by = as_scattered(scene_.world_seen_by);
  out.from_world = true;
  if (is_black(out.weight)) return std::nullopt;
  return out;
}

std::optional<LightSample> Lights::sample(const Receiver& to, float choice, const Vec2& u) const {
  // In its place from the first: copies of what has just been written are slow
  std::optional<LightSample> out(std::in_place);
  if (!sample(to, choice, u, *out)) out.reset();
  return out;
}

bool Lights::sample(const Receiver& to, float choice, Vec2 u, LightSample& out) const {
  float weight[kFewEmitters], sum = 0;
  const bool few = emitters_.size() <= kFewEmitters;
  if (few)
    for (size_t i = 0; i < emitters_.size(); ++i)
      sum += weight[i] = emitter_weight(emitters_[i], to);
  else
    sum = emitters_weight(to);
  const float world = world_probability(to, sum);
  if (u.x < world) {
    const Environment::Sample s = environment_.sample({left_of(u.x, 0, world), u.y});
    if (!(s.pdf > 0)) return false;
    out.direction = s.direction;
    out.distance = INFINITY;
    out.pdf = s.pdf * world;
    out.weight = environment_.radiance(s.direction) / out.pdf;
    out.use_mis = true;
    out.light_group = scene_.world_light_group;
    out.seen_by = as_scattered(scene_.world_seen_by);
    out.from_world = true;
    return !is_black(out.weight);
  }
  if (!(sum > 0)) return false;
  u.x = left_of(u.x, world, 1 - world);
  size_t chosen = 0;
  float probability = 1 - world;
  if (few) {
    float target = u.x * sum;
    for (chosen = 0; chosen + 1 < emitters_.size() && target >= weight[chosen]; ++chosen)
      target -= weight[chosen];
    if (!(weight[chosen] > 0)) return false;
    u.x = left_of(target, 0, weight[chosen]);
    probability *= weight[chosen] / sum;
  } else {
    const auto pick = pick_of_many(to, sum, choice);
    if (!pick) return false;
    chosen = pick->emitter;
    if (!(emitters_[chosen].lit_groups & to.group)) return false;  // the tree does not know
    probability *= pick->probability;
  }
  const Emitter& e = emitters_[chosen];
  if (e.max_bounces < to.bounces) return false;
  if (to.catchers_only && e.lamp < 0 && !scene_.instances[e.instance].catcher) return false;
  bool by_cosine = false;
  if (!(e.lamp >= 0 ? sample_lamp(e, to, u, out, by_cosine)
                    : sample_mesh(e, to, u, out, by_cosine)))
    return false;
  out.weight *= 1 / probability;
  out.pdf *= probability;
  out.use_mis = out.pdf > 0 && !by_cosine && shares_with_rays(e, to);
  out.blockers = e.casts_shadows ? e.blockers : 0;
  out.light_group = e.light_group;
  out.seen_by = e.seen_by;
  out.weight *= e.past_surface;
  if (e.exact) out.exact = static_cast<int32_t>(chosen);
  return true;
}

bool Lights::sample_lamp(const Emitter& e, const Receiver& receiver, const Vec2& u,
                         LightSample& out, bool& by_cosine) const {
  const Lamp& lamp = lamps_[e.lamp];
  if (lamp.s.kind == LampKind::kSun) return sample_sun(scene_, lamp, u, out);
  if (lamp.s.kind != LampKind::kArea) return sample_point_lamp(scene_, lamp, receiver.x, u, out);
  if (CloseLight close; see_close(e, receiver, close)) {
    CloseLight::Place place;
    if (!close.sample(u, place) || dot(place.direction, lamp.forward) >= 0) return false;
    out.direction = place.direction;
    out.distance = place.distance;
    out.pdf = place.pdf;
    out.weight = lamp.radiance / place.pdf;
    by_cosine = close.by_cosine;
    if (lamp.s.program >= 0)
      out.weight *= lamp_program(scene_, lamp, receiver.x + out.direction * out.distance,
                                 -out.direction, out.distance);
    return !is_black(out.weight);
  }
  return sample_area_lamp(scene_, lamp, receiver.x, u, out);
}

bool Lights::sample_mesh(const Emitter& e, const Receiver& receiver, const Vec2& u,
                         LightSample& out, bool& by_cosine) const {
  if (CloseLight close; see_close(e, receiver, close)) {
    CloseLight::Place place;
    if (!close.sample(u, place)) return false;
    by_cosine = close.by_cosine;
    out.direction = place.direction;
    out.distance = place.distance;
    out.pdf = place.pdf;
    const Vec3 normal = scene_.instances[e.instance].mirrored ? -place.normal : place.normal;
    const bool back = dot(out.direction, normal) > 0;
    out.weight = emission_of(scene_, e.instance, e.mesh.triangles[place.triangle], place.u, place.v,
                             back, -out.direction, receiver.time,
                             static_cast<uint16_t>(receiver.bounces + 1), out.distance) /
                 place.pdf;
    out.normal = back ? -normal : normal;
    out.rounding = scene_.rounding_beyond(0, e.instance, e.mesh.triangles[place.triangle].triangle);
    return !is_black(out.weight);
  }
  return sample_mesh_light(scene_, e.mesh, e.instance, receiver, u, out);
}

float Lights::surface_mis_weight(const Receiver& receiver, const Surface& hit,
                                 float bsdf_pdf) const {
  if (!(scene_.instances[hit.instance].lit_groups & receiver.group)) return 0;
  const int32_t index = emitter_of_instance_[hit.instance];
  if (index < 0) return 1;
  return ~emitters_[index].blockers ? 0 : mesh_mis_weight(index, receiver, hit, bsdf_pdf);
}

float Lights::mesh_mis_weight(uint32_t index, const Receiver& receiver, const Surface& hit,
                              float bsdf_pdf) const {
  const Emitter& e = emitters_[index];
  // By light samples alone, and in mirrors
  if (e.past_surface < 1) return bsdf_pdf < INFINITY ? 0 : 1;
  if (!shares_with_rays(e, receiver)) return 0;
  if (!(bsdf_pdf < INFINITY)) return 1;
  if (CloseLight close; see_close(e, receiver, close))
    return e.mesh.share_of(hit.triangle) > 0
               ? power_heuristic(bsdf_pdf, choice_probability(index, receiver) / close.total)
               : 1;
  Vec3 corner[3];
  scene_.corners(hit.instance, hit.triangle, receiver.time, corner);
  const float area = 0.5f * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
  const Vec3 to = hit.position - receiver.x;
  const float cosine = std::abs(dot(normalize(to), hit.ng));
  const float pdf = choice_probability(index, receiver) * e.mesh.share_of(hit.triangle) / area *
                    length2(to) / std::max(cosine, 1e-7f);
  return power_heuristic(bsdf_pdf, pdf);
}

Rgb Lights::lamp_radiance_met(const Lamp& lamp, const Vec3& origin, const Vec3& direction,
                              float near, float far, float& pdf, float* met_at) const {
  switch (lamp.s.kind) {
    case LampKind::kArea:
      return area_lamp_met(scene_, lamp, origin, direction, near, far, pdf, met_at);
    case LampKind::kSun: return sun_met(scene_, lamp, direction, far, pdf, met_at);
    case LampKind::kPoint:
    case LampKind::kSpot: break;
  }
  return point_lamp_met(scene_, lamp, origin, direction, near, far, pdf, met_at);
}

Rgb Lights::world_met(const Receiver& to, const Vec3& direction, float bsdf_pdf) const {
  Rgb radiance = environment_.radiance(direction);
  if (scene_.world_seen_by != kAllRays) radiance *= to.seeing(scene_.world_seen_by, true);
  if (!(bsdf_pdf < INFINITY) || is_black(radiance)) return radiance;
  if (world_shares()) return radiance * ray_share_of_world(direction, to.ray_pdf);
  if (to.guide)
    return radiance *
           power_heuristic(bsdf_pdf, static_cast<float>(to.world_samples) *
                                         guided_pdf(*to.guide, environment_.density(direction)));
  if (environment_.constant()) return radiance;
  return radiance * power_heuristic(bsdf_pdf, world_probability(to, emitters_weight(to)) *
                                                  environment_.pdf(direction));
}

Rgb Lights::lamp_met(uint32_t emitter, const Receiver& to, const Vec3& direction, float near,
                     float far, float bsdf_pdf, float* distance) const {
  const Emitter& e = emitters_[emitter];
  if (e.lamp < 0 || !(e.lit_groups & to.group) || e.max_bounces < to.bounces ||
      !shares_with_rays(e, to))
    return {};
  float pdf, at = 0;
  Rgb radiance =
      lamp_radiance_met(lamps_[e.lamp], to.x, direction, near, e.exact ? reach_of_exact(far) : far,
                        pdf, e.exact ? &at : distance);
  if (e.seen_by != kAllRays) radiance *= to.seeing(e.seen_by, false);
  if (e.exact) {
    if (distance) *distance = at;
    const float epsilon = ray_epsilon(to.x, 0), cosine = dot(to.n, direction);
    const Vec3 off = cosine != 0 ? to.n * std::copysign(epsilon, cosine) : direction * epsilon;
    if (is_black(radiance) || blocked_exactly(emitter, to.x + off, to.x + direction * at, to.time))
      return {};
  }
  if (CloseLight close; pdf > 0 && bsdf_pdf < INFINITY && see_close(e, to, close))
    pdf = 1 / close.total;
  if (!(pdf > 0) || !(bsdf_pdf < INFINITY)) return pdf > 0 ? radiance : Rgb{};
  return radiance * power_heuristic(bsdf_pdf, pdf * choice_probability(emitter, to));
}

Rgb Lights::lamps_met(const Receiver& to, const Vec3& direction, float near, float far,
                      float bsdf_pdf, GroupLight* groups, const Attenuation* attenuation) const {
  Rgb sum{};
  const auto add = [&](uint32_t emitter) {
    if (~emitters_[emitter].blockers) return;
    float distance = INFINITY;
    Rgb light =
        lamp_met(emitter, to, direction, near, far, bsdf_pdf, attenuation ? &distance : nullptr);
    if (attenuation && !is_black(light)) light *= (*attenuation)(distance);
    sum += light;
    if (groups) groups->add(light, emitters_[emitter].light_group);
  };
  if (emitters_.size() > kFewEmitters) {
    tree_.along(to.x, direction, reach_of_exact(far),
                [&](uint32_t item) { add(tree_emitters_[item]); });
    for (uint32_t sun : suns_) add(sun);
  } else {
    for (uint32_t met = near_lamps_.met_by(to.x, direction); met; met &= met - 1)
      add(static_cast<uint32_t>(std::countr_zero(met)));
  }
  return sum;
}

Rgb Lights::lamps_seen(const Vec3& origin, const Vec3& direction, float near, float far, float time,
                       GroupLight* groups, const Attenuation* attenuation) const {
  Rgb sum{};
  const auto add = [&](uint32_t emitter) {
    const Emitter& e = emitters_[emitter];
    const Lamp& lamp = lamps_[e.lamp];
    const bool inside = lamp.s.kind != LampKind::kSun &&
                        length2(lamp.center - origin) < lamp.s.radius * lamp.s.radius;
    float pdf, at = 0;
    if (!lamp.s.camera_visible || inside) return;
    Rgb light = lamp_radiance_met(lamp, origin, direction, near,
                                  e.exact ? reach_of_exact(far) : far, pdf, &at);
    if (e.exact &&
        (is_black(light) || blocked_exactly(emitter, origin, origin + direction * at, time)))
      return;
    if (attenuation && !is_black(light)) light *= (*attenuation)(at);
    sum += light;
    if (groups) groups->add(light, emitters_[emitter].light_group);
  };
  if (visible_lamps_.size() > kFewEmitters) {
    tree_.along(origin, direction, reach_of_exact(far), [&](uint32_t item) {
      if (emitters_[tree_emitters_[item]].lamp >= 0) add(tree_emitters_[item]);
    });
    for (uint32_t sun : suns_) add(sun);
  } else {
    for (uint32_t emitter : visible_lamps_) add(emitter);
  }
  return sum;
}

}  // namespace photon_splat
