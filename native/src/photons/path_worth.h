// What photon paths may still bring that go on from places in media, learnt from pilots: where that
// is little, most of them end (adjoint-driven Russian roulette: Vorba and Krivanek 2016). In a
// world full of fog they would go astray for ever.
#pragma once

#include <span>
#include <vector>

#include "math/sampling.h"
#include "math/vec.h"
#include "util/count_table.h"

namespace photon_splat {

class PathWorth {
 public:
  // Where a path of a pilot has scattered in a medium.
  struct Stop {
    Vec3 place;
    uint32_t path;     // among those of its chunk
    float power;       // squared, that it goes on with; more than 0
    float brought;     // squared powers of what it leaves that is of use, from there on
    float weight = 1;  // it stands for so many
  };

  // Looks as far as `reach` from `middle`, m.
  PathWorth(const Vec3& middle, float reach)
      : corner_(middle - Vec3{reach, reach, reach}), size_(2 * reach) {}

  // Learns from one more pilot. brought: squared powers of what one of its paths leaves that is of
  // use, in the mean. Powers are those of a set of `total` paths.
  void learn(std::span<const Stop> stops, double brought, double total);
  // Chance to go on for a path that scatters at x with that power, of a set of `total` paths: 1
  // where it may bring half of what a path does in the mean.
  float chance(const Vec3& x, float power, double total) const;

 private:
  static constexpr int kLevels = 14;
  struct Sums {
    double stops = 0, brought = 0;  // over the power that went on
  };
  uint64_t cell(const Vec3& x, int level) const;

  Vec3 corner_;
  float size_;
  double brought_ = 0;  // of a set of one path
  std::vector<Stop> stops_;
  HashTable<Sums> cells_;  // of an octree
};

}  // namespace photon_splat
