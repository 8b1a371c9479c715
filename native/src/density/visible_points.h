// Where irradiance is wanted: points on surfaces, in blocks. They come from gather points but are
// no pixels: many gather points share a point, and the splatter that fills them knows no camera.
#pragma once

#include "density/clear_regions.h"
#include "density/kernel_mass.h"
#include "density/occlusion.h"
#include "density/point_blocks.h"
#include "density/radius_map.h"
#include "density/surface_filter.h"
#include "density/way_sums.h"
#include "integrators/gather_point.h"

namespace photon_splat {

struct PointSettings {
  double photons_per_disc = 0;  // wanted in each kernel disc from one pass
  double paths_per_pass = 0;
  float radius_factor = 1;      // user's scale times the shrinking over passes
  float spacing = 1.0f / 3.0f;  // of points, in kernel radii; 0: a point per gather point
  float after_gather_spacing =
      0;                   // of points for gather points of paths that went on, if it is more
  bool occlusion = false;  // what stands in discs is looked for
  const float* pixel_factors = nullptr;  // on the radius, by the gather point's pixel; none: 1
  // These points are for caustics: gather points that want nothing else count
  bool caustics = false;
  float fixed_radius = 0;  // metres; 0: chosen
  // The gather point next to the middle of its cell gives the point, whatever the camera: no
  // flicker
  bool steady = false;
};

// What a picture shows before photons add to it: where that outshines them, few of the points need
// their masses.
struct LightBeside {
  std::span<const float> luminance;  // by pixel; none: not known
  const GatherPoints* gather_points = nullptr;
  float more = 1;  // as the photons so far become when all have come
};

class VisiblePoints {
 public:
  // Chooses radii and points for `gather_points`; `pass` decides the random places of the cells.
  void build(Scene& scene, const GatherPoints& gather_points, const RadiusMap& radii,
             const PointSettings& settings, uint32_t pass, uint32_t seed, const CancelFlag& cancel);

  // The seed's boundary term, kept apart so that it can be timed: kernel masses, with
  // PointSettings::occlusion less what things that stand on the surface hide, and of discs that do
  // not reach past walls. Before photons are splatted: places and radii of discs, and masses that
  // have a say in those.
  void correct_boundaries(Scene& scene, const CancelFlag& cancel);
  // After that: the other masses, of points that some photon has reached. May come again. Of points
  // that are faint beside other light those of some, drawn at random, stand for all.
  void find_masses(Scene& scene, const LightBeside& beside, const CancelFlag& cancel);

  // Another view learns anew, so that its picture does not depend on those before.
  void forget_clear_regions() { clear_regions_ = {}; }

  // What these two have met, over all calls.
  struct Counts {
    // all; with a thing or wall in the disc; whose mass was found; of these with an edge in the
    // disc
    uint64_t points = 0, obstructed = 0, measured = 0, cut = 0;
  };
  const Counts& counts() const { return counts_; }

  size_t size() const { return points_.size(); }
  PointBlocks& blocks() { return blocks_; }
  const PointBlocks& blocks() const { return blocks_; }
  // Of blocks around bumps
  WaySums& ways() { return ways_; }
  const WaySums& ways() const { return ways_; }
  const std::vector<Bounds>& block_bounds() const { return bounds_; }  // grown by the kernel radii
  const SurfaceFilter& keys() const { return keys_; }
  static constexpr uint32_t kNone = ~0u;  // of a gather point that wants none of this light
  uint32_t point_of(size_t gather_point) const { return point_of_[gather_point]; }

 private:
  static constexpr size_t kChunk = 4096;  // of gather points, for one thread
  static size_t chunks_of(size_t count) { return (count + kChunk - 1) / kChunk; }
  struct Point {
    uint32_t gather_point;
    float h;
  };
  // What stands in a point's disc. Where earlier passes have met nothing, few points are looked at.
  struct Look {
    uint64_t region = 0;
    bool done = false;
    DiscOcclusion found;
    bool clear(float h) const { return !(found.hidden > 0 || found.clear < h); }
  };
  struct Cell {
    uint64_t hash;
    uint32_t gather_point;
    float h;        // 0: none
    uint32_t rank;  // the lowest of a cell gives the point
  };
  void find_cells(Scene& scene, const GatherPoints& gather_points, const RadiusMap& radii,
                  const PointSettings& s, uint32_t pass, uint32_t seed, const CancelFlag& cancel);
  void pick_points(Scene& scene, const CancelFlag& cancel);
  Look look(Scene& scene, const GatherPoint& r, float h) const;
  // GatherPoints that see their point only through a wall get one of their own.
  void split_at_walls(Scene& scene, const GatherPoints& gather_points, const CancelFlag& cancel);
  void want_ways(Scene& scene, const GatherPoints& gather_points, const CancelFlag& cancel);
  float chance_of_mass(size_t point, const LightBeside& beside) const;
  void fill_blocks(Scene& scene, const GatherPoints& gather_points, const CancelFlag& cancel);

  std::vector<Cell> cells_;
  std::vector<Point> points_;
  // Per point, first as they are found, then in block order; none without occlusion
  std::vector<Look> looks_;
  // Instance and triangle per point, in block order
  std::vector<std::pair<uint32_t, uint32_t>> places_;
  // By point, in block order: what is found once it has photons
  enum Waits : uint8_t { kMass = 1, kLook = 2 };  // kLook: at what stands in a bent disc
  std::vector<uint8_t> waiting_;
  struct BentLook {
    uint64_t region;
    bool clear;
  };
  std::vector<std::vector<BentLook>> bent_looks_;  // by block
  std::vector<uint32_t> point_of_;
  PointBlocks blocks_;
  WaySums ways_;
  std::vector<Bounds> bounds_;
  SurfaceFilter keys_;
  Counts counts_;
  ClearRegions clear_regions_;
};

}  // namespace photon_splat
