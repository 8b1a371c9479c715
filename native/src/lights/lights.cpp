#include "lights/lights.h"

#include "lights/emission/photon_emitter.h"
#include "media/media.h"

namespace photon_splat {
namespace {

// The matrix of a lamp that may be flattened, as Cycles has it: a point lamp has no axes to lose
// and a sun but one, so that others take the place of those that are lost. What is flat still after
// that emits nothing.
Affine with_all_axes(const LampSettings& s) {
  Affine m = s.to_world;
  Vec3 axis[3] = {m.column(0), m.column(1), m.column(2)};
  const auto flat = [&](int i) { return !(length2(axis[i]) > 0); };
  if (s.kind == LampKind::kPoint && (flat(0) || flat(1) || flat(2))) {
    axis[0] = {1, 0, 0}, axis[1] = {0, 1, 0}, axis[2] = {0, 0, 1};
  } else if (s.kind == LampKind::kSun && !flat(2)) {
    const Basis basis(normalize(axis[2]));
    if (flat(0)) axis[0] = basis.tangent;
    if (flat(1)) axis[1] = basis.bitangent;
  }
  for (int i = 0; i < 3; ++i) m.m[i] = axis[i].x, m.m[4 + i] = axis[i].y, m.m[8 + i] = axis[i].z;
  return m;
}

constexpr size_t kLargeEmitter = 1 << 14;  // triangles
constexpr uint32_t kProbes = 512;
// Share of the brightest probe: where the program shines in a few directions only, they are still
// found
constexpr float kLeastShare = 0.01f;

}  // namespace

Lights::Lights(Scene& scene, const std::vector<LampSettings>& lamps)
    : scene_(scene), environment_(scene), discs_(scene.center(), scene.radius() * 1.0001f) {
  for (const LampSettings& lamp : lamps) {
    add_lamp(lamp);
    if (!lamps_.empty() && lamps_.back().number == Lamp::kUnnumbered)
      lamps_.back().number = static_cast<uint32_t>(&lamp - lamps.data());
  }
  add_emissive_instances(scene.pool());
  find_lights_in_surfaces();
  share_power();
  if (emitters_.size() > kFewEmitters)
    build_tree();
  else
    place_lamps();
  choose_along();
  for (uint32_t i = 0; i < emitters_.size(); ++i)
    if (emitters_[i].lamp >= 0 && lamps_[emitters_[i].lamp].s.camera_visible)
      visible_lamps_.push_back(i);
  for (uint32_t i = 0; i < emitters_.size(); ++i)
    if (~emitters_[i].blockers) shadow_linked_.push_back(i);
  hide_from_some_ = hides_from_some(scene_.world_seen_by);
  for (const Emitter& e : emitters_) hide_from_some_ |= hides_from_some(e.seen_by);
}

void Lights::add_lamp(const LampSettings& settings) {
  Lamp lamp;
  lamp.s = settings;
  const Affine m = with_all_axes(settings);
  lamp.center = {m.m[3], m.m[7], m.m[11]};
  const Vec3 x = m.column(0), y = m.column(1), z = m.column(2);
  lamp.scale_x = length(x);
  lamp.scale_y = length(y);
  lamp.scale_z = length(z);
  if (!(lamp.scale_x > 0) || !(lamp.scale_y > 0) || !(lamp.scale_z > 0)) return;
  lamp.axis_x = x / lamp.scale_x;
  lamp.axis_y = y / lamp.scale_y;
  lamp.forward = z / -lamp.scale_z;
  if (is_black(settings.strength)) return;
  if (settings.kind == LampKind::kSun && scene_.media() && scene_.media()->stops_far_light())
    return;
  if (settings.program >= 0) lamp.place = {m, inverse(m)};

  std::optional<LampOutput> output;
  switch (settings.kind) {
    case LampKind::kPoint:
    case LampKind::kSpot: output = set_up_point_lamp(scene_, lamp); break;
    case LampKind::kArea: output = set_up_area_lamp(lamp); break;
    case LampKind::kSun:
      output = set_up_sun(lamp);
      output->power = output->parallel_flux * discs_.least_area();
      break;
  }
  if (!output) return;
  Emitter e;
  e.lamp = static_cast<int>(lamps_.size());
  e.center = lamp.center;
  e.radius = output->radius;
  e.importance = output->importance;
  e.power = output->power;
  e.parallel_flux = output->parallel_flux;
  if (settings.program >= 0) {
    const float mean = mean_of_program(lamp);
    e.importance *= mean;
    e.power *= mean;
  }
  if (settings.kind != LampKind::kSun) e.power *= near_share(scene_, lamp.center);
  if (!(e.power > 0)) return;
  e.lit_groups = settings.lit_groups;
  e.blockers = settings.blockers;
  e.light_group = settings.light_group;
  e.seen_by = as_scattered(light_rays(settings.seen_by, false));
  e.max_bounces = settings.max_bounces;
  e.met_by_rays = settings.met_by_rays;
  e.casts_shadows = settings.casts_shadows;
  if (!(e.seen_by & kScatteredRays)) e.importance = 0, e.power = 0;
  const bool flat = settings.kind == LampKind::kArea;
  for (const float i : {-1.0f, 1.0f})
    for (const float j : {-1.0f, 1.0f})
      e.bounds.add(lamp.center +
                   (flat ? lamp.axis_x * (i * lamp.half_x) + lamp.axis_y * (j * lamp.half_y)
                         : Vec3{1, 1, 1} * (i * e.radius)));
  lamps_.push_back(std::move(lamp));
  emitters_.push_back(std::move(e));
}

// Many small meshes are made into emitters at a time, large ones one after another, by all threads
// each.
void Lights::add_emissive_instances(ThreadPool& pool) {
  std::vector<uint32_t> found;
  for (uint32_t i = 0; i < scene_.instances.size(); ++i)
    if (is_emissive(scene_.instances[i])) found.push_back(i);
  const auto large = [&](uint32_t instance) {
    return scene_.meshes[scene_.instances[instance].mesh].triangles.size() > kLargeEmitter;
  };
  std::vector<std::optional<Emitter>> made(found.size());
  pool.for_each(found.size(), CancelFlag(), [&](size_t k, int) {
    if (!large(found[k])) made[k] = emitter_of(found[k], nullptr);
  });
  emitter_of_instance_.assign(scene_.instances.size(), -1);
  for (size_t k = 0; k < found.size(); ++k) {
    if (large(found[k])) made[k] = emitter_of(found[k], &pool);
    if (!made[k]) continue;
    emitter_of_instance_[found[k]] = static_cast<int32_t>(emitters_.size());
    emitters_.push_back(std::move(*made[k]));
  }
}

bool Lights::is_emissive(const Instance& instance) const {
  if (!(instance.seen_by & kScatteredRays)) return false;
  for (uint32_t s = 0; s < instance.slot_count; ++s)
    if (may_emit(scene_, scene_.materials[scene_.slot_materials[instance.first_material + s]]))
      return true;
  return false;
}

// Nothing where the instance sends out no light. pool: of who waits for it; or null.
std::optional<Emitter> Lights::emitter_of(uint32_t number, ThreadPool* pool) const {
  const Instance& instance = scene_.instances[number];
  Emitter e;
  e.instance = number;
  e.lit_groups = instance.lit_groups;
  e.blockers = instance.blockers;
  e.light_group = instance.light_group;
  e.seen_by = as_scattered(light_rays(instance.seen_by, false));
  double sum = 0;
  e.mesh = make_mesh_light(scene_, pool, number, e.bounds, sum);
  if (!(sum > 0) || !std::isfinite(sum)) return {};
  e.center = e.bounds.center();
  e.radius = 0.5f * e.bounds.diagonal();
  e.importance = static_cast<float>(sum);
  e.power = sum * kPi;
  if (scene_.has_far_things()) {
    double close = 0;
    for (size_t t = 0; t < e.mesh.cdf.size(); ++t) {
      const Vec3* corner = e.mesh.triangles[t].corner;
      close += double(e.mesh.cdf[t] - (t ? e.mesh.cdf[t - 1] : 0)) *
               near_share(scene_, (corner[0] + corner[1] + corner[2]) / 3.0f);
    }
    e.power = std::max(close, 1e-12 * sum) * kPi;
  }
  return e;
}

// About the mean over what the lamp sends out, RGB averaged, seen from as far as the scene is
// large.
float Lights::mean_of_program(const Lamp& lamp) const {
  double sum = 0;
  float most = 0;
  for (uint32_t i = 0; i < kProbes; ++i) {
    PhotonStart start =
        PhotonEmitter(*this).emit_lamp(lamp, 0.75f, sobol_2d(i, 0, 0), sobol_2d(i, 1, 0));
    const float found =
        average(lamp_program(scene_, lamp, start.origin, start.direction,
                             lamp.s.kind == LampKind::kSun ? INFINITY : scene_.near_radius()));
    if (!std::isfinite(found)) continue;
    sum += found;
    most = std::max(most, found);
  }
  return std::max({static_cast<float>(sum / kProbes), kLeastShare * most, 1e-4f});
}

// All directions of the world times the discs that its light comes through.
void Lights::share_power() {
  for (Emitter& e : emitters_)
    if (e.parallel_flux > 0) e.power = e.parallel_flux * discs_.least_area();
  world_power_ = (scene_.world_seen_by & kScatteredRays) && !world_by_paths()
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

void Lights::place_lamps() {
  for (const Emitter& e : emitters_) {
    float radius2 = -1;  // rays that meet a mesh's light meet the mesh
    if (e.lamp >= 0) {
      const LampSettings& s = lamps_[e.lamp].s;
      radius2 = s.kind == LampKind::kSun    ? INFINITY
                : s.kind == LampKind::kArea ? 0.25f * sqr(e.bounds.diagonal())
                                            : sqr(s.radius);
    }
    near_lamps_.add(e.center, radius2);
  }
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

}  // namespace photon_splat
