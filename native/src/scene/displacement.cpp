#include "scene/displacement.h"

#include <atomic>

namespace photon_splat {
namespace {

constexpr uint32_t kNobody = ~0u;

Vec3 unit_or_zero(const Vec3& v) {
  const float l = length(v);
  return l > 0 && std::isfinite(l) ? v * (1.0f / l) : Vec3{};
}

class Displacer {
 public:
  Displacer(Scene& scene, uint32_t instance, const std::vector<SlotDisplacement>& slots,
            const std::vector<bool>& smooth)
      : scene_(scene),
        instance_(scene.instances[instance]),
        mesh_(scene.meshes[instance_.mesh]),
        index_(instance),
        slots_(slots),
        smooth_(smooth) {}

  void move_vertices(DisplacedMesh& out, const CancelFlag& cancel) const {
    const size_t vertices = mesh_.positions.size() - 1;
    std::vector<uint32_t> asker(vertices, kNobody);
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (slot(t).program < 0) continue;
      for (uint32_t k = 0; k < 3; ++k) {
        uint32_t& known = asker[mesh_.triangles[t][k]];
        if (known == kNobody) known = 3 * t + k;
      }
    }
    out.positions.assign(mesh_.positions.begin(), mesh_.positions.end() - 1);
    std::atomic<size_t> not_finite{0};
    scene_.pool().for_parts(vertices, 1 << 10, cancel, [&](size_t begin, size_t end) {
      std::vector<float> registers;
      for (size_t v = begin; v < end; ++v) {
        if (asker[v] == kNobody) continue;
        const Vec3 moved = out.positions[v] + offset(asker[v], registers);
        if (is_finite(moved))
          out.positions[v] = moved;
        else
          ++not_finite;
      }
    });
    out.not_finite = not_finite;
  }

  // Where all is smooth corners at a vertex agree; false where some vertex has no normal then.
  bool bend_vertices(DisplacedMesh& out) const {
    out.vertex_normals = renewed(out);
    for (size_t v = 0; v < out.vertex_normals.size(); ++v) {
      Vec3& n = out.vertex_normals[v];
      if (!(length2(n) > 0)) n = mesh_.vertex_normals[v];
      if (!(length2(n) > 0)) return out.vertex_normals = {}, false;
    }
    return true;
  }

  void bend_normals(DisplacedMesh& out, bool own_corners) const {
    if (own_corners)
      keep_differences(out);
    else
      renew_vertices(out);
  }

  bool is_flat() const {
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (is_smooth(t) || slot(t).bumps) return false;
    return true;
  }

 private:
  const SlotDisplacement& slot(uint32_t triangle) const {
    const uint32_t slot = mesh_.slots.empty() ? 0 : mesh_.slots[triangle];
    return slots_[std::min<size_t>(slot, slots_.size() - 1)];
  }
  bool is_smooth(uint32_t triangle) const { return smooth_.empty() || smooth_[triangle]; }

  template <class Positions>
  Vec3 face_normal(const Positions& positions, uint32_t triangle) const {
    const Triangle& t = mesh_.triangles[triangle];
    const Vec3 a = positions[t[0]];
    return unit_or_zero(cross(positions[t[1]] - a, positions[t[2]] - a));
  }

  // In the mesh's coordinates.
  Vec3 offset(uint32_t corner, std::vector<float>& registers) const {
    const uint32_t triangle = corner / 3, k = corner % 3;
    const Affine& to_local = instance_.to_local;
    ShadingPoint vertex;
    Vec3 made[3];
    vertex.position = instance_.to_world.point(mesh_.positions[mesh_.triangles[triangle][k]]);
    vertex.ng = unit_or_zero(to_local.transposed_vector(face_normal(mesh_.positions, triangle)));
    vertex.ns = unit_or_zero(to_local.transposed_vector(mesh_.normals(triangle, made)[k]));
    if (length2(vertex.ns) == 0) vertex.ns = vertex.ng;
    vertex.instance = index_;
    vertex.triangle = triangle;
    vertex.u = k == 1 ? 1.0f : 0.0f;
    vertex.v = k == 2 ? 1.0f : 0.0f;
    const Program& program = scene_.programs[static_cast<size_t>(slot(triangle).program)];
    return to_local.vector(run_displacement(scene_, program, vertex, registers));
  }

