#include "radius_map.h"

namespace photon_splat {

RadiusMap::RadiusMap(const Scene& scene, const Photons& pilot, double pilot_paths)
    : pilot_paths_(std::max(pilot_paths, 1.0)) {
  const float r = scene.radius();
  // The smallest cells are small beside what is near, and cells count from there, however far other things are.
  const float near = scene.near_radius();
  corner_ = scene.near_center() - Vec3{near, near, near};
  for (size_ = 2 * near; size_ < 2 * r && levels_ < kMostLevels; size_ *= 2) ++levels_;
  largest_ = 0.25f * r;
  for (const Photon& p : pilot) on_surface_.add(hash64(p.key));
  std::vector<uint32_t> inside(pilot.size());
  for (uint32_t i = 0; i < inside.size(); ++i) inside[i] = i;
  // Level by level, photons in cells that hold few of them drop out.
  for (int level = 0; level < levels_ && !inside.empty(); ++level) {
    std::vector<uint64_t> cells(inside.size());
    for (size_t i = 0; i < inside.size(); ++i) {
      cells[i] = cell(pilot[inside[i]].key, pilot[inside[i]].position, level);
      counts_.add(cells[i]);
    }
    size_t kept = 0;
    for (size_t i = 0; i < inside.size(); ++i)
      if (counts_.count(cells[i]) >= kFewest) inside[kept++] = inside[i];
    inside.resize(kept);
  }
  counts_.keep_from(kFewest);
}

uint64_t RadiusMap::index_at(const Vec3& x, int level) const {
  const float scale = static_cast<float>(1 << level) / size_;
  const Vec3 p = (x - corner_) * scale;
  const auto index = [](float f) { return static_cast<uint64_t>(static_cast<int64_t>(std::floor(f)) & 0xffff); };
  return index(p.x) | index(p.y) << 16 | index(p.z) << 32;
}

uint64_t RadiusMap::cell(uint32_t key, const Vec3& x, int level) const {
  return hash64((uint64_t{key} << 5 | static_cast<uint64_t>(level)) * 0x9e3779b97f4a7c15ull ^ hash64(index_at(x, level)));
}

// A cell that holds a sliver of the patch shows too low a density, so the densest of the nested cells is believed. The first of
// them that is not kept, or the smallest of all, is where the answer holds.
void RadiusMap::look_up(uint32_t key, const Vec3& x, Memory& memory) const {
  memory = {key, on_surface_.count(hash64(key)), 0, 0, 0};
  for (;; ++memory.level) {
    const uint32_t count = counts_.count(cell(key, x, memory.level));
    const double size = double(size_) / (1 << memory.level);
    memory.densest = std::max(memory.densest, count / (size * size));
    if (!count || memory.level == levels_ - 1) break;
  }
  memory.index = index_at(x, memory.level);
}

float RadiusMap::radius(uint32_t key, const Vec3& x, double photons, double paths, Memory& memory) const {
  if (memory.level < 0 || memory.key != key || memory.index != index_at(x, memory.level)) look_up(key, x, memory);
  if (!(memory.densest > 0)) return largest_;
  return std::min(largest_, static_cast<float>(std::sqrt(photons * pilot_paths_ / (kPi * memory.densest * paths))));
}

}  // namespace photon_splat
