// Where moving things of a scene are at a time, and where their points are at the shutter's centre.
#include <bit>
#include <span>

#include "scene/scene.h"

namespace photon_splat {
namespace {

// Between what steps hold of a mesh, whose own is `middle`: of element `i`.
Vec3 between(const std::vector<LargeArray<Vec3>>& steps, std::span<const Vec3> middle, size_t i,
             float time) {
  const auto [first, share] = motion_step(steps.size(), time);
  const auto at = [&](size_t step) {
    return step == steps.size() / 2 ? middle[i] : steps[step][i];
  };
  return at(first) * (1 - share) + at(first + 1) * share;
}

constexpr int kLooksInTime = 17;  // at where an instance goes while the shutter is open
constexpr float kNear = 1;        // radii of a moving thing: so near it changes light with the time

// Bounds of a mesh at all of its steps, in its own coordinates.
Bounds bounds_of(const Mesh& mesh) {
  if (mesh.strands) return mesh.strands->bounds();
  Bounds all;
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t vertex : t) {
      all.add(mesh.positions[vertex]);
      for (const LargeArray<Vec3>& step : mesh.motion.positions)
        if (!step.empty()) all.add(step[vertex]);
    }
  return all;
}

}  // namespace

Vec3 Mesh::position(uint32_t vertex, float time) const {
  if (!motion.steps()) return positions[vertex];
  return between(motion.positions, positions, vertex, time);
}

const Vec3* Mesh::normals(uint32_t triangle, float time, Vec3 made[3]) const {
  if (motion.corner_normals.empty()) return normals(triangle, made);
  const size_t first = 3 * static_cast<size_t>(triangle);
  for (size_t i = 0; i < 3; ++i)
    made[i] = between(motion.corner_normals, corner_normals, first + i, time);
  return made;
}

void Mesh::spread_normals(ThreadPool& pool) {
  if (vertex_normals.empty()) return;
  LargeArray<Vec3> spread(3 * triangles.size());
  pool.for_parts(triangles.size(), 1 << 15, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t)
      for (size_t k = 0; k < 3; ++k) spread[3 * t + k] = vertex_normals[triangles[t][k]];
  });
  corner_normals = std::move(spread);
  vertex_normals = {};
}

void Scene::find_moving() {
  moves_ = strands_ = false;
  for (Instance& instance : instances) {
    const Mesh& mesh = meshes[instance.mesh];
    instance.moves =
        instance.motion >= 0 || mesh.motion.steps() > 0 || (mesh.strands && mesh.strands->moves());
    moves_ |= instance.moves;
    strands_ |= mesh.strands != nullptr;
  }
}

void Scene::find_swept() {
  swept_.reset();
  if (!moves_) return;
  std::vector<Bounds> boxes, of_meshes(meshes.size());
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const Instance& instance = instances[i];
    if (!instance.moves) continue;
    Bounds& own = of_meshes[instance.mesh];
    if (own.empty()) own = bounds_of(meshes[instance.mesh]);
    if (own.empty()) continue;
    Bounds swept;
    float radius = 0;
    const int looks = instance.motion < 0 ? 1 : kLooksInTime;
    for (int look = 0; look < looks; ++look) {
      const float time =
          looks > 1 ? static_cast<float>(look) / static_cast<float>(looks - 1) : kShutterCentre;
      const Affine to_world = pose_at(i, time).to_world;
      Bounds there;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p{corner & 1 ? own.upper.x : own.lower.x, corner & 2 ? own.upper.y : own.lower.y,
                     corner & 4 ? own.upper.z : own.lower.z};
        there.add(instance.shared ? to_world.point(p) : p);
      }
      radius = std::max(radius, 0.5f * there.diagonal());
      swept.add(there);
    }
    const Vec3 margin = Vec3{1, 1, 1} * (kNear * radius);
    swept.add(Bounds{swept.lower - margin, swept.upper + margin});
    boxes.push_back(swept);
  }
  swept_ = std::make_unique<SweptBoxes>(std::move(boxes));
}

