#include "lights/mesh_light.h"

namespace photon_splat {
namespace {

constexpr double kProbeFloor = 0.02;
constexpr int kLooksInTime = 17;  // at where a triangle goes while the shutter is open

// How closely programs are asked what they emit. A mesh of few triangles is asked at several places
// of each, one of very many once for several that follow each other.
constexpr size_t kFewTriangles = 1 << 14, kMostAsked = 1 << 18;
constexpr size_t kAskedTogether = 1024;
constexpr size_t kSidesCompared = 64;  // places of a mesh: where both sides emit alike, all do

float probed(const Scene& scene, uint32_t instance, uint32_t triangle, int probes, bool back) {
  static constexpr float kProbes[4][2] = {
      {1 / 3.0f, 1 / 3.0f}, {0.15f, 0.15f}, {0.7f, 0.15f}, {0.15f, 0.7f}};
  float sum = 0;
  for (int i = 0; i < probes; ++i) {
    Surface s = scene.surface_at(instance, triangle, kProbes[i][0], kProbes[i][1], back);
    s.distance = scene.near_radius();
    sum += average(scene.emission(s, s.ng, {RayInfo::kEmission}));
  }
  return std::isfinite(sum) ? std::max(sum, 0.0f) / static_cast<float>(probes) : 0;
}

// About the means over triangles, RGB averaged; textures of plain materials count as white.
class MeanEmission {
 public:
  MeanEmission(const Scene& scene, ThreadPool* pool, uint32_t instance,
               const std::vector<EmissiveTriangle>& of)
      : scene_(scene),
        pool_(pool),
        instance_(instance),
        triangles_(of),
        probes_(of.size() > kFewTriangles ? 1 : 4),
        together_((of.size() + kMostAsked - 1) / kMostAsked) {
    front_.resize(of.size());
    back_.resize(of.size());
    fill(front_, false);
    const size_t step = of.size() / kSidesCompared + 1;
    for (size_t i = 0; i < of.size() && sides_alike_; i += step) {
      const float front = together_ == 1 ? front_[i] : ask(i, false);
      sides_alike_ = !program_of(i) || std::abs(ask(i, true) - front) <= kAlike * front;
    }
    fill(back_, true);
  }
  std::vector<float> take_front() { return std::move(front_); }
  std::vector<float> take_back() { return std::move(back_); }

 private:
  static constexpr float kAlike = 1e-4f;

  const Program* program_of(size_t i) const {
    const int program = scene_.materials[triangles_[i].material].program;
    return program < 0 ? nullptr : &scene_.programs[program];
  }
  float ask(size_t i, bool back) const {
    const Program* const program = program_of(i);
    const Material& m = scene_.materials[triangles_[i].material];
    if (!program) return average((back ? m.back : m.front).emission);
    const bool constant = program->features & kProgramConstantEmission;
    return probed(scene_, instance_, triangles_[i].triangle, constant ? 1 : probes_, back);
  }
  void fill(std::vector<float>& to, bool back) const {
    const auto fill_part = [&](size_t begin, size_t end) {
      for (size_t i = begin, asked = begin; i < end; ++i) {
        if (i == begin || i - asked >= together_ ||
            triangles_[i].material != triangles_[asked].material) {
          asked = i;
          to[i] = back && sides_alike_ && program_of(i) ? front_[i] : ask(i, back);
        } else {
          to[i] = to[asked];
        }
      }
    };
    if (pool_)
      pool_->for_parts(to.size(), kAskedTogether * together_, CancelFlag(), fill_part);
    else
      fill_part(0, to.size());
  }