  // Mean of the faces' normals at each vertex, of those that `counts` names. Cycles weights them
  // neither by area nor by angle.
  template <class Positions, class Counts>
  std::vector<Vec3> vertex_normals(const Positions& positions, Counts&& counts) const {
    std::vector<Vec3> sums(mesh_.positions.size() - 1);
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (!counts(t)) continue;
      const Vec3 n = face_normal(positions, t);
      for (uint32_t v : mesh_.triangles[t]) sums[v] += n;
    }
    for (Vec3& n : sums) n = unit_or_zero(n);
    return sums;
  }

  // Sets the normal of each corner: that of the face where it is flat and has no bump, else what
  // `normal` says.
  template <class Normal>
  void set_normals(DisplacedMesh& out, Normal&& normal) const {
    out.corner_normals.assign(mesh_.corner_normals.begin(), mesh_.corner_normals.end());
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (slot(t).bumps) continue;
      const Vec3 face = face_normal(out.positions, t);
      for (uint32_t k = 0; k < 3; ++k) {
        Vec3& n = out.corner_normals[3 * t + k];
        const Vec3 bent = is_smooth(t) ? normal(t, mesh_.triangles[t][k], n) : face;
        n = length2(bent) > 0 ? bent : face;
      }
    }
  }

  std::vector<Vec3> renewed(const DisplacedMesh& out) const {
    return vertex_normals(out.positions,
                          [&](uint32_t t) { return slot(t).program >= 0 && !slot(t).bumps; });
  }

  void renew_vertices(DisplacedMesh& out) const {
    const std::vector<Vec3> normals = renewed(out);
    set_normals(out, [&](uint32_t, uint32_t vertex, const Vec3& before) {
      return length2(normals[vertex]) > 0 ? normals[vertex] : before;
    });
  }

  void keep_differences(DisplacedMesh& out) const {
    const auto all = [](uint32_t) { return true; };
    const std::vector<Vec3> before = vertex_normals(mesh_.positions, all),
                            after = vertex_normals(out.positions, all);
    set_normals(out, [&](uint32_t, uint32_t vertex, const Vec3& own) {
      return unit_or_zero(own + (after[vertex] - before[vertex]));
    });
  }

  Scene& scene_;
  const Instance& instance_;
  const Mesh& mesh_;
  uint32_t index_;
  const std::vector<SlotDisplacement>& slots_;
  const std::vector<bool>& smooth_;
};

}  // namespace

DisplacedMesh displace(Scene& scene, uint32_t index, const std::vector<SlotDisplacement>& slots,
                       const std::vector<bool>& smooth, bool own_corners,
                       const CancelFlag& cancel) {
  if (index >= scene.instances.size())
    throw std::invalid_argument("a displacement names an instance that does not exist");
  if (scene.embree()) throw std::invalid_argument("the scene is built: its meshes stay");
  Instance& instance = scene.instances[index];
  Mesh& mesh = scene.meshes[instance.mesh];
  if (!mesh.is_smooth() || slots.empty() ||
      !(smooth.empty() || smooth.size() == mesh.triangles.size()))
    throw std::invalid_argument("a displacement does not fit its mesh");
  for (const SlotDisplacement& slot : slots)
    if (slot.program >= static_cast<int>(scene.programs.size()))
      throw std::invalid_argument("a displacement names a program that does not exist");
  // As programs know an instance whose mesh is in its own coordinates; build() sets both anew.
  instance.shared = true;
  scene.world_to_object.clear();
  for (const Instance& each : scene.instances) scene.world_to_object.push_back(each.to_local);
  const Displacer displacer(scene, index, slots, smooth);
  DisplacedMesh out;
  displacer.move_vertices(out, cancel);
  if (displacer.is_flat()) return out;
  const auto bumps = [](const SlotDisplacement& slot) { return slot.bumps; };
  if (!mesh.vertex_normals.empty()) {
    if (smooth.empty() && !own_corners && std::none_of(slots.begin(), slots.end(), bumps) &&
        displacer.bend_vertices(out))
      return out;
    mesh.spread_normals(scene.pool());
  }
  displacer.bend_normals(out, own_corners);
  return out;
}

}  // namespace photon_splat
