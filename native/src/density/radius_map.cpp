#include "density/radius_map.h"

namespace photon_splat {
namespace {

constexpr float kLargestOfScene = 0.25f;  // discs, of the scene's radius
// Largest radius over that of the sphere which holds half of what is seen: a wider disc shows one
// light all over
constexpr float kLargestOfSeen = 0.5f;
constexpr float kSeenShare = 16;  // times that radius the octree begins with

}  // namespace

RadiusMap::RadiusMap(const Scene& scene, const Photons& pilot, double pilot_paths,
                     const Settings& settings)
    : pilot_paths_(std::max(pilot_paths, 1.0)) {
  // Against a scene that is seen in part
  const bool small = kSeenShare * settings.reach < scene.near_radius();
  const float r = small ? std::max(kSeenShare * settings.reach, 1e-20f) : scene.near_radius();
  // Cells go on beyond, however far
  corner_ = (small ? settings.middle : scene.near_center()) - Vec3{r, r, r};
  size_ = 2 * r;
  largest_ =
      std::min(kLargestOfScene * scene.radius(), std::max(kLargestOfSeen * settings.reach, 1e-20f));
  std::vector<float> powers(pilot.size(), 1.0f);
  if (!settings.alike)
    for (size_t i = 0; i < pilot.size(); ++i) powers[i] = luminance(pilot[i].power);
  const auto add = [&](Power& power, uint32_t i) {
    power.sum += powers[i];
    power.squares += powers[i] * powers[i];
  };
  std::vector<uint32_t> inside;
  for (uint32_t i = 0; i < pilot.size(); ++i) {
    if (!std::isfinite(powers[i] * powers[i])) continue;
    add(on_surface_[hash64(pilot[i].key)], i);
    inside.push_back(i);
  }
  // Level by level, photons in cells that hold few of them drop out.
  for (int level = 0; level < kLevels && !inside.empty(); ++level) {
    std::vector<uint64_t> cells(inside.size());
    for (size_t i = 0; i < inside.size(); ++i) {
      cells[i] = cell(pilot[inside[i]].key, pilot[inside[i]].position, level);
      add(cells_[cells[i]], inside[i]);
    }
    size_t kept = 0;
    for (size_t i = 0; i < inside.size(); ++i)
      if (cells_.find(cells[i])->photons() >= kFewest) inside[kept++] = inside[i];
    inside.resize(kept);
  }
  cells_.keep_if([](const Power& power) { return power.photons() >= kFewest; });
}

uint64_t RadiusMap::index_at(const Vec3& x, int level) const {
  const float scale = static_cast<float>(1 << level) / size_;
  const Vec3 p = (x - corner_) * scale;
  const auto index = [](float f) {
    return static_cast<uint64_t>(static_cast<int64_t>(std::floor(f)) & 0xffff);
  };
  return index(p.x) | index(p.y) << 16 | index(p.z) << 32;
}

uint64_t RadiusMap::cell(uint32_t key, const Vec3& x, int level) const {
  return hash64((uint64_t{key} << 5 | static_cast<uint64_t>(level)) * 0x9e3779b97f4a7c15ull ^
                hash64(index_at(x, level)));
}

// A cell that holds a sliver of the patch shows too low a density, so the densest of the nested
// cells is believed. The first of them that is not kept, or the smallest of all, is where the
// answer holds.
void RadiusMap::look_up(uint32_t key, const Vec3& x, Memory& memory) const {
  const auto photons = [](const Power* power) { return power ? power->photons() : 0.0; };
  memory = {key, photons(on_surface_.find(hash64(key))), 0, 0, 0};
  for (;; ++memory.level) {
    const double count = photons(cells_.find(cell(key, x, memory.level)));
    const double size = double(size_) / (1 << memory.level);
    memory.densest = std::max(memory.densest, count / (size * size));
    if (!(count > 0) || memory.level == kLevels - 1) break;
  }
  memory.index = index_at(x, memory.level);
}

float RadiusMap::radius(uint32_t key, const Vec3& x, double photons, double paths,
                        Memory& memory) const {
  if (memory.level < 0 || memory.key != key || memory.index != index_at(x, memory.level))
    look_up(key, x, memory);
  if (!(memory.densest > 0)) return largest_;
  return std::min(largest_, static_cast<float>(std::sqrt(photons * pilot_paths_ /
                                                         (kPi * memory.densest * paths))));
}

}  // namespace photon_splat