  const Scene& scene_;
  ThreadPool* pool_;
  uint32_t instance_;
  const std::vector<EmissiveTriangle>& triangles_;
  int probes_;
  size_t together_;
  bool sides_alike_ = true;  // of programs
  std::vector<float> front_, back_;
};

}  // namespace

bool may_emit(const Scene& scene, const Material& m) {
  if (m.program >= 0) return scene.programs[m.program].features & kProgramEmits;
  return !is_black(m.front.emission) || !is_black(m.back.emission);
}

const EmissiveTriangle& triangle_at_time(const Scene& scene, uint32_t instance,
                                         const EmissiveTriangle& t, float time,
                                         EmissiveTriangle& moved) {
  if (!scene.moves(instance) || time == kShutterCentre) return t;
  moved = t;
  scene.corners(instance, t.triangle, time, moved.corner);
  const Vec3 rest = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]),
             now = cross(moved.corner[1] - moved.corner[0], moved.corner[2] - moved.corner[0]);
  const float area = std::max(length(now), 1e-37f);
  moved.normal = now / (scene.instances[instance].mirrored ? -area : area);
  moved.pdf = t.pdf * (length(rest) / area);
  return moved;
}

// Picks triangles by area times mean emission. What a program emits is probed at a few points;
// between them it may emit more, so that no triangle it covers gets less than a share of the mesh's
// mean.
MeshLight make_mesh_light(const Scene& scene, ThreadPool* pool, uint32_t instance, Bounds& bounds,
                          double& power) {
  MeshLight light;
  const uint32_t count =
      static_cast<uint32_t>(scene.meshes[scene.instances[instance].mesh].triangles.size());
  std::vector<float> areas;
  for (uint32_t t = 0; t < count; ++t) {
    const Material& m = scene.material_of(instance, t);
    if (!may_emit(scene, m)) continue;
    EmissiveTriangle out{};
    scene.corners(instance, t, kShutterCentre, out.corner);
    const Vec3 normal = cross(out.corner[1] - out.corner[0], out.corner[2] - out.corner[0]);
    const float twice_area = length(normal), area = 0.5f * twice_area;
    if (!(area > 0)) continue;
    for (const Vec3& p : out.corner) bounds.add(p);
    for (int i = 0; scene.moves(instance) && i < kLooksInTime; ++i) {
      Vec3 there[3];
      scene.corners(instance, t, static_cast<float>(i) / (kLooksInTime - 1), there);
      for (const Vec3& p : there) bounds.add(p);
    }
    out.normal = scene.instances[instance].mirrored ? -(normal / twice_area) : normal / twice_area;
    out.triangle = t;
    out.material = static_cast<uint32_t>(&m - scene.materials.data());
    light.triangles.push_back(out);
    areas.push_back(area);
  }
  MeanEmission means(scene, pool, instance, light.triangles);
  std::vector<float> front = means.take_front(), back = means.take_back();
  double probed_power = 0, probed_area = 0;
  for (size_t i = 0; i < areas.size(); ++i) {
    if (scene.materials[light.triangles[i].material].program < 0) continue;
    probed_power += double(areas[i]) * (front[i] + back[i]);
    probed_area += areas[i];
  }
  const float floor =
      probed_area > 0 ? static_cast<float>(kProbeFloor * probed_power / probed_area) : 0;
  for (size_t i = 0; i < areas.size(); ++i) {
    const int program = scene.materials[light.triangles[i].material].program;
    if (program >= 0 && !(scene.programs[program].features & kProgramConstantEmission)) {
      front[i] += floor;
      back[i] += floor;
    }
    const float weight = front[i] + back[i];
    light.triangles[i].front_share = weight > 0 ? front[i] / weight : 0.5f;
    light.cdf.push_back(static_cast<float>(power += double(areas[i]) * weight));
  }
  for (size_t i = 0; i < areas.size(); ++i) {
    const float share = std::max(light.cdf[i] - (i ? light.cdf[i - 1] : 0), 1e-37f);
    light.triangles[i].pdf = share / light.cdf.back() / std::max(areas[i], 1e-37f);
  }
  if (!(power > 0) || !std::isfinite(power)) return light;
  light.cdf_start.resize(light.cdf.size());
  for (size_t bucket = 0, i = 0; bucket < light.cdf_start.size(); ++bucket) {
    const float target =
        light.cdf.back() * static_cast<float>(bucket) / static_cast<float>(light.cdf_start.size());
    while (i + 1 < light.cdf.size() && light.cdf[i] <= target) ++i;
    light.cdf_start[bucket] = static_cast<uint32_t>(i);
  }
  return light;
}

