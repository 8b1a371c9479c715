// How dense photons lie on each surface, learnt from a pilot set; it chooses kernel radii.
#pragma once

#include "photons/photon.h"
#include "scene/scene.h"
#include "util/count_table.h"

namespace photon_splat {

// An octree per surface key over the pilot's photons, kept as a hash of the cells that hold enough
// of them.
class RadiusMap {
 public:
  struct Settings {
    Vec3 middle{};  // of what is seen, and
    // How far half of that is from it, m: the octree's cells and the largest disc are made for it
    float reach = INFINITY;
    // Every photon counts one; else as many as equal ones would say as much (Kish's effective
    // sample size)
    bool alike = false;
  };
  // `pilot_paths` is the number of paths that left `pilot`.
  RadiusMap(const Scene& scene, const Photons& pilot, double pilot_paths, const Settings& settings);

  // What was found out of a place, to be kept by who asks: the answer is the same all over a cell,
  // and neighbours ask for neighbours.
  struct Memory {
    uint32_t key = 0;
    double on_surface = 0;
    int level = -1;
    uint64_t index = 0;  // of a cell of that level
    double densest = 0;
  };

  // Radius of the disc around x on surface `key` that about `photons` of a set of `paths` paths are
  // to fall in.
  float radius(uint32_t key, const Vec3& x, double photons, double paths, Memory& memory) const;
  float largest() const { return largest_; }
  // How many of a set of `paths` paths come to lie on the surface of the place asked for last,
  // anywhere on it.
  double photons_on_surface(const Memory& last, double paths) const {
    return last.on_surface * paths / pilot_paths_;
  }
  // And how many on a square metre there.
  double density(const Memory& last, double paths) const {
    return last.densest * paths / pilot_paths_;
  }

 private:
  static constexpr int kLevels = 11;
  static constexpr double kFewest = 24;  // photons in a cell whose density is believed

  struct Power {
    float sum = 0, squares = 0;
    double photons() const { return squares > 0 ? double(sum) * sum / squares : 0; }
  };

  uint64_t index_at(const Vec3& x, int level) const;
  uint64_t cell(uint32_t key, const Vec3& x, int level) const;
  void look_up(uint32_t key, const Vec3& x, Memory& memory) const;

  Vec3 corner_;
  float size_, largest_;  // m: of the cell of level 0
  double pilot_paths_;
  HashTable<Power> cells_;       // that hold enough photons
  HashTable<Power> on_surface_;  // by hashed key
};

}  // namespace photon_splat
