// Starting many photons at once. Each step is a loop over all of them, so that none waits for the
// steps of another, and what a step reads of large tables is fetched by the one before it.
#include "lights/lights.h"

namespace photon_splat {
namespace {

constexpr uint32_t kMost = SobolPair::kMost;

struct alignas(64) Lanes {
  float x[kMost], y[kMost], z[kMost];
  void put(uint32_t k, const Vec3& v) { x[k] = v.x, y[k] = v.y, z[k] = v.z; }
  Vec3 at(uint32_t k) const { return {x[k], y[k], z[k]}; }
};

constexpr uint32_t whole_vectors(uint32_t count) { return (count + 15) & ~15u; }

}  // namespace

PhotonStart& Lights::finished(PhotonStart& start, const EmissionPrimary& p) const {
  float over_share = over_world_share_;
  if (p.emitter == emitters_.size()) {
    start.light_group = scene_.world_light_group;
    start.seen_by = as_scattered(scene_.world_seen_by);
  } else {
    const Emitter& e = emitters_[p.emitter];
    if (e.lamp >= 0 && lamps_[e.lamp].s.program >= 0) start.shaded_by = e.lamp;
    over_share = e.over_share;
    start.lit_groups = e.lit_groups;
    start.blockers = e.blockers;
    start.light_group = e.light_group;
    start.seen_by = e.seen_by;
    start.max_bounces = e.max_bounces;
    start.deltas = e.met_by_rays;
    start.casts_shadows = e.casts_shadows;
    if (e.exact) start_exactly(p.emitter, start);
  }
  start.power *= over_share * p.weight;
  return start;
}

void Lights::emit(const EmissionPrimary* primaries, uint32_t count, PhotonStart* out) const {
  uint32_t meshes[kMost], areas[kMost], mesh_count = 0, area_count = 0;
  const bool plain = !scene_.has_far_things();
  for (uint32_t i = 0; i < count; ++i) {
    const EmissionPrimary& p = primaries[i];
    const Emitter* e = plain && p.emitter < emitters_.size() && !emitters_[p.emitter].exact
                           ? &emitters_[p.emitter]
                           : nullptr;
    if (e && e->lamp < 0)
      meshes[mesh_count++] = i;
    else if (e && lamps_[e->lamp].s.kind == LampKind::kArea && lamps_[e->lamp].angle_cdf.empty())
      areas[area_count++] = i;
    else
      out[i] = emit(p);
  }
  if (mesh_count) emit_meshes(primaries, meshes, mesh_count, out);
  if (area_count) emit_areas(primaries, areas, area_count, out);
}

// emit_mesh()
void Lights::emit_meshes(const EmissionPrimary* primaries, const uint32_t* which, uint32_t count,
                         PhotonStart* out) const {
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
    target[k] = p.pick.y * e.cdf.back();
    prefetch(starts[k] = &e.cdf_start[e.step_at(target[k])]);
    root[k] = p.place.x, turn[k] = p.place.y;
    way_x[k] = p.way.x, way_y[k] = p.way.y;
  }
  for (uint32_t k = 0; k < count; ++k) {
    const Emitter& e = emitter(k);
    numbers[k] = *starts[k];
    prefetch(&e.cdf[numbers[k]]);
    prefetch(&e.triangles[numbers[k]]);
  }
  const uint32_t lanes = whole_vectors(count);
  for (uint32_t k = 0; k < lanes; ++k) {
    root[k] = std::sqrt(root[k]);
    u[k] = root[k] * (1 - turn[k]);
    v[k] = root[k] * turn[k];
  }
  for (uint32_t k = 0; k < count; ++k) {
    const Emitter& e = emitter(k);
    const size_t i = e.triangle_from(numbers[k], target[k]);
    const EmissiveTriangle& t = *(triangles[k] = &e.triangles[i]);
    back[k] = side_of(e, i, target[k]) >= t.front_share;
    places.put(k, t.corner[0] * (1 - root[k]) + t.corner[1] * u[k] + t.corner[2] * v[k]);
    normals.put(k, back[k] ? -t.normal : t.normal);
  }
  for (uint32_t k = count; k < lanes; ++k) normals.put(k, {0, 0, 1});
  for (uint32_t k = 0; k < lanes; ++k) {
    const Vec3 n = normals.at(k), x = places.at(k);
    places.put(k, x + n * ray_epsilon(x, 0));
    ways.put(k, Basis(n).to_world(sample_cosine_hemisphere({way_x[k], way_y[k]})));
  }
  for (uint32_t k = 0; k < count; ++k) {
    const EmissiveTriangle& t = *triangles[k];
    PhotonStart& start = out[which[k]] = PhotonStart{};
    start.origin = places.at(k);
    start.direction = ways.at(k);
    start.power = emission_of(emitter(k), t, u[k], v[k], back[k], start.direction) *
                  (kPi / (t.pdf * (back[k] ? 1 - t.front_share : t.front_share)));
    finished(start, primaries[which[k]]);
  }
}

// emit_lamp() of area lamps that shine as much in all directions
void Lights::emit_areas(const EmissionPrimary* primaries, const uint32_t* which, uint32_t count,
                        PhotonStart* out) const {
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

}  // namespace photon_splat
