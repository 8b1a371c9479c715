#include "lights/lights.h"

#include <stdexcept>

namespace photon_splat {
namespace {

constexpr float kGolden = 0.61803399f;
constexpr float kGuided = 0.85f;     // of the world's samples, where there is a guide
constexpr size_t kFewEmitters = 32;  // up to here every emitter is ranked at every point

float smoothstep(float t) {
  t = std::clamp(t, 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// On the circle of circumference 1.
float shifted(float u, float by) { return std::min(u + by - std::floor(u + by), kBelowOne); }

float power_heuristic(float a, float b) {
  if (!(a < 1e18f)) return 1;  // a delta
  return a * a / (a * a + b * b);
}

}  // namespace

Lights::Lights(Scene& scene, const std::vector<LampSettings>& lamps)
    : scene_(scene), environment_(scene), discs_(scene.center(), scene.radius() * 1.0001f) {
  for (const LampSettings& lamp : lamps) {
    add_lamp(lamp);
    if (!lamps_.empty() && lamps_.back().number == Lamp::kUnnumbered)
      lamps_.back().number = static_cast<uint32_t>(&lamp - lamps.data());
  }
  add_emissive_instances();
  find_lamps_in_surfaces();
  share_power();
  if (emitters_.size() > kFewEmitters) build_tree();
  for (uint32_t i = 0; i < emitters_.size(); ++i)
    if (emitters_[i].lamp >= 0 && lamps_[emitters_[i].lamp].s.camera_visible)
      visible_lamps_.push_back(i);
  for (uint32_t i = 0; i < emitters_.size(); ++i)
    if (~emitters_[i].blockers) shadow_linked_.push_back(i);
}

// All directions of the world times the discs that its light comes through.
void Lights::share_power() {
  for (Emitter& e : emitters_)
    if (e.parallel_flux > 0) e.power = e.parallel_flux * discs_.least_area();
  world_power_ = scene_.world_seen_by & kScatteredRays
                     ? average(environment_.mean()) * 4.0 * kPi * discs_.least_area()
                     : 0;
  power_cdf_.clear();
  double sum = 0;
  for (const Emitter& e : emitters_) power_cdf_.push_back(sum += e.power);
  power_cdf_.push_back(total_power_ = sum + world_power_);
  const auto over_share = [&](double power) {
    return static_cast<float>(total_power_ / std::max(power, 1e-300));
  };
  for (Emitter& e : emitters_) e.over_share = over_share(e.power);
  over_world_share_ = over_share(world_power_);
}

void Lights::focus(const Vec3& center, float radius) {
  discs_.focus(center, radius);
  share_power();
}

void Lights::build_tree() {
  std::vector<LightTree::Item> items;
  tree_item_.assign(emitters_.size(), -1);
  for (uint32_t i = 0; i < emitters_.size(); ++i) {
    const Emitter& e = emitters_[i];
    const Lamp* lamp = e.lamp >= 0 ? &lamps_[e.lamp] : nullptr;
    if (lamp && lamp->s.kind == LampKind::kSun) {
      suns_.push_back(i);
      continue;
    }
    LightTree::Item item;
    item.bounds = e.bounds;
    item.energy = e.importance;
    if (lamp && lamp->s.kind != LampKind::kPoint) {
      item.axis = lamp->forward;
      item.spread = 0;
      if (lamp->s.kind == LampKind::kArea) {
        item.emission = lamp->normalize_spread > 0 ? std::atan(lamp->tan_half_spread) : 0.5f * kPi;
      } else {  // a cone, widened by the scale
        const float half = std::acos(std::clamp(lamp->cos_half, 0.0f, 1.0f));
        item.emission = std::atan2(std::sin(half) * std::max(lamp->scale_x, lamp->scale_y),
                                   std::cos(half) * lamp->scale_z);
      }
      item.emission += 1e-3f;
    }
    if (!lamp || lamp->s.kind == LampKind::kArea) {
      const float r = 2 * e.radius;
      item.reach.add(e.center - Vec3{r, r, r});
      item.reach.add(e.center + Vec3{r, r, r});
    }
    tree_item_[i] = static_cast<int32_t>(items.size());
    tree_emitters_.push_back(i);
    items.push_back(item);
  }
  tree_.build(items);
}

float Lights::spot_attenuation(const Lamp& lamp, const Vec3& from_lamp) const {
  const Vec3 local{dot(from_lamp, lamp.axis_x) / lamp.scale_x,
                   dot(from_lamp, lamp.axis_y) / lamp.scale_y,
                   dot(from_lamp, lamp.forward) / lamp.scale_z};
  return smoothstep((local.z / length(local) - lamp.cos_half) * lamp.inverse_smooth);
}

float Lights::spread_attenuation(const Lamp& lamp, float tangent) const {
  if (lamp.normalize_spread == 0) return 1;
  return std::max(0.0f, (lamp.tan_half_spread - tangent) * lamp.normalize_spread);
}

bool Lights::inside_shape(const Lamp& lamp, const Vec3& from_center) const {
  const float px = dot(from_center, lamp.axis_x) / lamp.half_x,
              py = dot(from_center, lamp.axis_y) / lamp.half_y;
  return lamp.s.ellipse ? px * px + py * py <= 1 : std::abs(px) <= 1 && std::abs(py) <= 1;
}

float Lights::sampled_area(const Lamp& lamp, const Vec3& x) const {
  if (lamp.normalize_spread == 0) return lamp.area;
  const float beam = dot(lamp.center - x, lamp.forward) * lamp.tan_half_spread;
  return std::min(lamp.area, std::max(kPi * beam * beam, 1e-30f));
}

float Lights::emitter_weight(const Emitter& e, const Receiver& to) const {
  if (!(e.lit_groups & to.group)) return 0;
  if (e.lamp >= 0 && lamps_[e.lamp].s.kind == LampKind::kSun) {
    const Lamp& lamp = lamps_[e.lamp];
    return dot(to.n, -lamp.forward) + std::sqrt(2 * lamp.one_minus_cos) < 0 ? 0 : e.importance;
  }
  const Vec3 to_center = e.center - to.x;
  if (dot(to.n, to_center) < -e.radius) return 0;  // wholly below the horizon
  if (e.lamp >= 0 && lamps_[e.lamp].s.kind == LampKind::kArea &&
      dot(lamps_[e.lamp].forward, to_center) >= 0)
    return 0;
  return e.importance / std::max({length2(to_center), e.radius * e.radius, 1e-30f});
}

bool Lights::shares_with_rays(const Emitter& e, const Receiver& to) const {
  if (!e.met_by_rays) return false;
  if (to.sharp) return true;
  // The others are sampled by solid angle
  if (e.lamp >= 0 && lamps_[e.lamp].s.kind != LampKind::kArea) return false;
  if (!(length2(e.center - to.x) < 4 * e.radius * e.radius)) return false;
  if (!to.diffuse()) return true;
  CloseLamp close;  // sampled by the cosine: there is nothing that rays do better
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
    return sum + tree_.importance(to.x, to.n);
  }
  for (const Emitter& e : emitters_) sum += emitter_weight(e, to);
  return sum;
}

// The world is drawn from as far as that is better than leaving it to the rays that BSDFs draw.
float Lights::world_probability(const Receiver& to, float emitters) const {
  if (environment_.constant() || to.guide || !(scene_.world_seen_by & kScatteredRays)) return 0;
  const float world = environment_.irradiance(to.n) * environment_.contrast();
  return world > 0 ? world / (world + emitters) : 0;
}

float Lights::choice_probability(uint32_t emitter, const Receiver& to) const {
  if (emitters_.size() > kFewEmitters) {
    const float all = emitters_weight(to);
    if (!(all > 0)) return 0;
    const float others = 1 - world_probability(to, all);
    if (tree_item_[emitter] < 0) return others * emitter_weight(emitters_[emitter], to) / all;
    return others * tree_.importance(to.x, to.n) / all *
           tree_.probability(tree_item_[emitter], to.x, to.n);
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
  const float near_by = tree_.importance(to.x, to.n);
  if (target < near_by) {
    const auto c = tree_.pick(to.x, to.n, std::min(target / near_by, kBelowOne));
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

std::optional<LightSample> Lights::sample_world(const Receiver& to, uint32_t i, float choice,
                                                const Vec2& all) const {
  if (environment_.black() || !to.guide) return std::nullopt;
  // Parts of the world are drawn by u.x: each sample takes its share of them, and the others of
  // what else there is to draw.
  const float count = static_cast<float>(to.world_samples), n = static_cast<float>(i);
  const Vec2 u{std::min((all.x + n) / count, kBelowOne), shifted(all.y, n * kGolden)};
  choice = shifted(choice, n / count);
  LightSample out{};
  const Environment::Sample s =
      choice < kGuided ? to.guide->sample(environment_, u) : environment_.sample(u);
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

bool Lights::sample(const Receiver& to, float choice, const Vec2& u, LightSample& out) const {
  float weight[kFewEmitters], sum = 0;
  const bool few = emitters_.size() <= kFewEmitters;
  if (few)
    for (size_t i = 0; i < emitters_.size(); ++i)
      sum += weight[i] = emitter_weight(emitters_[i], to);
  else
    sum = emitters_weight(to);
  const float world = world_probability(to, sum);
  if (choice < world) {
    const Environment::Sample s = environment_.sample(u);
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
  choice = std::min((choice - world) / (1 - world), kBelowOne);
  size_t chosen = 0;
  float probability = 1 - world;
  if (few) {
    float target = choice * sum;
    for (chosen = 0; chosen + 1 < emitters_.size() && target >= weight[chosen]; ++chosen)
      target -= weight[chosen];
    if (!(weight[chosen] > 0)) return false;
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
  if (e.exact) out.exact = static_cast<int32_t>(chosen);
  return true;
}

bool Lights::sample_lamp(const Emitter& e, const Receiver& receiver, const Vec2& u,
                         LightSample& out, bool& by_cosine) const {
  const Lamp& lamp = lamps_[e.lamp];
  const Vec3& x = receiver.x;
  if (lamp.s.kind == LampKind::kSun) {
    out.direction = Basis(-lamp.forward).to_world(sample_cone(u, lamp.one_minus_cos));
    out.distance = INFINITY;
    out.pdf = lamp.one_minus_cos > 0 ? 1 / (2 * kPi * lamp.one_minus_cos) : 0;
    // Radiance over the cone's pdf is its flux per area; the cosine belongs to the receiver.
    out.weight =
        lamp.one_minus_cos > 0 ? lamp.radiance * (2 * kPi * lamp.one_minus_cos) : lamp.intensity;
    if (lamp.s.program >= 0) out.weight *= shade(lamp, {}, -out.direction, INFINITY);
    return !is_black(out.weight);
  }
  if (CloseLamp close; lamp.s.kind == LampKind::kArea && see_close(e, receiver, close)) {
    CloseLamp::Place place;
    if (!close.sample(u, place) || dot(place.direction, lamp.forward) >= 0) return false;
    out.direction = place.direction;
    out.distance = place.distance;
    out.pdf = place.pdf;
    out.weight = lamp.radiance / place.pdf;
    by_cosine = close.by_cosine;
    if (lamp.s.program >= 0)
      out.weight *= shade(lamp, x + out.direction * out.distance, -out.direction, out.distance);
    return !is_black(out.weight);
  }
  if (lamp.s.kind == LampKind::kArea) {
    Vec3 point;
    const float area = sampled_area(lamp, x);
    if (area < lamp.area) {  // only what lies in the beam that reaches x
      const Vec2 p = sample_disk(u);
      const float radius = std::sqrt(area / kPi);
      point = x + lamp.forward * dot(lamp.center - x, lamp.forward) + lamp.axis_x * (p.x * radius) +
              lamp.axis_y * (p.y * radius);
      if (!inside_shape(lamp, point - lamp.center)) return false;
    } else {
      Vec2 p{2 * u.x - 1, 2 * u.y - 1};
      if (lamp.s.ellipse) p = sample_disk(u);
      point = lamp.center + lamp.axis_x * (p.x * lamp.half_x) + lamp.axis_y * (p.y * lamp.half_y);
    }
    out.place = point;
    const Vec3 to = point - x;
    const float d2 = length2(to);
    if (!(d2 > 0)) return false;
    out.distance = std::sqrt(d2);
    out.direction = to / out.distance;
    const float cosine = -dot(out.direction, lamp.forward);
    if (cosine <= 0) return false;
    out.pdf = d2 / (cosine * area);
    const float along = dot(to, lamp.forward);
    out.weight = lamp.radiance *
                 (spread_attenuation(lamp, length(to - lamp.forward * along) / -along) / out.pdf);
    if (lamp.s.program >= 0) out.weight *= shade(lamp, point, -out.direction, out.distance);
    return !is_black(out.weight);
  }
  const Vec3 to = lamp.center - x;
  const float d2 = length2(to);
  if (!(d2 > 0)) return false;
  const float d = std::sqrt(d2), r = lamp.s.radius;
  if (r <= 0) {
    out.direction = to / d;
    out.distance = d;
    out.weight = lamp.intensity / d2;
  } else if (lamp.s.soft_falloff) {  // the disc that faces x fills a cone exactly
    const float one_minus_cos = (r * r / (d2 + r * r)) / (1 + d / std::sqrt(d2 + r * r));
    const Vec3 local = sample_cone(u, one_minus_cos);
    out.direction = Basis(to / d).to_world(local);
    out.distance = d / local.z;
    out.pdf = 1 / (2 * kPi * one_minus_cos);
    out.weight = lamp.radiance / out.pdf;
  } else if (d > r) {
    const float sin2 = r * r / d2;
    const float one_minus_cos = sin2 / (1 + std::sqrt(1 - sin2));
    const Vec3 local = sample_cone(u, one_minus_cos);
    out.direction = Basis(to / d).to_world(local);
    const float miss2 = d2 * (local.x * local.x + local.y * local.y);
    out.distance = d * local.z - std::sqrt(std::max(0.0f, r * r - miss2));
    out.pdf = 1 / (2 * kPi * one_minus_cos);
    out.weight = lamp.radiance / out.pdf;
  } else {  // inside a spherical lamp, which shines inwards too, and there without a spot's cone
    out.direction = sample_sphere(u);
    const float along = dot(to, out.direction);
    out.distance = along + std::sqrt(std::max(0.0f, along * along - d2 + r * r));
    out.pdf = 1 / (4 * kPi);
    out.weight = lamp.radiance / out.pdf;
    if (lamp.s.program >= 0)
      out.weight *= shade(lamp, x + out.direction * out.distance, -out.direction, out.distance);
    return !is_black(out.weight);
  }
  if (lamp.s.kind == LampKind::kSpot) out.weight *= spot_attenuation(lamp, -out.direction);
  if (lamp.s.program >= 0)
    out.weight *= shade(lamp, x + out.direction * out.distance, -out.direction, out.distance);
  return !is_black(out.weight);
}

void Lights::triangle_corners(uint32_t instance, uint32_t triangle, Vec3 corner[3]) const {
  const Instance& placed = scene_.instances[instance];
  const Mesh& mesh = scene_.meshes[placed.mesh];
  for (int i = 0; i < 3; ++i)
    corner[i] = placed.to_world.point(mesh.positions[mesh.triangles[triangle][i]]);
}

bool Lights::sample_mesh(const Emitter& e, const Receiver& receiver, const Vec2& u,
                         LightSample& out, bool& by_cosine) const {
  const Vec3& x = receiver.x;
  const auto emitted = [&](size_t triangle, float b1, float b2, bool back) {
    return emission_of(e, e.triangles[triangle], b1, b2, back, -out.direction);
  };
  if (CloseLamp close; see_close(e, receiver, close)) {
    CloseLamp::Place place;
    if (!close.sample(u, place)) return false;
    by_cosine = close.by_cosine;
    out.direction = place.direction;
    out.distance = place.distance;
    out.pdf = place.pdf;
    const Vec3 normal = scene_.instances[e.instance].mirrored ? -place.normal : place.normal;
    const bool back = dot(out.direction, normal) > 0;
    out.weight = emitted(place.triangle, place.u, place.v, back) / place.pdf;
    out.normal = back ? -normal : normal;
    return !is_black(out.weight);
  }
  // The triangle is picked by the integer part of a stretched sample; the rest is used again.
  const float target = u.x * e.cdf.back();
  const size_t pick = e.triangle_at(target);
  const float low = pick ? e.cdf[pick - 1] : 0;
  const float share = e.cdf[pick] - low;
  if (!(share > 0)) return false;
  const float again = std::clamp((target - low) / share, 0.0f, 1.0f);
  const EmissiveTriangle& t = e.triangles[pick];
  const float root = std::sqrt(again), b1 = root * (1 - u.y), b2 = root * u.y;
  const Vec3 point = t.corner[0] * (1 - root) + t.corner[1] * b1 + t.corner[2] * b2;

  const Vec3 to = point - x;
  const float d2 = length2(to);
  if (!(d2 > 0)) return false;
  out.distance = std::sqrt(d2);
  out.direction = to / out.distance;
  const float facing = dot(out.direction, t.normal), cosine = std::abs(facing);
  if (cosine <= 1e-7f) return false;
  out.pdf = t.pdf * d2 / cosine;
  const bool back = facing > 0;
  out.weight = emitted(pick, b1, b2, back) / out.pdf;
  out.normal = back ? -t.normal : t.normal;
  return !is_black(out.weight);
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
  if (!shares_with_rays(e, receiver)) return 0;
  if (!(bsdf_pdf < INFINITY)) return 1;
  if (CloseLamp close; see_close(e, receiver, close))
    return e.share_of(hit.triangle) > 0
               ? power_heuristic(bsdf_pdf, choice_probability(index, receiver) / close.total)
               : 1;
  Vec3 corner[3];
  triangle_corners(hit.instance, hit.triangle, corner);
  const float area = 0.5f * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
  const Vec3 to = hit.position - receiver.x;
  const float cosine = std::abs(dot(normalize(to), hit.ng));
  const float pdf = choice_probability(index, receiver) * e.share_of(hit.triangle) / area *
                    length2(to) / std::max(cosine, 1e-7f);
  return power_heuristic(bsdf_pdf, pdf);
}

Rgb Lights::lamp_radiance_met(const Lamp& lamp, const Vec3& origin, const Vec3& direction,
                              float near, float far, float& pdf, float* met_at) const {
  pdf = 0;
  const auto shaded = [&](float distance) {
    if (met_at) *met_at = distance;
    if (lamp.s.program < 0) return Rgb{1, 1, 1};
    return shade(lamp, std::isfinite(distance) ? origin + direction * distance : Vec3{}, -direction,
                 distance);
  };
  if (lamp.s.kind == LampKind::kArea) {
    const float cosine = -dot(direction, lamp.forward);
    if (cosine <= 0) return {};
    const Vec3 to = lamp.center - origin;
    const float t = -dot(to, lamp.forward) / cosine;
    if (!(t > near) || t > far) return {};
    if (!inside_shape(lamp, direction * t - to)) return {};
    pdf = t * t / (cosine * sampled_area(lamp, origin));
    return lamp.radiance *
           spread_attenuation(lamp, length(cross(direction, lamp.forward)) / cosine) * shaded(t);
  }
  if (lamp.s.kind == LampKind::kSun) {
    if (std::isfinite(far) || lamp.one_minus_cos <= 0 ||
        length2(direction + lamp.forward) > 2 * lamp.one_minus_cos)
      return {};
    pdf = 1 / (2 * kPi * lamp.one_minus_cos);
    return lamp.radiance * shaded(INFINITY);
  }
  const Vec3 to = lamp.center - origin;
  const float along = dot(to, direction), d2 = length2(to), r2 = lamp.s.radius * lamp.s.radius;
  // d2 - along^2 loses the digits of small lamps
  const float miss2 = length2(to - direction * along);
  if (r2 <= 0 || miss2 > r2) return {};
  float one_minus_cos, distance;
  if (lamp.s.soft_falloff) {
    if (along <= near || along > far || miss2 * (d2 + r2) > r2 * d2) return {};
    one_minus_cos = (r2 / (d2 + r2)) / (1 + std::sqrt(d2 / (d2 + r2)));
    distance = d2 / along;
  } else if (d2 > r2) {
    const float entry = along - std::sqrt(r2 - miss2);
    if (entry <= near || entry > far) return {};
    distance = entry;
    const float sin2 = r2 / d2;
    one_minus_cos = sin2 / (1 + std::sqrt(1 - sin2));
  } else {  // from inside
    const float exit = along + std::sqrt(r2 - miss2);
    if (exit <= near || exit > far) return {};
    pdf = 1 / (4 * kPi);
    return lamp.radiance * shaded(exit);
  }
  pdf = 1 / (2 * kPi * one_minus_cos);
  const Rgb radiance = lamp.radiance * shaded(distance);
  return lamp.s.kind == LampKind::kSpot ? radiance * spot_attenuation(lamp, -direction) : radiance;
}

Rgb Lights::world_met(const Receiver& to, const Vec3& direction, float bsdf_pdf) const {
  if (!(scene_.world_seen_by & to.ray)) return {};
  const Rgb radiance = environment_.radiance(direction);
  if (!(bsdf_pdf < INFINITY) || is_black(radiance)) return radiance;
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
  if (e.lamp < 0 || !(e.lit_groups & to.group) || !(e.seen_by & to.ray) ||
      e.max_bounces < to.bounces || !shares_with_rays(e, to))
    return {};
  float pdf, at = 0;
  const Rgb radiance =
      lamp_radiance_met(lamps_[e.lamp], to.x, direction, near, e.exact ? reach_of_exact(far) : far,
                        pdf, e.exact ? &at : distance);
  if (e.exact) {
    if (distance) *distance = at;
    const float epsilon = ray_epsilon(to.x, 0), cosine = dot(to.n, direction);
    const Vec3 off = cosine != 0 ? to.n * std::copysign(epsilon, cosine) : direction * epsilon;
    if (is_black(radiance) || blocked_exactly(emitter, to.x + off, to.x + direction * at))
      return {};
  }
  if (CloseLamp close; pdf > 0 && bsdf_pdf < INFINITY && see_close(e, to, close))
    pdf = 1 / close.total;
  if (!(pdf > 0) || !(bsdf_pdf < INFINITY)) return pdf > 0 ? radiance : Rgb{};
  return radiance * power_heuristic(bsdf_pdf, pdf * choice_probability(emitter, to));
}

Rgb Lights::lamps_met(const Receiver& to, const Vec3& direction, float near, float far,
                      float bsdf_pdf, GroupLight* groups) const {
  Rgb sum{};
  const auto add = [&](uint32_t emitter) {
    if (~emitters_[emitter].blockers) return;
    const Rgb light = lamp_met(emitter, to, direction, near, far, bsdf_pdf);
    sum += light;
    if (groups) groups->add(light, emitters_[emitter].light_group);
  };
  if (emitters_.size() > kFewEmitters) {
    tree_.along(to.x, direction, reach_of_exact(far),
                [&](uint32_t item) { add(tree_emitters_[item]); });
    for (uint32_t sun : suns_) add(sun);
  } else {
    for (uint32_t i = 0; i < emitters_.size(); ++i) add(i);
  }
  return sum;
}

Rgb Lights::lamps_seen(const Vec3& origin, const Vec3& direction, float near, float far,
                       GroupLight* groups) const {
  Rgb sum{};
  const auto add = [&](uint32_t emitter) {
    const Emitter& e = emitters_[emitter];
    const Lamp& lamp = lamps_[e.lamp];
    const bool inside = lamp.s.kind != LampKind::kSun &&
                        length2(lamp.center - origin) < lamp.s.radius * lamp.s.radius;
    float pdf, at = 0;
    if (!lamp.s.camera_visible || inside) return;
    const Rgb light = lamp_radiance_met(lamp, origin, direction, near,
                                        e.exact ? reach_of_exact(far) : far, pdf, &at);
    if (e.exact && (is_black(light) || blocked_exactly(emitter, origin, origin + direction * at)))
      return;
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
