#include "lights/mesh_light.h"

namespace photon_splat {
namespace {

constexpr double kProbeFloor = 0.02;
constexpr int kLooksInTime = 17;  // at where a triangle goes while the shutter is open

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
MeshLight make_mesh_light(const Scene& scene, uint32_t instance, Bounds& bounds, double& power) {
  MeshLight light;
  const uint32_t count =
      static_cast<uint32_t>(scene.meshes[scene.instances[instance].mesh].triangles.size());
  std::vector<float> areas, front, back;
  double probed_power = 0, probed_area = 0;
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
    front.push_back(mean_emission(scene, m, instance, t, false));
    back.push_back(mean_emission(scene, m, instance, t, true));
    if (m.program < 0) continue;
    probed_power += double(area) * (front.back() + back.back());
    probed_area += area;
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
                           static_cast<uint16_t>(receiver.bounces + 1)) /
               out.pdf;
  out.normal = back ? -t.normal : t.normal;
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

PhotonStart emit_mesh_light(const Scene& scene, const MeshLight& mesh, uint32_t instance,
                            float pick, const Vec2& place, const Vec2& way, float time) {
  EmissiveTriangle moved;
  const MeshPoint p = mesh.point_at(scene, instance, pick, place, time, moved);
  const EmissiveTriangle& t = *p.triangle;
  const bool on_back = p.side >= t.front_share;
  const Vec3 normal = on_back ? -t.normal : t.normal;
  PhotonStart start;
  start.origin = p.position + normal * ray_epsilon(p.position, 0);
  start.direction = Basis(normal).to_world(sample_cosine_hemisphere(way));
  start.power = emission_of(scene, instance, t, p.u, p.v, on_back, start.direction, time) *
                (kPi / (t.pdf * (on_back ? 1 - t.front_share : t.front_share)));
  return start;
}

}  // namespace photon_splat
