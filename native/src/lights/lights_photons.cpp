// Setting light sources up, and starting photons from them in proportion to power.
#include <stdexcept>

#include "lights/lights.h"
#include "math/random_streams.h"
#include "math/table.h"

namespace photon_splat {
namespace {

constexpr size_t kGuideCells = 1 << 20;
constexpr float kSmallestSpread = 0.1f * kPi / 180;
constexpr float kHugeScene = 1000, kStartsAt = 16;  // times the width of a disc

Vec3 around_axis(const Vec3& x, const Vec3& y, const Vec3& z, float cosine, float turn) {
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
  const Vec2 around = cos_sin_of_turn(turn);
  return x * (sine * around.x) + y * (sine * around.y) + z * cosine;
}

}  // namespace

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

}  // namespace

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
  if (settings.program >= 0) lamp.place = {m, inverse(m)};

  Emitter e;
  e.lamp = static_cast<int>(lamps_.size());
  e.center = lamp.center;
  const Rgb strength = settings.strength;
  switch (settings.kind) {
    case LampKind::kPoint:
    case LampKind::kSpot: {
      // Blender's watts are spread over all directions: I = P / (4 pi); without `normalize` L = P /
      // pi.
      const float r = settings.radius, disc = kPi * r * r;
      lamp.intensity =
          settings.normalize ? strength / (4 * kPi) : strength * ((r > 0 ? disc : 1.0f) / kPi);
      if (r > 0) lamp.radiance = lamp.intensity / disc;
      const bool crowded = r > 0 && scene_.anything_within(lamp.center, r);
      lamp.holds_geometry = crowded && !settings.soft_falloff;
      lamp.faces_geometry = crowded && settings.soft_falloff;
      float share = 4 * kPi;
      if (lamp.s.kind == LampKind::kSpot) {
        lamp.cos_half = std::cos(0.5f * std::clamp(settings.spot_size, 0.0f, kPi));
        lamp.inverse_smooth = 1 / std::max((1 - lamp.cos_half) * settings.spot_blend, 1e-6f);
        if (!(lamp.cos_half < 1)) return;
        lamp.angle_low = lamp.cos_half;
        lamp.angle_cdf = tabulate(lamp.angle_low, 1.0f, [&](float c) {
          const float t = std::clamp((c - lamp.cos_half) * lamp.inverse_smooth, 0.0f, 1.0f);
          return t * t * (3 - 2 * t);
        });
        share = 2 * kPi * lamp.angle_cdf.back();
      }
      e.radius = r;
      e.importance = average(lamp.intensity);
      e.power = average(lamp.intensity) * share;
      break;
    }
    case LampKind::kSun: {
      const float half = 0.5f * std::clamp(settings.angle, 0.0f, kPi), sine = std::sin(half);
      lamp.one_minus_cos = 2 * std::sin(0.5f * half) * std::sin(0.5f * half);
      lamp.intensity = strength;
      if (lamp.one_minus_cos > 0)
        lamp.radiance = settings.normalize ? strength / (kPi * sine * sine) : strength;
      const Rgb through_disc =
          lamp.one_minus_cos > 0 ? lamp.radiance * (2 * kPi * lamp.one_minus_cos) : strength;
      e.importance = average(through_disc);
      e.parallel_flux = average(through_disc);
      e.power = e.parallel_flux * discs_.least_area();
      break;
    }
    case LampKind::kArea: {
      lamp.half_x = 0.5f * settings.size_x * lamp.scale_x;
      lamp.half_y = 0.5f * settings.size_y * lamp.scale_y;
      lamp.area = 4 * lamp.half_x * lamp.half_y * (settings.ellipse ? kPi / 4 : 1.0f);
      if (!(lamp.area > 0)) return;  // Blender's area light of size 0 emits nothing
      const Vec3 plane = cross(lamp.axis_x, lamp.axis_y);
      if (!(length(plane) > 0)) return;
      lamp.forward = normalize(plane) * std::copysign(1.0f, dot(plane, lamp.forward));
      lamp.radiance = settings.normalize ? strength / (kPi * lamp.area) : strength / kPi;
      const float half_spread = 0.5f * std::clamp(settings.spread, kSmallestSpread, kPi);
      float sin2_max = 1;
      if (half_spread < 0.5f * kPi - 1e-4f) {
        lamp.tan_half_spread = std::tan(half_spread);
        // tan(h) - h by its series where the difference would cancel.
        const float h3 = half_spread * half_spread * half_spread;
        const float excess = half_spread < 0.05f ? h3 / 3 + 2 * h3 * half_spread * half_spread / 15
                                                 : lamp.tan_half_spread - half_spread;
        lamp.normalize_spread = 1 / excess;
        const float sine = std::sin(half_spread);
        sin2_max = sine * sine;
        lamp.angle_high = sin2_max;
        lamp.angle_cdf = tabulate(0.0f, sin2_max, [&](float s2) {
          return spread_attenuation(lamp, std::sqrt(s2 / (1 - s2)));
        });
      }
      const float share = lamp.angle_cdf.empty() ? 1.0f : lamp.angle_cdf.back();
      e.radius = std::sqrt(lamp.half_x * lamp.half_x + lamp.half_y * lamp.half_y);
      e.importance = average(lamp.radiance) * lamp.area;
      e.power = average(lamp.radiance) * double(lamp.area) * kPi * share;
      break;
    }
  }
  if (settings.program >= 0) {
    const float mean = mean_shade(lamp);
    e.importance *= mean;
    e.power *= mean;
  }
  if (settings.kind != LampKind::kSun) e.power *= near_share(lamp.center);
  if (!(e.power > 0)) return;
  e.lit_groups = settings.lit_groups;
  e.blockers = settings.blockers;
  e.light_group = settings.light_group;
  e.seen_by = as_scattered(settings.seen_by);
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

