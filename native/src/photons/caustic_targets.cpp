#include "photons/caustic_targets.h"

#include <algorithm>
#include <optional>

namespace photon_splat {
namespace {

constexpr size_t kMostTargets = 64;
constexpr int kLooksInTime = 9;         // at where a triangle goes while the shutter is open
constexpr size_t kMostBoxes = 1 << 18;  // triangles looked at; of more, every n-th
// The halves' spheres together show at most this share of the whole's disc
constexpr float kWorthSplitting = 0.8f;
// Of a cluster's size: larger boxes leave nothing to aim at
constexpr float kLarge = 0.5f;
// Wider against their distance clusters are cut whatever becomes of the discs, up to so many: which
// part of them is of use is learnt
constexpr float kWide = 0.5f;
constexpr size_t kMostWide = 32;

struct Cluster {
  std::vector<Bounds> boxes;
  Bounds all;

  float size() const { return all.diagonal(); }
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

// Size against the distance from what is seen, if that is told.
float width(const Cluster& c, const Vec3& center, float radius) {
  return radius < INFINITY ? c.size() / (length(c.all.center() - center) + radius) : c.size();
}

using Halves = std::optional<std::pair<Cluster, Cluster>>;

// Cuts that leave less to aim at.
Halves cut_to_save(const Cluster& whole) {
  auto [large, small] = by_size(whole);
  if (!large.boxes.empty() && !small.boxes.empty() && disc(small) < kWorthSplitting * disc(whole))
    return {{std::move(large), std::move(small)}};
  auto [low, high] = halves(whole);
  if (low.boxes.empty() || high.boxes.empty()) return {};
  // Halves of halves too: four things in a square are not worth one cut.
  float quarters = 0;
  for (const Cluster* half : {&low, &high}) {
    const auto [a, b] = halves(*half);
    quarters += a.boxes.empty() || b.boxes.empty() ? disc(*half) : disc(a) + disc(b);
  }
  if (std::min(disc(low) + disc(high), quarters) < kWorthSplitting * disc(whole))
    return {{std::move(low), std::move(high)}};
  return {};
}

// Large and small things apart, or halves.
Halves cut_anyway(const Cluster& whole) {
  for (auto& parts : {by_size(whole), halves(whole)})
    if (!parts.first.boxes.empty() && !parts.second.boxes.empty()) return parts;
  return {};
}

// The widest first; those wider than `wide` are cut whatever becomes of the discs.
std::vector<Cluster> clusters_of(const Scene& scene, const Vec3& center, float radius, float wide) {
  std::vector<Bounds> boxes = sharp_triangles(scene);
  if (boxes.empty()) return {};
  std::vector<Cluster> open, done;
  open.push_back(cluster_of(std::move(boxes)));
  while (!open.empty()) {
    const auto widest = std::ranges::max_element(
        open, {}, [&](const Cluster& c) { return width(c, center, radius); });
    Cluster whole = std::move(*widest);
    open.erase(widest);
    const size_t count = open.size() + done.size() + 1;
    Halves cut;
    if (whole.boxes.size() > 1 && count < kMostTargets) cut = cut_to_save(whole);
    if (!cut && count < kMostWide && width(whole, center, radius) >= wide) cut = cut_anyway(whole);
    if (!cut) {
      done.push_back(std::move(whole));
      continue;
    }
    open.push_back(std::move(cut->first));
    open.push_back(std::move(cut->second));
  }
  return done;
}

EmissionTargets::Sphere sphere_of(const Cluster& c, const Scene& scene) {
  const float least = std::max(1e-6f * scene.near_radius(), 1e-30f);
  return {c.all.center(), std::max(0.5f * c.size(), least) * 1.001f};
}

}  // namespace

std::vector<EmissionTargets::Sphere> caustic_targets(const Scene& scene) {
  std::vector<EmissionTargets::Sphere> spheres;
  for (const Cluster& c : clusters_of(scene, scene.near_center(), INFINITY, INFINITY))
    spheres.push_back(sphere_of(c, scene));
  return spheres;
}

std::vector<EmissionTargets::Sphere> fine_caustic_targets(const Scene& scene, const Vec3& center,
                                                          float radius) {
  std::vector<EmissionTargets::Sphere> spheres;
  for (const Cluster& c : clusters_of(scene, center, radius, kWide)) {
    EmissionTargets::Sphere s = sphere_of(c, scene);
    // Of light that is scattered further off the less comes to what is seen, and what is wider than
    // that scatters most of it elsewhere.
    const float off = std::max(0.0f, length(s.center - center) - s.radius) / radius;
    s.weight = 1 / sqr((1 + off) * std::max(1.0f, s.radius / radius));
    spheres.push_back(s);
  }
  return spheres;
}

}  // namespace photon_splat
