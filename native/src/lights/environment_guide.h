// Where the world is seen from: directions in which camera paths have found it, place by place, so
// that later ones look there.
#pragma once

#include <unordered_map>
#include <vector>

#include "lights/environment.h"

namespace photon_splat {

// An even sky through a window is found by few of the rays that surfaces send out, and a small sun
// in an image is wasted on walls in shadow. What rays and light samples have found is kept in cells
// of space and of the surface's orientation, as an estimate of radiance times cosine times
// visibility in each part of the environment; within a part directions are drawn as the environment
// draws them. It is learnt between passes and fixed during them.
class EnvironmentGuide {
 public:
  // What was met in a direction from the place x, of unit normal n (0: any). weight: its radiance
  // times cosine over the density it was found with, 0 where something stood in the way. ray: found
  // by the surface's own sampling.
  struct Sighting {
    Vec3 x, n, direction;
    float weight;
    bool ray;
  };
  // A histogram that directions can be drawn from.
  class alignas(64) Cell {
   public:
    Environment::Sample sample(const Environment& environment, const Vec2& u) const;
    // Solid angle
    float pdf(const Environment& environment, const Environment::Density& density) const;

   private:
    friend class EnvironmentGuide;
    // The patches' share of all up to the end of each band; what is left is the discs'
    float band_cdf_[DirectionTable::kBands];
    float cdf_[DirectionTable::kPatches];
  };

  // Forgets all; what is learnt from now on is of `environment`, which must outlive it.
  void reset(const Environment& environment) {
    *this = {};
    environment_ = &environment;
  }
  bool learning() const { return passes_ < kPasses; }
  // The sightings of one pass, in an order that does not depend on threads, then end_pass().
  void learn(const std::vector<Sighting>& sightings);
  void end_pass();

  // None where the guide knows too little, or where so even a world is seen so freely that no guide
  // is needed.
  const Cell* find(const Vec3& x, const Vec3& n) const;

 private:
  static constexpr uint32_t kPasses = 9;  // that are learnt from
  static constexpr int kLevels = 3;
  // What has been found, and what directions are drawn by.
  struct Found {
    std::vector<float> sums;  // by part; none before anything is found
    // Rays by the surface's own sampling; those of them that met the world; all samples that did
    uint32_t rays = 0, seen = 0, found = 0;
  };
  // Cells by their keys, to be looked up.
  struct Slot {
    uint64_t key = ~uint64_t{0};
    int32_t cell = kUnknown;
  };
  static constexpr int32_t kUnknown = -2, kNoGuide = -1;
  uint64_t key(int level, const Vec3& x, const Vec3& n) const;
  static uint64_t parent_of(uint64_t key);  // one level up
  void add(Found& cell, const Sighting& s) const;
  void join_levels();
  // Makes a distribution of what it has found, if that is enough
  int32_t believe(const Found& cell, bool uneven);
  void keep(int level, uint64_t key, int32_t cell);
  int32_t look_up(int level, uint64_t key) const;

  const Environment* environment_ = nullptr;
  uint32_t passes_ = 0;
  Vec3 low_{};
  // 1 over the edge of a level's cells, 1/m, the finest first; 0: nothing learnt yet
  float scale_[kLevels] = {};
  std::vector<Sighting> waiting_;  // of the pass
  std::unordered_map<uint64_t, Found> found_[kLevels];
  std::vector<Cell> cells_;
  std::vector<Slot> slots_[kLevels];  // a power of two of them, half of them empty
};

}  // namespace photon_splat
