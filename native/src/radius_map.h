// How dense photons lie on each surface, learnt from a pilot set; it chooses kernel radii.
#pragma once

#include <unordered_map>

#include "photons.h"

namespace photon_splat {

// An octree per surface key over the pilot's photons, kept as a hash of the cells that hold enough of them.
class RadiusMap {
 public:
  // `pilot_paths` is the number of paths that left `pilot`.
  RadiusMap(const Scene& scene, const std::vector<Photon>& pilot, double pilot_paths);

  // Radius of the disc around x on surface `key` that about `photons` of a set of `paths` paths are to fall in.
  float radius(uint32_t key, const Vec3& x, double photons, double paths) const;
  float largest() const { return largest_; }
  // How many of a set of `paths` paths come to lie on the surface, anywhere on it.
  double photons_on(uint32_t key, double paths) const {
    const auto it = on_surface_.find(key);
    return it == on_surface_.end() ? 0 : it->second * paths / pilot_paths_;
  }

 private:
  static constexpr int kLevels = 11;
  static constexpr uint32_t kFewest = 24;  // photons in a cell whose density is believed

  uint64_t cell(uint32_t key, const Vec3& x, int level) const;

  Vec3 corner_;
  float size_, largest_;
  double pilot_paths_;
  std::unordered_map<uint64_t, uint32_t> counts_;
  std::unordered_map<uint32_t, uint32_t> on_surface_;  // photons, by key
};

}  // namespace photon_splat
