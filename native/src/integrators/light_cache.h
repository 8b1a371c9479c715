// Light of places that a viewport has seen, kept in the world: pictures of a camera that moves read
// it again, so that they are as still as the light itself. Cells of a grid on each surface, a few
// pixels wide, hold means of what camera samples have found there, over the albedo of each:
// textures stay sharp. Diffuse light looks alike from everywhere; what other lobes reflect is kept
// by the direction in which a mirror would look as well. (Cells by hash: Binder, Fricke and Keller,
// Massively Parallel Path Space Filtering, 2021. By that direction: Karis, Real Shading in Unreal
// Engine 4, 2013.)
#pragma once

#include "math/vec.h"
#include "util/count_table.h"

namespace photon_splat {

class LightCache {
 public:
  enum class Kind : uint8_t { kDiffuse, kReflected };
  static constexpr size_t kMostCells = size_t{1} << 20;
  explicit LightCache(size_t most_cells = kMostCells) : most_cells_(most_cells) {}

  // A place on a surface, among the middles of the cells around it.
  struct Place {
    uint64_t surface = 0;  // its side, and the axis that its normal is next to
    int32_t level = 0;     // cells are 2^level m wide
    int32_t slab = 0;      // of several cells' width along that axis
    // The cell whose middle is the next one below on either of the other axes, and how much of the
    // way from there to the next the place is
    int32_t u = 0, v = 0;
    float fu = 0, fv = 0;
    // Where a mirror would look, in the unit square, and how many steps of it are told apart along
    // a side; 0: reflected light is not asked for
    float mirror_u = 0, mirror_v = 0;
    int32_t directions = 0;
  };

  // `key`: of the surface's side; `normal`: the geometric one; `width` of cells, m, about.
  static Place place(uint32_t key, const Vec3& position, const Vec3& normal, float width);
  static void set_mirror(Place& place, const Vec3& direction, int32_t directions);

  // Samples in the cell that holds the place.
  float samples(const Place& place, Kind kind) const;
  // Whether light() has anything to go by.
  bool knows(const Place& place, Kind kind) const;
  // Mean of the four cells around a place; where they hold little, wider ones add to it. Black
  // where there is nothing.
  Rgb light(const Place& place, Kind kind) const;
  // Takes in the mean of so many samples, light over albedo. Not while others ask.
  void add(const Place& place, Kind kind, const Rgb& light, float samples = 1);
  // Has the next picture begin, after which cells that no recent one has added to may be forgotten.
  void begin_picture();

  size_t size() const { return cells_.size(); }
  bool empty() const { return cells_.empty(); }

 private:
  struct Cell {
    Rgb light{};
    float squares = 0;  // of luminances
    float count = 0;
    uint32_t picture = 0;  // the last one that added to it
  };
  // What is known of a place: the mean, the variance of one sample's luminance, and how many
  // samples that is from.
  struct Estimate {
    Rgb light{};
    float variance = 0, samples = 0;
  };

  static Place wider(const Place& place);
  static uint64_t key_of(const Place& place, int32_t u, int32_t v, Kind kind);
  static uint64_t key_of(const Place& place, Kind kind);  // of the cell that holds the place
  Estimate around(const Place& place, Kind kind) const;
  Estimate estimate(const Place& place, Kind kind, int width) const;
  void add_to(uint64_t key, const Rgb& light, float samples);

  HashTable<Cell> cells_;
  size_t most_cells_;
  uint32_t picture_ = 0;
};

// Light, or albedo, by the lobes that it belongs to.
struct CacheLight {
  Rgb diffuse{}, reflected{};
};

// What a path asks the cache for at a surface. `albedo`: of it, and of all before.
struct CacheReading {
  LightCache::Place place;
  CacheLight albedo;
  uint32_t pixel;  // of the tile
  bool first;      // whether the camera sees the surface straight
};

CacheLight light_over_albedo(const CacheLight& light, const CacheLight& albedo);

// What a path has found at a surface for the cache, indirect light excepted, which photons add.
struct CacheSample {
  LightCache::Place place;
  CacheLight albedo, light;
  // What the cache takes in. Where albedo has next to nothing of a colour, the others tell.
  CacheLight over_albedo() const { return light_over_albedo(light, albedo); }
};

}  // namespace photon_splat