RayMask Scene::mask_of(const Instance& instance) const {
  const bool still = !instance.moves && !meshes[instance.mesh].strands &&
                     instance.seen_by & ray_bit(RayInfo::kDiffuse);
  const RayMask mask = still ? instance.seen_by | kStillRays : instance.seen_by & ~kStillRays;
  if (!catchers_) return mask;
  return (mask & ~kCatcherRays) | (instance.catcher ? mask << kCatcherShift & kCatcherRays : 0);
}

unsigned Scene::still(const RayHits& hits, unsigned which) const {
  for (unsigned rest = which; rest; rest &= rest - 1) {
    const uint32_t k = static_cast<uint32_t>(std::countr_zero(rest));
    if (instances[hits.instance[k]].moves) which &= ~(1u << k);
  }
  return which;
}

Pose Scene::pose_at(uint32_t index, float time) const {
  const Instance& instance = instances[index];
  if (instance.motion < 0 || time == kShutterCentre) return {instance.to_world, instance.to_local};
  const Affine to_world = motions[instance.motion].at(time);
  // A flattened instance has no inverse, and nothing of it is seen
  const bool flat = !(std::abs(determinant(to_world)) > 0);
  return {to_world, flat ? instance.to_local : inverse(to_world)};
}

void Scene::corners(uint32_t index, uint32_t triangle, float time, Vec3 corner[3]) const {
  const Instance& instance = instances[index];
  const Mesh& mesh = meshes[instance.mesh];
  const Triangle& t = mesh.triangles[triangle];
  if (!moves(index)) {
    for (int i = 0; i < 3; ++i)
      corner[i] =
          instance.shared ? instance.to_world.point(mesh.positions[t[i]]) : mesh.positions[t[i]];
    return;
  }
  const Affine to_world = pose_at(index, time).to_world;
  for (int i = 0; i < 3; ++i) {
    const Vec3 p = mesh.position(t[i], time);
    corner[i] = instance.shared ? to_world.point(p) : p;
  }
}

Vec3 Scene::moving_normal(uint32_t index, uint32_t triangle, float u, float v, float time) const {
  const Instance& instance = instances[index];
  const Mesh& mesh = meshes[instance.mesh];
  if (!mesh.is_smooth()) return {};
  Vec3 moved[3];
  const Vec3* n = mesh.normals(triangle, time, moved);
  Vec3 ns = n[0] * (1 - u - v) + n[1] * u + n[2] * v;
  if (mesh.motion.steps() && mesh.motion.corner_normals.empty()) {
    Vec3 rest[3], now[3];
    for (int i = 0; i < 3; ++i) {
      rest[i] = mesh.positions[mesh.triangles[triangle][i]];
      now[i] = mesh.position(mesh.triangles[triangle][i], time);
    }
    const Turn turn(rest, now);
    ns = turn(ns);
  }
  return instance.shared ? pose_at(index, time).to_local.transposed_vector(ns) : ns;
}

Surface Scene::moving_surface_at(uint32_t index, uint32_t triangle, float u, float v, bool back,
                                 float time) const {
  Vec3 c[3];
  corners(index, triangle, time, c);
  const Vec3 ab = c[1] - c[0], ac = c[2] - c[0];
  Vec3 front = normalize(cross(ab, ac));
  if (instances[index].mirrored) front = -front;
  Surface s;
  fill_surface({index, triangle, u, v, 0, c[0] + ab * u + ac * v, front, time},
               back ? front : -front, s);
  return s;
}

PlaceAtRest Scene::at_rest(const Surface& s, float time) const {
  Vec3 now[3], rest[3];
  corners(s.instance, s.triangle, time, now);
  corners(s.instance, s.triangle, kShutterCentre, rest);
  const Turn turn(now, rest);
  const float area_now = length(cross(now[1] - now[0], now[2] - now[0])),
              area_rest = length(cross(rest[1] - rest[0], rest[2] - rest[0]));
  return {rest[0] * (1 - s.u - s.v) + rest[1] * s.u + rest[2] * s.v, turn(s.ng),
          area_now > 0 ? area_rest / area_now : 0, turn};
}

}  // namespace photon_splat
