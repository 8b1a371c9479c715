// Curves and points as rays meet them: Embree's own types, nothing is tessellated.
#pragma once

#include <embree4/rtcore.h>

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/motion.h"
#include "math/vec.h"
#include "util/large_pages.h"

namespace photon_splat {

enum class StrandShape : uint8_t {
  kRibbon,       // flat and turned towards the ray, but shaded as if round
  kThick,        // round
  kThickLinear,  // round and straight between its keys
  kPoint         // a ball
};

// A key of a curve, or a point, as Embree reads it.
struct StrandKey {
  Vec3 position;
  float radius = 0;
};

// Rays count segments: those of all curves in a row, or points. `u` runs along a segment from 0 to
// 1. Keys are counted without the ends, which curves that are smooth hold twice.
class Strands {
 public:
  // first: of each curve its first key, and one past the last; empty for points. Each curve has two
  // keys at the least. subdivisions: of a ribbon's segment.
  Strands(StrandShape shape, uint32_t subdivisions, std::span<const StrandKey> keys,
          std::vector<uint32_t> first);

  StrandShape shape() const { return shape_; }
  bool are_curves() const { return shape_ != StrandShape::kPoint; }
  uint32_t segments() const { return segments_; }
  uint32_t count() const { return are_curves() ? curves_ : segments_; }
  uint32_t key_count() const { return key_count_; }
  size_t memory() const;

  // The curve or point that a segment belongs to, and the key where it begins.
  uint32_t strand(uint32_t segment) const {
    return are_curves() ? (index_[segment] - segment) / (1 + ends()) : segment;
  }
  uint32_t first_key(uint32_t segment) const {
    return are_curves() ? segment + strand(segment) : segment;
  }

  // Keys at steps of the shutter, as many each time as there are, an odd number of steps; those in
  // the middle are not read.
  void set_motion(std::span<const StrandKey> steps, size_t count);
  bool moves() const { return !moving_.empty(); }

  StrandKey key(uint32_t number, float time) const;
  // Towards the tip, of any length; of points 0.
  Vec3 tangent(uint32_t segment, float u, float time) const;
  // Linear between the keys.
  float radius(uint32_t segment, float u, float time) const;
  // Length of a curve, and of its keys' polygon from the root up to a place: in the units of the
  // keys as they were before transform().
  float length(uint32_t curve) const;
  float length_to(uint32_t segment, float u) const;

  // By a matrix that scales all directions alike.
  void transform(const std::array<double, 12>& to_world, float scale);
  // Bounds of its keys at all steps of motion.
  Bounds bounds() const;

  RTCGeometry make_geometry(RTCDevice device) const;

  // What Embree's `id` of a ray says to have it pass the strand that it left, as in Cycles.
  static uint32_t mark(uint32_t instance, uint32_t strand);

 private:
  // Keys that each curve holds more than it has
  uint32_t ends() const {
    return shape_ == StrandShape::kRibbon || shape_ == StrandShape::kThick ? 2 : 0;
  }
  size_t place(uint32_t key, uint32_t curve) const { return key + (ends() ? 2 * curve + 1 : 0); }
  const LargeArray<StrandKey>& step(size_t i) const;
  StrandKey at(size_t place, float time) const;
  void fill(std::span<const StrandKey> keys, LargeArray<StrandKey>& out) const;

  StrandShape shape_;
  uint32_t subdivisions_, key_count_, curves_ = 0, segments_ = 0;
  float scale_ = 1;
  LargeArray<StrandKey> keys_;                 // as Embree reads them
  std::vector<LargeArray<StrandKey>> moving_;  // at steps; of the middle one nothing
  std::vector<uint32_t> first_;                // key of each curve, and their number
  std::vector<uint32_t> index_;                // of each segment, in keys_
};

}  // namespace photon_splat
