// Photons aimed at spheres: the mixture of natural emission with emission into what each target
// fills of a light's view.
//
// A photon is a line. Given its emitter, natural emission draws it with some density p, and so
// would each of the emitter's targets, with density p_t; the mixture's is P p + sum of P_t p_t, P
// being the probabilities of emitter and way. Lights come in three sorts by what is common to all
// the ways, and so cancels:
//   kPoint     area lamps and meshes: the origin. The targets draw another direction.
//   kLines     point and spot lamps, of lines that pass the centre within a radius: if that is 0,
//   or smaller than the target,
//              the place on the disc across the line. Else the targets draw both.
//   kParallel  suns and the world: the direction. The targets draw another place on the disc across
//   it. Densities are relative to a
//              uniform one on the disc that shows all of the scene.
#include "lights/emission/photon_emitter.h"
#include "math/random_streams.h"
#include "math/table.h"

namespace photon_splat {

struct PhotonEmitter::Draft {
  enum Sort : uint8_t { kPoint, kLines, kParallel };
  // Its power is what is emitted over the density of natural emission, for this emitter alone
  PhotonStart start;
  Sort sort = kPoint;
  bool inside = false;  // of a spherical lamp that holds geometry
  float natural = 0;    // density of natural emission over directions, 1/sr
  Rgb flux{};           // parallel: the power over the area that a photon stands for
  Vec3 center, offset;  // of the disc across the line, and where the line crosses it
  float radius = 0;