namespace {

constexpr double kProbeFloor = 0.02;

bool may_emit(const Scene& scene, const Material& m) {
  if (m.program >= 0) return scene.programs[m.program].features & kProgramEmits;
  return !is_black(m.front.emission) || !is_black(m.back.emission);
}

// About the mean over the triangle, RGB averaged; textures of plain materials count as white.
float mean_emission(const Scene& scene, const Material& m, uint32_t instance, uint32_t triangle,
                    bool back) {
  if (m.program < 0) return average((back ? m.back : m.front).emission);
  static constexpr float kProbes[4][2] = {
      {1 / 3.0f, 1 / 3.0f}, {0.15f, 0.15f}, {0.7f, 0.15f}, {0.15f, 0.7f}};
  const int probes = scene.programs[m.program].features & kProgramConstantEmission ? 1 : 4;
  float sum = 0;
  for (int i = 0; i < probes; ++i) {
    const Surface s = scene.surface_at(instance, triangle, kProbes[i][0], kProbes[i][1], back);
    sum += average(scene.emission(s, s.ng, {RayInfo::kEmission}));
  }
  return std::isfinite(sum) ? std::max(sum, 0.0f) / static_cast<float>(probes) : 0;
}

}  // namespace

void Lights::add_emissive_instances() {
  emitter_of_instance_.assign(scene_.instances.size(), -1);
  for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
    const Instance& instance = scene_.instances[i];
    bool emissive = false;
    for (uint32_t s = 0; s < instance.slot_count; ++s)
      emissive |=
          may_emit(scene_, scene_.materials[scene_.slot_materials[instance.first_material + s]]);
    if (!emissive || !(instance.seen_by & kScatteredRays)) continue;
    Emitter e;
    e.instance = i;
    e.lit_groups = instance.lit_groups;
    e.blockers = instance.blockers;
    e.light_group = instance.light_group;
    e.seen_by = as_scattered(instance.seen_by);
    Bounds bounds;
    double sum = 0;
    add_emissive_triangles(i, e, bounds, sum);
    if (!(sum > 0) || !std::isfinite(sum)) continue;
    e.cdf_start.resize(e.cdf.size());
    for (size_t bucket = 0, i = 0; bucket < e.cdf_start.size(); ++bucket) {
      const float target =
          e.cdf.back() * static_cast<float>(bucket) / static_cast<float>(e.cdf_start.size());
      while (i + 1 < e.cdf.size() && e.cdf[i] <= target) ++i;
      e.cdf_start[bucket] = static_cast<uint32_t>(i);
    }
    e.center = bounds.center();
    e.radius = 0.5f * bounds.diagonal();
    e.bounds = bounds;
    e.importance = static_cast<float>(sum);
    e.power = sum * kPi;
    if (scene_.has_far_things()) {
      double close = 0;
      for (size_t t = 0; t < e.cdf.size(); ++t) {
        const Vec3* corner = e.triangles[t].corner;
        close += double(e.cdf[t] - (t ? e.cdf[t - 1] : 0)) *
                 near_share((corner[0] + corner[1] + corner[2]) / 3.0f);
      }
      e.power = std::max(close, 1e-12 * sum) * kPi;
    }
    emitter_of_instance_[i] = static_cast<int32_t>(emitters_.size());
    emitters_.push_back(std::move(e));
  }
}

