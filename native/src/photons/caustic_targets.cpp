#include "photons/caustic_targets.h"

#include <queue>

namespace photon_splat {
namespace {

constexpr size_t kMostTargets = 64;
constexpr int kLooksInTime = 9;         // at where a triangle goes while the shutter is open
constexpr size_t kMostBoxes = 1 << 18;  // triangles looked at; of more, every n-th
// The halves' spheres together show at most this share of the whole's disc
constexpr float kWorthSplitting = 0.8f;
// Of a cluster's size: larger boxes leave nothing to aim at
constexpr float kLarge = 0.5f;

struct Cluster {
  std::vector<Bounds> boxes;
  Bounds all;

  float size() const { return all.diagonal(); }
  bool operator<(const Cluster& other) const { return size() < other.size(); }
};

float disc(const Cluster& c) { return c.size() * c.size(); }

Cluster cluster_of(std::vector<Bounds> boxes) {
  Cluster c{std::move(boxes), {}};
  for (const Bounds& b : c.boxes) c.all.add(b);
  return c;
}

// Those that are not much smaller than all together, a floor say, and the others, which may lie
// among them.
std::pair<Cluster, Cluster> by_size(const Cluster& whole) {
  std::vector<Bounds> large, small;
  for (const Bounds& b : whole.boxes)
    (b.diagonal() > kLarge * whole.size() ? large : small).push_back(b);
  return {cluster_of(std::move(large)), cluster_of(std::move(small))};
}

// Halves at the middle of the longest axis.
std::pair<Cluster, Cluster> halves(const Cluster& whole) {
  const Vec3 extent = whole.all.upper - whole.all.lower;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const float middle = whole.all.center()[axis];
  std::vector<Bounds> low, high;
  for (const Bounds& b : whole.boxes) (b.center()[axis] < middle ? low : high).push_back(b);
  return {cluster_of(std::move(low)), cluster_of(std::move(high))};
}

std::vector<Bounds> sharp_triangles(const Scene& scene) {
  const auto is_sharp = [&](int32_t material) {
    const int program = scene.materials[material].program;
    return program >= 0 && scene.programs[program].features & kProgramSharp;
  };
  std::vector<uint32_t> instances;
  size_t triangles = 0;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    bool sharp = false;
    for (uint32_t s = 0; s < instance.slot_count; ++s)
      sharp |= is_sharp(scene.slot_materials[instance.first_material + s]);
    if (!sharp) continue;
    instances.push_back(i);
    triangles += scene.meshes[instance.mesh].triangles.size();
  }
  const size_t step = std::max<size_t>(1, triangles / kMostBoxes);
  std::vector<Bounds> boxes;
  for (uint32_t i : instances) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (size_t t = 0; t < mesh.triangles.size(); t += step) {
      const Material& material = scene.material_of(i, static_cast<uint32_t>(t));
      if (material.program < 0 || !(scene.programs[material.program].features & kProgramSharp))
        continue;
      Bounds b;
      const int looks = scene.moves(i) ? kLooksInTime : 1;
      for (int look = 0; look < looks; ++look) {
        Vec3 corners[3];
        scene.corners(
            i, static_cast<uint32_t>(t),
            looks > 1 ? static_cast<float>(look) / static_cast<float>(looks - 1) : kShutterCentre,
            corners);
        for (const Vec3& corner : corners) b.add(corner);
      }
      boxes.push_back(b);
    }
  }
  return boxes;
}

}  // namespace

std::vector<EmissionTargets::Sphere> caustic_targets(const Scene& scene) {
  std::vector<Bounds> boxes = sharp_triangles(scene);
  if (boxes.empty()) return {};
  std::priority_queue<Cluster> open;
  std::vector<Cluster> done;
  open.push(cluster_of(std::move(boxes)));
  while (!open.empty()) {
    Cluster whole = open.top();
    open.pop();
    if (whole.boxes.size() > 1 && open.size() + done.size() + 2 <= kMostTargets) {
      auto [large, small] = by_size(whole);
      if (!large.boxes.empty() && !small.boxes.empty() &&
          disc(small) < kWorthSplitting * disc(whole)) {
        open.push(std::move(large));
        open.push(std::move(small));
        continue;
      }
      auto [low, high] = halves(whole);
      // Halves of halves too: four things in a square are not worth one cut.
      if (!low.boxes.empty() && !high.boxes.empty()) {
        float best = disc(low) + disc(high);
        float quarters = 0;
        for (const Cluster* half : {&low, &high}) {
          const auto [a, b] = halves(*half);
          quarters += a.boxes.empty() || b.boxes.empty() ? disc(*half) : disc(a) + disc(b);
        }
        best = std::min(best, quarters);
        if (best < kWorthSplitting * disc(whole)) {
          open.push(std::move(low));
          open.push(std::move(high));
          continue;
        }
      }
    }
    done.push_back(std::move(whole));
  }
  std::vector<EmissionTargets::Sphere> spheres;
  const float least = std::max(1e-6f * scene.near_radius(), 1e-30f);
  for (const Cluster& c : done)
    spheres.push_back({c.all.center(), std::max(0.5f * c.size(), least) * 1.001f});
  return spheres;
}

}  // namespace photon_splat
