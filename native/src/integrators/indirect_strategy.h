// Where camera paths go on for the indirect light, as if photons brought none: at visible points
// that photons serve badly; at the first of every path too, so that photons light the next one
// (final gathering: Jensen, Global Illumination using Photon Maps, 1996); or at all.
#pragma once

#include "density/clear_regions.h"
#include "density/radius_map.h"
#include "density/surface_filter.h"

namespace photon_splat {

// Things that are small or bent against the discs that the photons' density asks for: leaves,
// pebbles, slivers, or surfaces that hardly any photon meets. What decides is the pilot and the
// shape of the surface, never the photons that would be gathered. Constant while paths are traced;
// any thread may ask.
class IndirectStrategy {
 public:
  enum class Kind { kPhotonDensity, kFinalGather, kPathTraced };

  IndirectStrategy(const Scene& scene, Kind kind) : scene_(scene), kind_(kind) {}

  // `photons`: wanted in a disc from a pass of `paths` paths. `radii` must outlive it. `known`:
  // surfaces that photons are aimed at. Until then photons serve every point well.
  void learn(const RadiusMap& radii, const SurfaceFilter& known, double photons, double paths) {
    radii_ = &radii;
    known_ = known;
    photons_ = photons;
    paths_ = paths;
  }

  // Looks from up to a few of `count` places in each region (place(i) tells them) for things that
  // stand in the discs of bent surfaces: there part of a disc may lie inside of them, unlit or lit
  // by what is inside, and paths go on from now on. Not while others ask.
  struct Place {
    Vec3 position, normal;
    uint32_t key, instance, triangle;
  };
  template <class PlaceOf>
  void look_for_crowds(size_t count, ThreadPool& pool, const CancelFlag& cancel,
                       PlaceOf&& place_of) {
    if (!radii_) return;
    std::vector<Look> looks(count);
    pool.for_parts(count, 1 << 12, cancel, [&](size_t begin, size_t end) {
      RadiusMap::Memory memory;
      for (size_t i = begin; i < end; ++i) looks[i] = look_at(place_of(i), memory);
    });
    see_crowds(looks, pool, cancel);
  }

  Kind kind() const { return kind_; }
  bool knows(uint32_t key) const { return !radii_ || known_.contains(key); }
  // Whether x is closer to the last vertex of a path, `way` metres, than the radius of a disc about
  // it: what is so close shades or lights the disc unevenly, and the path sees but the part of the
  // disc that is next to it. A gathering path then goes on. The other arguments are those of at().
  bool too_close(float way, uint32_t key, const Vec3& x, uint32_t instance, uint32_t triangle,
                 float radius_factor, RadiusMap::Memory& memory) const;
  // Whether too few photons of a pass come into the largest disc about x that neither bends nor
  // reaches past its patch. `radius_factor`: on all radii of that pass. `memory`: of this
  // IndirectStrategy's map.
  bool at(uint32_t key, const Vec3& x, uint32_t instance, uint32_t triangle, float radius_factor,
          RadiusMap::Memory& memory) const;

 private:
  struct Look {
    Place place;
    uint64_t region;
    float h = 0;  // 0: none
    bool crowded = false;
  };
  // The radius that a disc has, bent surfaces considered; `radius_factor` is 1 in the first pass.
  float disc_radius(uint32_t key, const Vec3& x, uint32_t instance, uint32_t triangle,
                    float radius_factor, RadiusMap::Memory& memory) const;
  Look look_at(const Place& place, RadiusMap::Memory& memory) const;
  void see_crowds(std::vector<Look>& looks, ThreadPool& pool, const CancelFlag& cancel);
  bool bent(uint32_t instance, uint32_t triangle) const;

  const Scene& scene_;
  const Kind kind_;
  CountTable looked_, crowded_;  // by ClearRegions::region
  const RadiusMap* radii_ = nullptr;
  SurfaceFilter known_;
  double photons_ = 0, paths_ = 0;
};

}  // namespace photon_splat