// Picks triangles by area times mean emission. What a program emits is probed at a few points;
// between them it may emit more, so that no triangle it covers gets less than a share of the mesh's
// mean.
void Lights::add_emissive_triangles(uint32_t instance, Emitter& e, Bounds& bounds,
                                    double& sum) const {
  const uint32_t count =
      static_cast<uint32_t>(scene_.meshes[scene_.instances[instance].mesh].triangles.size());
  std::vector<float> areas, front, back;
  double probed_power = 0, probed_area = 0;
  for (uint32_t t = 0; t < count; ++t) {
    const Material& m = scene_.material_of(instance, t);
    if (!may_emit(scene_, m)) continue;
    EmissiveTriangle out{};
    triangle_corners(instance, t, out.corner);
    const Vec3 normal = cross(out.corner[1] - out.corner[0], out.corner[2] - out.corner[0]);
    const float twice_area = length(normal), area = 0.5f * twice_area;
    if (!(area > 0)) continue;
    for (const Vec3& p : out.corner) bounds.add(p);
    out.normal = scene_.instances[instance].mirrored ? -(normal / twice_area) : normal / twice_area;
    out.triangle = t;
    out.material = static_cast<uint32_t>(&m - scene_.materials.data());
    e.triangles.push_back(out);
    areas.push_back(area);
    front.push_back(mean_emission(scene_, m, instance, t, false));
    back.push_back(mean_emission(scene_, m, instance, t, true));
    if (m.program < 0) continue;
    probed_power += double(area) * (front.back() + back.back());
    probed_area += area;
  }
  const float floor =
      probed_area > 0 ? static_cast<float>(kProbeFloor * probed_power / probed_area) : 0;
  for (size_t i = 0; i < areas.size(); ++i) {
    const int program = scene_.materials[e.triangles[i].material].program;
    if (program >= 0 && !(scene_.programs[program].features & kProgramConstantEmission)) {
      front[i] += floor;
      back[i] += floor;
    }
    const float weight = front[i] + back[i];
    e.triangles[i].front_share = weight > 0 ? front[i] / weight : 0.5f;
    e.cdf.push_back(static_cast<float>(sum += double(areas[i]) * weight));
  }
  for (size_t i = 0; i < areas.size(); ++i) {
    const float share = std::max(e.cdf[i] - (i ? e.cdf[i - 1] : 0), 1e-37f);
    e.triangles[i].pdf = share / e.cdf.back() / std::max(areas[i], 1e-37f);
  }
}

// From far outside of a scene that is huge against what is seen nothing could be hit precisely:
// unless something far off stands in the way, the path starts nearer.
Vec3 Lights::parallel_origin(const Vec3& direction, const Vec3& through, const Vec3& outside,
                             float width) const {
  if (!discs_.focused() || discs_.radius() < kHugeScene * width) return outside;
  const Vec3 near = through - direction * (kStartsAt * width);
  return scene_.occluded(near, -direction, 0, INFINITY) ? outside : near;
}