  void cross_disc(const Vec3& c, float r) {
    const Vec3 from = start.origin - c;
    center = c;
    radius = r;
    offset = from - start.direction * dot(from, start.direction);
  }
};

namespace {

// Share of a target's flux below which a pair is left to natural emission
constexpr double kLeastFlux = 1e-7;
constexpr int kMostNearSpheres = 12;
// Rounding must not put a line outside the target that it was aimed at
constexpr float kSlack = 1 + 1e-4f;

// 1 - cos of the half angle of a sphere of squared radius r2, seen from a squared distance d2 > r2.
float cone_of(float r2, float d2) {
  const float sin2 = r2 / d2;
  return sin2 / (1 + std::sqrt(1 - sin2));
}

// 1/(solid angle) for a direction within the cone around the unit `axis`, or 0.
float cone_density(const Vec3& axis, float one_minus_cos, const Vec3& direction, bool own) {
  if (!own && length2(direction - axis) > 2 * one_minus_cos * kSlack) return 0;
  return 1 / (2 * kPi * one_minus_cos);
}

float near_sphere(const Scene& scene, int k) {
  return scene.near_radius() * static_cast<float>(1 << 2 * k) * 1.0001f;
}

// How many a light at that distance from the origin has.
int near_spheres(const Scene& scene, float distance) {
  if (!scene.has_far_things()) return 0;
  int count = 0;
  while (count < kMostNearSpheres && near_sphere(scene, count) * 2 < distance) ++count;
  return count;
}

float guide_number(uint64_t index, uint32_t seed) {
  SobolPair::Run numbers;
  photon_numbers(PhotonDimension::kGuide, hash_combine(seed, static_cast<uint32_t>(index >> 32)))
      .fill(static_cast<uint32_t>(index), 1, numbers);
  return numbers.x[0];
}

}  // namespace

double near_share(const Scene& scene, const Vec3& x) {
  const float d2 = length2(x), r = near_sphere(scene, 0);
  const int spheres = near_spheres(scene, std::sqrt(d2));
  return spheres ? std::min(1.0, (1.0 + spheres) * r * r / d2) : 1.0;
}

// Power and natural density of the draft's direction.
void PhotonEmitter::weigh_lamp(const Lamp& lamp, Draft& draft) const {
  PhotonStart& start = draft.start;
  switch (lamp.s.kind) {
    case LampKind::kSun: return;  // weigh_parallel()
    case LampKind::kArea: {
      const float cosine = dot(start.direction, lamp.forward);
      start.power = {};
      draft.natural = 0;
      if (!(cosine > 0)) return;
      const float sin2 = length2(cross(start.direction, lamp.forward));
      const float pdf =
          lamp.angle_cdf.empty() ? 1 : table_pdf(lamp.angle_cdf, 0, lamp.angle_high, sin2);
      if (!(pdf > 0)) return;
      draft.natural = pdf * cosine / kPi;
      start.power = lamp.radiance *
                    (lamp.area * kPi * spread_attenuation(lamp, std::sqrt(sin2) / cosine) / pdf);
      return;
    }
    case LampKind::kPoint:
    case LampKind::kSpot: break;
  }
  draft.natural = 1 / (4 * kPi);
  start.power = lamp.intensity * (4 * kPi);
  if (lamp.s.kind == LampKind::kSpot && !draft.inside) {
    const Vec3 local{dot(start.direction, lamp.axis_x) / lamp.scale_x,
                     dot(start.direction, lamp.axis_y) / lamp.scale_y,
                     dot(start.direction, lamp.forward) / lamp.scale_z};
    const float len = length(local), volume = lamp.scale_x * lamp.scale_y * lamp.scale_z;
    // The world's solid angle over the unscaled one; its inverse was applied to unit vectors, so
    // that len is 1 / |scaled|.
    const float jacobian = volume * len * len * len;
    const float pdf = table_pdf(lamp.angle_cdf, lamp.angle_low, 1, std::min(local.z / len, 1.0f)) /
                      (2 * kPi * jacobian);
    draft.natural = pdf;
    start.power =
        pdf > 0 ? lamp.intensity * (spot_attenuation(lamp, start.direction) / pdf) : Rgb{};
  }
  if (lamp.holds_geometry) start.power *= 2;
}

void PhotonEmitter::weigh_mesh(const Emitter& e, const MeshPoint& p, Draft& draft) const {
  PhotonStart& start = draft.start;
  const EmissiveTriangle& t = *p.triangle;
  const float cosine = dot(start.direction, t.normal);
  const bool on_back = cosine < 0;
  const float side_share = on_back ? 1 - t.front_share : t.front_share;
  draft.natural = side_share * std::abs(cosine) / kPi;
  start.power = {};
  if (!(draft.natural > 0)) return;
  start.origin = p.position +
                 (on_back ? -t.normal : t.normal) * start_offset(scene_, e.instance, t, p.position);
  start.power = emission_of(scene_, e.instance, t, p.u, p.v, on_back, start.direction, start.time) *
                (kPi / (t.pdf * side_share));
}

// Makes a draft of natural emission cross the whole scene.
void PhotonEmitter::cross_scene(Draft& draft) const {
  draft.sort = Draft::kParallel;
  draft.cross_disc(discs_.center(), discs_.radius());
  const float area = discs_.area(draft.start.direction, draft.center + draft.offset);
  draft.natural = static_cast<float>(discs_.scene_area() / area);
  draft.flux = draft.start.power / area;
}

// Power and natural density of a parallel draft that has been sent elsewhere.
void PhotonEmitter::weigh_parallel(Draft& draft) const {
  const float area = discs_.area(draft.start.direction, draft.center + draft.offset);
  draft.natural = area > 0 ? static_cast<float>(discs_.scene_area() / area) : 0;
  draft.start.power = draft.flux * area;
}

PhotonEmitter::Draft PhotonEmitter::natural_draft(const EmissionPrimary& primary) const {
  const auto& [index, pick, place, way, weight, time, cell] = primary;
  Draft draft;
  if (index == emitters_.size()) {
    draft.start = emit_world(place, way, time);
    cross_scene(draft);
    return draft;
  }
  const Emitter& e = emitters_[index];
  if (e.lamp < 0) {
    draft.start = emit_mesh_light(scene_, e.mesh, e.instance, pick.y, place, way, time);
    draft.start.time = time;
    EmissiveTriangle moved;
    weigh_mesh(e, e.mesh.point_at(scene_, e.instance, pick.y, place, time, moved), draft);
    return draft;
  }
  const Lamp& lamp = lamps_[e.lamp];
  draft.start = emit_lamp(lamp, pick.y, place, way, time);
  draft.inside = lamp.holds_geometry && pick.y < 0.5f;
  if (lamp.s.kind == LampKind::kSun) {
    cross_scene(draft);
    return draft;
  }
  if (lamp.s.kind != LampKind::kArea) {
    draft.sort = Draft::kLines;
    draft.cross_disc(lamp.center, lamp.s.radius);
  }
  weigh_lamp(lamp, draft);
  return draft;
}

// Starts as natural emission does, and then goes to the target instead where it can be seen from
// there.
PhotonEmitter::Draft PhotonEmitter::aimed_draft(const EmissionPrimary& primary,
                                                const EmissionTargets::Sphere& t) const {
  const auto& [index, pick, place, way, weight, time, cell] = primary;
  Draft draft = natural_draft(primary);
  PhotonStart& start = draft.start;
  if (draft.sort == Draft::kPoint) {
    const Vec3 to = t.center - start.origin;
    const float d2 = length2(to), r2 = t.radius * t.radius;
    if (d2 <= r2) return draft;
    start.direction = Basis(to / std::sqrt(d2)).to_world(sample_cone(way, cone_of(r2, d2)));
    const Emitter& e = emitters_[index];
    EmissiveTriangle moved;
    if (e.lamp >= 0)
      weigh_lamp(lamps_[e.lamp], draft);
    else
      weigh_mesh(e, e.mesh.point_at(scene_, e.instance, pick.y, place, time, moved), draft);
    return draft;
  }
  const Lamp* lamp = draft.sort == Draft::kLines ? &lamps_[emitters_[index].lamp] : nullptr;
  const Vec3 to = t.center - draft.center;
  const float d2 = length2(to), reach = t.radius + draft.radius;
  if (lamp && d2 > reach * reach) {  // from within it, its light comes from everywhere
    start.direction =
        Basis(to / std::sqrt(d2)).to_world(sample_cone(way, cone_of(reach * reach, d2)));
    weigh_lamp(*lamp, draft);
  }
  const Vec2 p = sample_disk(place);
  const float spread = std::min(t.radius, draft.radius);
  draft.offset = Basis(start.direction).to_world({p.x * spread, p.y * spread, 0});
  if (t.radius < draft.radius) draft.offset += to - start.direction * dot(to, start.direction);
  const float depth2 = draft.radius * draft.radius - length2(draft.offset);
  if (!lamp) {
    start.from_afar = true;
    weigh_parallel(draft);
    const Vec3 across = draft.center + draft.offset,
               through = across + start.direction * dot(t.center - across, start.direction);
    start.origin = parallel_origin(start.direction, through,
                                   across - start.direction * draft.radius, t.radius, time);
    return draft;
  }
  if (depth2 < 0) start.power = {};  // natural emission leaves that dark
  const float half = std::sqrt(std::max(0.0f, depth2));
  const float ahead = !lamp->s.soft_falloff  ? (draft.inside ? -half : half)
                      : lamp->faces_geometry ? -half
                                             : 0;
  start.soft_miss2 = length2(draft.offset);
  start.soft_nearest = -ahead;
  start.origin = draft.center + draft.offset + start.direction * ahead;
  if (draft.inside) start.first_hit_to = -2 * ahead;
  return draft;
}

// Density with which the target would have drawn this line, in the measure of draft.natural. own:
// it did.
float PhotonEmitter::aimed_density(const Draft& draft, const EmissionTargets::Sphere& t,
                                   bool own) const {
  const PhotonStart& start = draft.start;
  const float r2 = t.radius * t.radius, disc2 = draft.radius * draft.radius;
  // Density of places on the disc across the line, relative to the whole disc.
  const auto place_density = [&](const Vec3& to) {
    if (t.radius >= draft.radius) return 1.0f;
    const Vec3 across = to - start.direction * dot(to, start.direction);
    return own || length2(draft.offset - across) <= r2 * kSlack ? disc2 / r2 : 0.0f;
  };
  if (draft.sort == Draft::kParallel) return place_density(t.center - draft.center);
  const bool lines = draft.sort == Draft::kLines;
  const Vec3 to = t.center - (lines ? draft.center : start.origin);
  const float d2 = length2(to), reach = t.radius + (lines ? draft.radius : 0);
  if (d2 <= reach * reach) return lines ? draft.natural * place_density(to) : draft.natural;
  const float density =
      cone_density(to / std::sqrt(d2), cone_of(reach * reach, d2), start.direction, own);
  return density > 0 && lines ? density * place_density(to) : density;
}

// A light far off sends most of its photons past all that is seen. It sends as many to each of
// several spheres about it, each four times as wide as the one before, as by nature: what comes to
// lie twice as far off brings a quarter of the light to what is near.
PhotonStart PhotonEmitter::emit_nearby(const EmissionPrimary& p) const {
  const Emitter& e = emitters_[p.emitter];
  EmissiveTriangle moved;
  const Vec3 from =
      e.lamp >= 0 ? lamps_[e.lamp].center
                  : e.mesh.point_at(scene_, e.instance, p.pick.y, p.place, p.time, moved).position;
  const int spheres = near_spheres(scene_, length(from));
  Vec2 way = p.way;
  // Chances are equal; the first third goes to the smallest sphere, beside its own one.
  const int more = spheres / 3, chances = spheres + 1 + more;
  const float chosen = way.x * static_cast<float>(chances);
  const int chance = std::min(static_cast<int>(chosen), chances - 1),
            own = std::max(0, chance - more);
  way.x = std::min(chosen - static_cast<float>(chance), kBelowOne);
  const auto sphere = [&](int k) {
    EmissionTargets::Sphere s{};
    s.radius = near_sphere(scene_, k);
    return s;
  };
  EmissionPrimary drawn = p;
  drawn.way = way;
  Draft draft = own < spheres ? aimed_draft(drawn, sphere(own)) : natural_draft(drawn);
  float density = draft.natural;
  for (int k = 0; k < spheres; ++k)
    density += static_cast<float>(k ? 1 : 1 + more) * aimed_density(draft, sphere(k), k == own);
  if (spheres)
    draft.start.power *= density > 0 ? draft.natural * static_cast<float>(chances) / density : 0.0f;
  if (spheres)
    start_nearby(
        draft.start.origin - draft.start.direction * dot(draft.start.origin, draft.start.direction),
        p.time, draft.start);
  return finished(draft.start, p);
}

// A place millions of metres away is known to a few centimetres. Where nothing stands before it,
// the way begins near its end, at `across` from the origin.
void PhotonEmitter::start_nearby(const Vec3& across, float time, PhotonStart& start) const {
  if (!start.plain() || !(max_abs(start.power) > 0)) return;
  const float ahead = 2 * std::max(near_sphere(scene_, 0), length(across)),
              before = -dot(start.origin, start.direction) - ahead;
  const Vec3 origin = across - start.direction * ahead;
  if (before > 0 &&
      !scene_.occluded(origin, -start.direction, 0, before * (1 - 1e-5f), kAllRays, time))
    start.origin = origin;
}

// About the power that passes from an emitter to a sphere, W, nothing standing between them.
double PhotonEmitter::flux_between(uint32_t index, const EmissionTargets::Sphere& t) const {
  const auto parallel = [&](double power) {
    return power * std::min(double(kPi) * t.radius * t.radius, discs_.scene_area()) /
           discs_.least_area();
  };
  if (index == emitters_.size()) return parallel(world_power_);
  const Emitter& e = emitters_[index];
  const Vec3 to = t.center - e.center;
  const float d2 = length2(to), d = std::sqrt(d2);
  if (e.lamp >= 0 && lamps_[e.lamp].s.kind == LampKind::kSun) return parallel(e.power);
  const float reach = t.radius + e.radius;
  if (d <= reach)
    return e.power * std::min(1.0, double(t.radius) * t.radius /
                                       std::max(double(e.radius) * e.radius, 1e-30));
  const double solid_angle = 2 * kPi * cone_of(t.radius * t.radius, d2);
  if (e.lamp < 0) return e.importance * 0.5 * solid_angle;
  const Lamp& lamp = lamps_[e.lamp];
  // Sine of the angle by which the target may lie nearer to the lamp's axis than its centre does
  const float sine = reach / d;
  if (lamp.s.kind == LampKind::kPoint) return e.importance * solid_angle;
  const Vec3 unit = to / d;
  const float cosine = std::clamp(dot(unit, lamp.forward), -1.0f, 1.0f);
  const float angle = std::max(0.0f, std::acos(cosine) - std::asin(sine));
  if (lamp.s.kind == LampKind::kSpot) {
    const Vec3 across = unit - lamp.forward * cosine;
    const float length_across = length(across);
    const Vec3 nearest = length_across > 1e-6f ? lamp.forward * std::cos(angle) +
                                                     across * (std::sin(angle) / length_across)
                                               : lamp.forward;
    return e.importance * solid_angle *
           std::max(spot_attenuation(lamp, nearest), spot_attenuation(lamp, unit));
  }
  if (angle >= 0.5f * kPi) return 0;
  return e.importance * std::cos(angle) * spread_attenuation(lamp, std::tan(angle)) * solid_angle;
}

EmissionTargets PhotonEmitter::aim_at(std::vector<EmissionTargets::Sphere> spheres) const {
  EmissionTargets targets;
  targets.spheres_ = std::move(spheres);
  std::vector<double> most(targets.spheres_.size(), 0.0);
  const uint32_t emitters = static_cast<uint32_t>(emitters_.size()) + (world_power_ > 0 ? 1 : 0);
  for (uint32_t e = 0; e < emitters; ++e)
    for (uint32_t t = 0; t < targets.spheres_.size(); ++t) {
      const EmissionTargets::Sphere& s = targets.spheres_[t];
      if (!(s.radius > 0) || !(s.weight > 0) || !is_finite(s.center) ||
          !std::isfinite(s.radius * s.weight))
        continue;
      const double flux = flux_between(e, s) * s.weight;
      if (!(flux > 0) || !std::isfinite(flux)) continue;
      targets.pairs_.push_back({e, t, flux});
      most[t] = std::max(most[t], flux);
    }
  std::erase_if(targets.pairs_, [&](const EmissionTargets::Pair& p) {
    return p.flux < kLeastFlux * most[p.target];
  });
  targets.first_pair_.assign(emitters_.size() + 2, 0);
  for (const EmissionTargets::Pair& p : targets.pairs_) ++targets.first_pair_[p.emitter + 1];
  for (size_t e = 1; e < targets.first_pair_.size(); ++e)
    targets.first_pair_[e] += targets.first_pair_[e - 1];
  std::vector<double> wishes;
  for (const EmissionTargets::Pair& p : targets.pairs_) wishes.push_back(p.flux);
  targets.distribute(wishes);
  return targets;
}

// Emitter and way are chosen, and where in the sky the world's light comes from: that is the same
// by all ways, so that its density is one factor.
PhotonEmitter::Aimed PhotonEmitter::aimed_primary(const EmissionTargets& targets, uint64_t index,
                                                  uint32_t seed) const {
  Aimed out{primary(index, seed, nullptr), -1};
  EmissionPrimary& p = out.primary;
  const double natural_share = targets.natural_share();
  if (p.pick.x < natural_share) {
    const double target = p.pick.x / natural_share * total_power_;
    p.emitter = static_cast<uint32_t>(std::min<size_t>(
        std::upper_bound(power_cdf_.begin(), power_cdf_.end(), target) - power_cdf_.begin(),
        emitters_.size()));
  } else {
    const double u = (p.pick.x - natural_share) / (1 - natural_share);
    const size_t at = std::upper_bound(targets.pair_cdf_.begin(), targets.pair_cdf_.end(), u) -
                      targets.pair_cdf_.begin();
    out.pair = static_cast<int32_t>(std::min(at, targets.pairs_.size() - 1));
    p.emitter = targets.pairs_[out.pair].emitter;
  }
  if (p.emitter == emitters_.size())
    p.weight /= targets.world_ways_.warp(p.way, guide_number(index, seed));
  return out;
}

void PhotonEmitter::learn(EmissionTargets& targets, uint64_t index, uint32_t seed,
                          double useful) const {
  const Vec2 way = aimed_primary(targets, index, seed).primary.way;
  targets.learn(emit_towards(targets, index, seed), way, useful);
}

PhotonStart PhotonEmitter::emit_towards(const EmissionTargets& targets, uint64_t index,
                                        uint32_t seed) const {
  const auto [p, aim] = aimed_primary(targets, index, seed);
  Draft draft =
      aim < 0 ? natural_draft(p) : aimed_draft(p, targets.spheres_[targets.pairs_[aim].target]);
  const double power = p.emitter == emitters_.size() ? world_power_ : emitters_[p.emitter].power;
  double density = targets.natural_share() * power / total_power_ * draft.natural;
  float narrowest = 0;
  int32_t towards = -1;
  if (!targets.pairs_.empty())
    for (uint32_t i = targets.first_pair_[p.emitter]; i < targets.first_pair_[p.emitter + 1]; ++i) {
      const EmissionTargets::Pair& pair = targets.pairs_[i];
      const auto number = static_cast<int32_t>(i);
      const float aimed = aimed_density(draft, targets.spheres_[pair.target], number == aim);
      density += pair.probability * aimed;
      if (aimed > narrowest) narrowest = aimed, towards = number;
    }
  draft.start.power *= density > 0 ? p.weight * static_cast<float>(draft.natural / density) : 0.0f;
  draft.start.aim = towards;
  draft.start.time = p.time;
  tell(p.emitter, draft.start);
  if (!draft.start.of_world) draft.start.power *= emitters_[p.emitter].past_surface;
  return draft.start;
}

}  // namespace photon_splat
