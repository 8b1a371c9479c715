// Photons start in proportion to power, or where a guide sends them: one by one, or many at once.
#include "lights/emission/photon_emitter.h"
#include "math/random_streams.h"

namespace photon_splat {
namespace {

constexpr float kHugeScene = 1000, kStartsAt = 16;  // times the width of a disc
constexpr uint32_t kMost = SobolPair::kMost;

struct alignas(64) Lanes {
  float x[kMost], y[kMost], z[kMost];
  void put(uint32_t k, const Vec3& v) { x[k] = v.x, y[k] = v.y, z[k] = v.z; }
  Vec3 at(uint32_t k) const { return {x[k], y[k], z[k]}; }
};

constexpr uint32_t whole_vectors(uint32_t count) { return (count + 15) & ~15u; }

}  // namespace

// From far outside of a scene that is huge against what is seen nothing could be hit precisely:
// unless something far off stands in the way, the path starts nearer.
Vec3 PhotonEmitter::parallel_origin(const Vec3& direction, const Vec3& through, const Vec3& outside,
                                    float width, float time) const {
  if (!discs_.focused() || discs_.radius() < kHugeScene * width) return outside;
  const Vec3 near = through - direction * (kStartsAt * width);
  return scene_.occluded(near, -direction, 0, INFINITY, kAllRays, time) ? outside : near;
}

PhotonStart PhotonEmitter::emit_parallel(const Vec3& direction, const Vec2& place,
                                         float time) const {
  const EmissionDiscs::Place from = discs_.sample(direction, place);
  PhotonStart start;
  start.origin = parallel_origin(direction, from.through, from.outside, from.width, time);
  start.direction = direction;
  start.from_afar = true;
  const float area = discs_.area(direction, from.through);
  start.power = {area, area, area};
  return start;
}

PhotonStart PhotonEmitter::emit_world(const Vec2& place, const Vec2& way, float time) const {
  const Environment::Sample s = environment_.sample(way);
  PhotonStart start = emit_parallel(-s.direction, place, time);
  start.power *= s.pdf > 0 ? environment_.radiance(s.direction) / s.pdf : Rgb{};
  start.asks_ray = environment_.asks_ray();
  if (scene_.shadows_differ())
    (environment_.constant() ? start.by_rays : start.shares_with_rays) = true;
  return start;
}

PhotonStart PhotonEmitter::emit_lamp(const Lamp& lamp, float coin, const Vec2& place,
                                     const Vec2& way, float time) const {
  if (lamp.s.kind == LampKind::kArea) return emit_area_lamp(lamp, place, way);
  if (lamp.s.kind != LampKind::kSun) return emit_point_lamp(lamp, coin, place, way);
  PhotonStart start = emit_parallel(
      Basis(lamp.forward).to_world(sample_cone(way, lamp.one_minus_cos)), place, time);
  start.power *=
      lamp.one_minus_cos > 0 ? lamp.radiance * (2 * kPi * lamp.one_minus_cos) : lamp.intensity;
  return start;
}

void PhotonEmitter::primaries(uint64_t first, uint32_t count, uint32_t seed,
                              const EmissionGuide* guide, EmissionPrimary* out) const {
  const uint32_t low = static_cast<uint32_t>(first),
                 key = hash_combine(seed, static_cast<uint32_t>(first >> 32));
  if (count > 1 && low + (count - 1) < low) {  // the upper half of the index changes on the way
    const uint32_t before = 0u - low;
    primaries(first, before, seed, guide, out);
    return primaries(first + before, count - before, seed, guide, out + before);
  }
  SobolPair::Run pick, place, way, again;
  photon_numbers(PhotonDimension::kEmitter, key).fill(low, count, pick);
  photon_numbers(PhotonDimension::kPlace, key).fill(low, count, place);
  photon_numbers(PhotonDimension::kDirection, key).fill(low, count, way);
  if (guide) photon_numbers(PhotonDimension::kGuide, key).fill(low, count, again);
  SobolPair::Run when;
  const bool moves = scene_.moves();
  if (moves) photon_numbers(PhotonDimension::kTime, key).fill(low, count, when);
  for (uint32_t i = 0; i < count; ++i) {
    EmissionPrimary& p = out[i] = {0, pick[i], place[i], way[i]};
    if (moves) p.time = scene_.shutter.time(when.x[i], when.y[i]);
    if (guide) {
      guide->warp(p, {p.pick.x, again.x[i]});
      continue;
    }
    const double target = p.pick.x * total_power_;
    const size_t chosen =
        std::upper_bound(power_cdf_.begin(), power_cdf_.end(), target) - power_cdf_.begin();
    p.emitter = static_cast<uint32_t>(std::min(chosen, emitters_.size()));
  }
}

PhotonStart PhotonEmitter::emit(const EmissionPrimary& p) const {
  const bool parallel = p.emitter == emitters_.size() || emitters_[p.emitter].parallel_flux > 0;
  if (scene_.has_far_things() && !parallel) return emit_nearby(p);
  PhotonStart start;
  if (p.emitter == emitters_.size()) {
    start = emit_world(p.place, p.way, p.time);
  } else {
    const Emitter& e = emitters_[p.emitter];
    start = e.lamp >= 0
                ? emit_lamp(lamps_[e.lamp], p.pick.y, p.place, p.way, p.time)
                : emit_mesh_light(scene_, e.mesh, e.instance, p.pick.y, p.place, p.way, p.time);
  }
  return finished(start, p);
}

EmissionGuide PhotonEmitter::make_guide() const {
  std::vector<double> powers;
  for (const Emitter& e : emitters_) powers.push_back(e.power);
  powers.push_back(world_power_);
  return EmissionGuide(std::move(powers));
}

void PhotonEmitter::tell(uint32_t emitter, PhotonStart& start) const {
  if (emitter == emitters_.size()) {
    start.light_group = scene_.world_light_group;
    start.seen_by = as_scattered(scene_.world_seen_by);
    start.of_world = true;
    return;
  }
  const Emitter& e = emitters_[emitter];
  if (e.lamp >= 0 && lamps_[e.lamp].s.program >= 0) start.shaded_by = e.lamp;
  start.lit_groups = e.lit_groups;
  start.blockers = e.blockers;
  start.light_group = e.light_group;
  start.seen_by = e.seen_by;
  start.max_bounces = e.max_bounces;
  start.deltas = e.met_by_rays;
  start.casts_shadows = e.casts_shadows;
  if (e.lamp >= 0 && !e.casts_shadows && e.met_by_rays)
    start.unshadowed = static_cast<int32_t>(emitter);
  if (e.exact) start_exactly(emitter, start);
}

PhotonStart& PhotonEmitter::finished(PhotonStart& start, const EmissionPrimary& p) const {
  tell(p.emitter, start);
  float over_share = over_world_share_;
  if (!start.of_world) {
    const Emitter& e = emitters_[p.emitter];
    over_share = e.over_share * e.past_surface;
    if (e.lamp >= 0 && !e.exact && e.met_by_rays && e.past_surface >= 1 && scene_.shadows_differ())
      start.told_apart = static_cast<int32_t>(p.emitter);
  }
  start.power *= over_share * p.weight;
  start.time = p.time;
  return start;
}

void PhotonEmitter::emit(const EmissionPrimary* primaries, uint32_t count, PhotonStart* out) const {
  uint32_t meshes[kMost], areas[kMost], mesh_count = 0, area_count = 0;
  const bool plain = !scene_.has_far_things();
  for (uint32_t i = 0; i < count; ++i) {
    const EmissionPrimary& p = primaries[i];
    const Emitter* e = plain && p.emitter < emitters_.size() && !emitters_[p.emitter].exact
                           ? &emitters_[p.emitter]
                           : nullptr;
    if (e && e->lamp < 0 && !scene_.moves(e->instance))
      meshes[mesh_count++] = i;
    else if (e && e->lamp >= 0 && lamps_[e->lamp].s.kind == LampKind::kArea &&
             lamps_[e->lamp].angle_cdf.empty())
      areas[area_count++] = i;
    else
      out[i] = emit(p);
  }
  if (mesh_count) emit_meshes(primaries, meshes, mesh_count, out);
  if (area_count) emit_areas(primaries, areas, area_count, out);
}

// emit_mesh()
void PhotonEmitter::emit_meshes(const EmissionPrimary* primaries, const uint32_t* which,
                                uint32_t count, PhotonStart* out) const {
  const uint32_t* starts[kMost];
  const EmissiveTriangle* triangles[kMost];
  uint32_t numbers[kMost];
  bool back[kMost];
  alignas(64) float target[kMost], root[kMost] = {}, turn[kMost] = {}, u[kMost], v[kMost],
                                   way_x[kMost] = {}, way_y[kMost] = {};
  Lanes places{}, normals, ways;
  const auto emitter = [&](uint32_t k) -> const Emitter& {
    return emitters_[primaries[which[k]].emitter];
  };
  for (uint32_t k = 0; k < count; ++k) {
    const EmissionPrimary& p = primaries[which[k]];
    const Emitter& e = emitter(k);
    target[k] = p.pick.y * e.mesh.cdf.back();
    prefetch(starts[k] = &e.mesh.cdf_start[e.mesh.step_at(target[k])]);
    root[k] = p.place.x, turn[k] = p.place.y;
    way_x[k] = p.way.x, way_y[k] = p.way.y;
  }
  for (uint32_t k = 0; k < count; ++k) {
    const Emitter& e = emitter(k);
    numbers[k] = *starts[k];
    prefetch(&e.mesh.cdf[numbers[k]]);
    prefetch(&e.mesh.triangles[numbers[k]]);
  }
  const uint32_t lanes = whole_vectors(count);
  for (uint32_t k = 0; k < lanes; ++k) {
    root[k] = std::sqrt(root[k]);
    u[k] = root[k] * (1 - turn[k]);
    v[k] = root[k] * turn[k];
  }
  for (uint32_t k = 0; k < count; ++k) {
    const Emitter& e = emitter(k);
    const size_t i = e.mesh.triangle_from(numbers[k], target[k]);
    const EmissiveTriangle& t = *(triangles[k] = &e.mesh.triangles[i]);
    back[k] = e.mesh.side_of(i, target[k]) >= t.front_share;
    places.put(k, t.corner[0] * (1 - root[k]) + t.corner[1] * u[k] + t.corner[2] * v[k]);
    normals.put(k, back[k] ? -t.normal : t.normal);
  }
  for (uint32_t k = count; k < lanes; ++k) normals.put(k, {0, 0, 1});
  for (uint32_t k = 0; k < lanes; ++k) {
    const Vec3 n = normals.at(k), x = places.at(k);
    const float off = k < count ? start_offset(scene_, emitter(k).instance, *triangles[k], x) : 0;
    places.put(k, x + n * off);
    ways.put(k, Basis(n).to_world(sample_cosine_hemisphere({way_x[k], way_y[k]})));
  }
  for (uint32_t k = 0; k < count; ++k) {
    const EmissiveTriangle& t = *triangles[k];
    PhotonStart& start = out[which[k]] = PhotonStart{};
    start.origin = places.at(k);
    start.direction = ways.at(k);
    start.power = emission_of(scene_, emitter(k).instance, t, u[k], v[k], back[k], start.direction,
                              kShutterCentre) *
                  (kPi / (t.pdf * (back[k] ? 1 - t.front_share : t.front_share)));
    finished(start, primaries[which[k]]);
  }
}

// emit_lamp() of area lamps that shine as much in all directions
void PhotonEmitter::emit_areas(const EmissionPrimary* primaries, const uint32_t* which,
                               uint32_t count, PhotonStart* out) const {
  alignas(64) float sine2[kMost] = {}, turn[kMost] = {}, tangent[kMost];
  Lanes ways;
  for (uint32_t k = 0; k < count; ++k)
    sine2[k] = primaries[which[k]].way.x, turn[k] = primaries[which[k]].way.y;
  for (uint32_t k = 0; k < whole_vectors(count); ++k) {
    const float cosine = std::sqrt(std::max(0.0f, 1 - sine2[k]));
    const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const Vec2 around = cos_sin_of_turn(turn[k]);
    ways.put(k, {sine * around.x, sine * around.y, cosine});
    tangent[k] = std::sqrt(sine2[k] / std::max(1 - sine2[k], 1e-12f));
  }
  for (uint32_t k = 0; k < count; ++k) {
    const EmissionPrimary& p = primaries[which[k]];
    const Lamp& lamp = lamps_[emitters_[p.emitter].lamp];
    const Vec2 place =
        lamp.s.ellipse ? sample_disk(p.place) : Vec2{2 * p.place.x - 1, 2 * p.place.y - 1};
    PhotonStart& start = out[which[k]] = PhotonStart{};
    start.origin =
        lamp.center + lamp.axis_x * (place.x * lamp.half_x) + lamp.axis_y * (place.y * lamp.half_y);
    start.direction = Basis(lamp.forward).to_world(ways.at(k));
    start.power = lamp.radiance * (lamp.area * kPi * spread_attenuation(lamp, tangent[k]));
    finished(start, p);
  }
}

Rgb PhotonEmitter::first_hit_factor(const PhotonStart& start, const Vec3& receiver,
                                    float distance) const {
  const Lamp& lamp = lamps_[start.shaded_by];
  if (lamp.s.kind == LampKind::kSun)
    return lamp_program(scene_, lamp, {}, start.direction, INFINITY);
  // The disc faces the receiver, not the photon
  if (lamp.s.kind != LampKind::kArea && lamp.s.radius > 0 && lamp.s.soft_falloff) {
    const Vec3 to = lamp.center - receiver;
    distance = length2(to) / std::max(-dot(to, start.direction), 1e-20f);
    return lamp_program(scene_, lamp, receiver - start.direction * distance, start.direction,
                        distance);
  }
  return lamp_program(scene_, lamp, start.origin, start.direction, distance);
}

}  // namespace photon_splat
