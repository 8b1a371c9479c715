// What changes while the shutter is open: transforms, shapes, and when it is open. Times are shares
// of the shutter's opening, from 0 to 1. All that is asked without a time is asked of its middle.
#pragma once

#include <span>
#include <vector>

#include "math/vec.h"
#include "util/large_pages.h"

namespace photon_splat {

inline constexpr float kShutterCentre = 0.5f;

// Between steps `first` and `first` + 1 of several, evenly spread over the shutter's opening.
struct MotionStep {
  uint32_t first;
  float share;  // of the way to the next one
};
inline MotionStep motion_step(size_t steps, float time) {
  const float last = static_cast<float>(steps - 1), at = std::clamp(time, 0.0f, 1.0f) * last;
  const uint32_t first = std::min(static_cast<uint32_t>(at), static_cast<uint32_t>(steps - 2));
  return {first, at - static_cast<float>(first)};
}

struct Quaternion {
  float w = 1, x = 0, y = 0, z = 0;
};

// A transform taken apart: it stretches, then turns, then moves. The stretch is an upper triangular
// matrix, which a turn and a scale along the axes makes diagonal.
struct Decomposed {
  Vec3 translation;
  Quaternion rotation;
  float xx = 1, xy = 0, xz = 0, yy = 1, yz = 0, zz = 1;
};
// Never fails: of what is flat some turn is taken.
Decomposed decompose(const Affine& a);
Affine compose(const Decomposed& d);

// A transform at steps of the shutter. Between them turns go the shortest way at constant speed,
// all else is linear: as in Cycles, and as Embree has it (rtcSetGeometryTransformQuaternion).
class TransformMotion {
 public:
  explicit TransformMotion(std::span<const Affine> steps);  // two at the least
  Affine at(float time) const;
  const std::vector<Decomposed>& steps() const { return steps_; }

 private:
  std::vector<Decomposed> steps_;
};

// Vertices and normals of a mesh at steps of the shutter, linear between them. Those of the middle
// step, which are the mesh's own, are empty. Without normals at steps those of a smooth mesh turn
// with its triangles.
struct MeshMotion {
  std::vector<LargeArray<Vec3>> positions, corner_normals;
  size_t steps() const { return positions.size(); }  // 0: the mesh keeps its shape
  size_t middle() const { return steps() / 2; }
};

// How long it is open at which time, and whether the lines of a picture are exposed one after the
// other.
class Shutter {
 public:
  // `curve`: how far open at equal steps of its time, linear between them; empty or black: all of
  // the time. `rolling`: the share of its time that a line is exposed for, the topmost first; below
  // 0: all are exposed at once.
  void set(std::span<const float> curve, float rolling);
  // Whether anything is to be blurred.
  bool blurs() const { return !quantiles_.empty(); }
  // For uniform u; `down`: share of the picture's height from its top to the line.
  float time(float u, float down) const;

 private:
  std::vector<float> quantiles_;  // time at equal steps of exposure
  float rolling_ = -1;
};

}  // namespace photon_splat
