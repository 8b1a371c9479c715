// Where the world is seen from: directions in which camera paths have found it, place by place, so that later ones look there.
#pragma once

#include <unordered_map>
#include <vector>

#include "sampling.h"

namespace photon_splat {

// An even sky through a window is found by few of the rays that surfaces send out. What they, and samples of the guide itself,
// have found is kept in cells of space and of the surface's orientation, as a histogram over the octahedral map of directions:
// an estimate of radiance times cosine times visibility. It is learnt between passes and fixed during them.
class SkyGuide {
 public:
  static constexpr int kSide = 16, kBins = kSide * kSide;

  // What was met in a direction from the place x, of unit normal n (0: any). weight: its radiance times cosine over the density it
  // was found with, 0 where something stood in the way. ray: found by the surface's own sampling.
  struct Sighting {
    Vec3 x, n, direction;
    float weight;
    bool ray;
  };
  // A histogram that directions can be drawn from.
  class Cell {
   public:
    Vec3 sample(const Vec2& u) const;
    float pdf(const Vec3& d) const;  // solid angle

   private:
    friend class SkyGuide;
    std::vector<float> sums, cdf;
    uint32_t rays = 0, seen = 0, found = 0;  // of the surface's own; those of them that met the world; all that did
    bool useful = false;
  };

  void reset() { *this = {}; }
  bool learning() const { return passes_ < kPasses; }
  // The sightings of one pass, in an order that does not depend on threads, then end_pass().
  void learn(const std::vector<Sighting>& sightings);
  void end_pass();

  // None where the guide knows too little, or where the world is seen so freely that no guide is needed.
  const Cell* find(const Vec3& x, const Vec3& n) const;

 private:
  static constexpr uint32_t kPasses = 8;  // that are learnt from
  static constexpr int kLevels = 3;
  uint64_t key(int level, const Vec3& x, const Vec3& n) const;
  void add(Cell& cell, const Sighting& s) const;

  uint32_t passes_ = 0;
  Vec3 low_{}, size_{};
  float edge_ = 0;                 // of the finest cells, m; 0: nothing learnt yet
  std::vector<Sighting> waiting_;  // of the pass
  std::unordered_map<uint64_t, Cell> cells_;
};

}  // namespace photon_splat