PhotonStart Lights::emit_parallel(const Vec3& direction, const Vec2& place) const {
  const EmissionDiscs::Place from = discs_.sample(direction, place);
  PhotonStart start;
  start.origin = parallel_origin(direction, from.through, from.outside, from.width);
  start.direction = direction;
  const float area = discs_.area(direction, from.through);
  start.power = {area, area, area};
  return start;
}

PhotonStart Lights::emit_world(const Vec2& place, const Vec2& way) const {
  const Environment::Sample s = environment_.sample(way);
  PhotonStart start = emit_parallel(-s.direction, place);
  start.power *= s.pdf > 0 ? environment_.radiance(s.direction) / s.pdf : Rgb{};
  start.asks_ray = environment_.asks_ray();
  return start;
}

PhotonStart Lights::emit_lamp(const Lamp& lamp, float coin, const Vec2& place,
                              const Vec2& way) const {
  if (lamp.s.kind == LampKind::kSun) {
    PhotonStart start =
        emit_parallel(Basis(lamp.forward).to_world(sample_cone(way, lamp.one_minus_cos)), place);
    start.power *=
        lamp.one_minus_cos > 0 ? lamp.radiance * (2 * kPi * lamp.one_minus_cos) : lamp.intensity;
    return start;
  }
  PhotonStart start;
  if (lamp.s.kind == LampKind::kArea) {
    Vec2 p{2 * place.x - 1, 2 * place.y - 1};
    if (lamp.s.ellipse) p = sample_disk(place);
    start.origin =
        lamp.center + lamp.axis_x * (p.x * lamp.half_x) + lamp.axis_y * (p.y * lamp.half_y);
    float sin2 = way.x, pdf = 1;  // of sin^2: cosine-weighted directions are uniform in it
    if (!lamp.angle_cdf.empty()) {
      const TableSample s = sample_table(lamp.angle_cdf, 0, lamp.angle_high, way.x);
      sin2 = s.value;
      pdf = s.pdf;
    }
    const float cosine = std::sqrt(std::max(0.0f, 1 - sin2));
    const Basis basis(lamp.forward);
    start.direction = around_axis(basis.tangent, basis.bitangent, basis.normal, cosine, way.y);
    start.power = lamp.radiance *
                  (lamp.area * kPi *
                   spread_attenuation(lamp, std::sqrt(sin2 / std::max(1 - sin2, 1e-12f))) / pdf);
    return start;
  }
  // Point and spot: lines of uniform density that pass the centre within the radius.
  if (lamp.s.kind == LampKind::kPoint) {
    start.direction = sample_sphere(way);
    start.power = lamp.intensity * (4 * kPi);
  } else {
    const TableSample s = sample_table(lamp.angle_cdf, lamp.angle_low, 1, way.x);
    const float t = std::clamp((s.value - lamp.cos_half) * lamp.inverse_smooth, 0.0f, 1.0f);
    const Vec3 local = around_axis({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, s.value, way.y);
    const Vec3 scaled{local.x * lamp.scale_x, local.y * lamp.scale_y, local.z * lamp.scale_z};
    const float len = length(scaled);
    const float jacobian = lamp.scale_x * lamp.scale_y * lamp.scale_z / (len * len * len);
    start.direction =
        normalize(lamp.axis_x * scaled.x + lamp.axis_y * scaled.y + lamp.forward * scaled.z);
    start.power = lamp.intensity * (2 * kPi * t * t * (3 - 2 * t) * jacobian / s.pdf);
  }
  // A spherical spot's cone holds outside it alone: inside it is a point lamp.
  if (lamp.s.kind == LampKind::kSpot && lamp.holds_geometry && coin < 0.5f)
    start.direction = sample_sphere(way);
  start.origin = lamp.center;
  const float r = lamp.s.radius;
  if (r > 0) {
    const Vec2 p = sample_disk(place);
    const float half = r * std::sqrt(std::max(0.0f, 1 - p.x * p.x - p.y * p.y));
    const float ahead = !lamp.s.soft_falloff ? half : lamp.faces_geometry ? -half : 0;
    // What stands inside a spherical lamp is lit by its far wall and does not shadow what is
    // outside: either photons.
    const bool inside = lamp.holds_geometry && coin < 0.5f;
    start.origin += Basis(start.direction).to_world({p.x * r, p.y * r, inside ? -ahead : ahead});
    if (inside) {
      start.first_hit_to = 2 * ahead;
      if (lamp.s.kind == LampKind::kSpot) start.power = lamp.intensity * (4 * kPi);
    }
    if (lamp.holds_geometry) start.power *= 2;
    if (lamp.s.soft_falloff) {
      start.soft_radius2 = r * r;
      start.soft_miss2 = (p.x * p.x + p.y * p.y) * r * r;
      start.soft_nearest = -ahead;
    }
  }
  return start;
}

Lights::MeshPoint Lights::point_on_mesh(const Emitter& e, float pick, const Vec2& place) const {
  const float target = pick * e.cdf.back();
  const size_t i = e.triangle_at(target);
  MeshPoint p;
  p.triangle = &e.triangles[i];
  p.side = side_of(e, i, target);
  const float root = std::sqrt(place.x);
  p.u = root * (1 - place.y);
  p.v = root * place.y;
  const Vec3* corner = p.triangle->corner;
  p.position = corner[0] * (1 - root) + corner[1] * p.u + corner[2] * p.v;
  return p;
}

PhotonStart Lights::emit_mesh(const Emitter& e, float pick, const Vec2& place,
                              const Vec2& way) const {
  const MeshPoint p = point_on_mesh(e, pick, place);
  const EmissiveTriangle& t = *p.triangle;
  const bool on_back = p.side >= t.front_share;
  const Vec3 normal = on_back ? -t.normal : t.normal;
  PhotonStart start;
  start.origin = p.position + normal * ray_epsilon(p.position, 0);
  start.direction = Basis(normal).to_world(sample_cosine_hemisphere(way));
  start.power = emission_of(e, t, p.u, p.v, on_back, start.direction) *
                (kPi / (t.pdf * (on_back ? 1 - t.front_share : t.front_share)));
  return start;
}

void Lights::primaries(uint64_t first, uint32_t count, uint32_t seed, const EmissionGuide* guide,
                       EmissionPrimary* out) const {
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
  for (uint32_t i = 0; i < count; ++i) {
    EmissionPrimary& p = out[i] = {0, pick[i], place[i], way[i]};
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

PhotonStart Lights::emit(const EmissionPrimary& p) const {
  const bool parallel = p.emitter == emitters_.size() || emitters_[p.emitter].parallel_flux > 0;
  if (scene_.has_far_things() && !parallel) return emit_nearby(p);
  PhotonStart start;
  if (p.emitter == emitters_.size()) {
    start = emit_world(p.place, p.way);
  } else {
    const Emitter& e = emitters_[p.emitter];
    start = e.lamp >= 0 ? emit_lamp(lamps_[e.lamp], p.pick.y, p.place, p.way)
                        : emit_mesh(e, p.pick.y, p.place, p.way);
  }
  return finished(start, p);
}

EmissionGuide Lights::make_guide() const {
  // Of many emitters each gets fewer cells: 4096, 256, 16 or 1.
  int fine = 8;
  while (fine > 1 && emitters_.size() * fine * fine * fine * fine > kGuideCells) fine /= 2;
  const auto divided = [fine](bool by_place, bool by_way) {
    return EmissionGuide::Division{by_place ? fine * fine
                                   : by_way ? 1
                                            : fine,
                                   by_way     ? fine * fine
                                   : by_place ? 1
                                              : fine};
  };
  std::vector<double> powers;
  std::vector<EmissionGuide::Division> divisions;
  for (const Emitter& e : emitters_) {
    powers.push_back(e.power);
    const LampKind kind = e.lamp >= 0 ? lamps_[e.lamp].s.kind : LampKind::kArea;
    divisions.push_back(
        divided(kind == LampKind::kSun, kind == LampKind::kPoint || kind == LampKind::kSpot));
  }
  powers.push_back(world_power_);
  divisions.push_back(divided(false, false));
  return EmissionGuide(std::move(powers), std::move(divisions));
}

}  // namespace photon_splat