bool sample_mesh_light(const Scene& scene, const MeshLight& mesh, uint32_t instance,
                       const Receiver& receiver, const Vec2& u, LightSample& out) {
  // The triangle is picked by the integer part of a stretched sample; the rest is used again.
  const float target = u.x * mesh.cdf.back();
  const size_t pick = mesh.triangle_at(target);
  const float low = pick ? mesh.cdf[pick - 1] : 0;
  const float share = mesh.cdf[pick] - low;
  if (!(share > 0)) return false;
  const float again = std::clamp((target - low) / share, 0.0f, 1.0f);
  EmissiveTriangle moved;
  const EmissiveTriangle& t =
      triangle_at_time(scene, instance, mesh.triangles[pick], receiver.time, moved);
  const float root = std::sqrt(again), b1 = root * (1 - u.y), b2 = root * u.y;
  const Vec3 point = t.corner[0] * (1 - root) + t.corner[1] * b1 + t.corner[2] * b2;

  const Vec3 to = point - receiver.x;
  const float d2 = length2(to);
  if (!(d2 > 0)) return false;
  out.distance = std::sqrt(d2);
  out.direction = to / out.distance;
  const float facing = dot(out.direction, t.normal), cosine = std::abs(facing);
  if (cosine <= 1e-7f) return false;
  out.pdf = t.pdf * d2 / cosine;
  const bool back = facing > 0;
  out.weight = emission_of(scene, instance, t, b1, b2, back, -out.direction, receiver.time,
                           static_cast<uint16_t>(receiver.bounces + 1), out.distance) /
               out.pdf;
  out.normal = back ? -t.normal : t.normal;
  out.rounding = scene.rounding_beyond(0, instance, t.triangle);
  return !is_black(out.weight);
}

MeshPoint MeshLight::point_at(const Scene& scene, uint32_t instance, float pick, const Vec2& place,
                              float time, EmissiveTriangle& moved) const {
  const float target = pick * cdf.back();
  const size_t i = triangle_at(target);
  MeshPoint p;
  p.triangle = &triangle_at_time(scene, instance, triangles[i], time, moved);
  p.side = side_of(i, target);
  const float root = std::sqrt(place.x);
  p.u = root * (1 - place.y);
  p.v = root * place.y;
  const Vec3* corner = p.triangle->corner;
  p.position = corner[0] * (1 - root) + corner[1] * p.u + corner[2] * p.v;
  return p;
}

float start_offset(const Scene& scene, uint32_t instance, const EmissiveTriangle& t,
                   const Vec3& x) {
  return std::max(ray_epsilon(x, 0), scene.rounding_beyond(0, instance, t.triangle));
}

PhotonStart emit_mesh_light(const Scene& scene, const MeshLight& mesh, uint32_t instance,
                            float pick, const Vec2& place, const Vec2& way, float time) {
  EmissiveTriangle moved;
  const MeshPoint p = mesh.point_at(scene, instance, pick, place, time, moved);
  const EmissiveTriangle& t = *p.triangle;
  const bool on_back = p.side >= t.front_share;
  const Vec3 normal = on_back ? -t.normal : t.normal;
  PhotonStart start;
  start.origin = p.position + normal * start_offset(scene, instance, t, p.position);
  start.direction = Basis(normal).to_world(sample_cosine_hemisphere(way));
  start.power = emission_of(scene, instance, t, p.u, p.v, on_back, start.direction, time) *
                (kPi / (t.pdf * (on_back ? 1 - t.front_share : t.front_share)));
  return start;
}

}  // namespace photon_splat
