// Where light leaves a body that it entered: by a random walk in it (Chiang, Kutz and Burley,
// Practical and Controllable Subsurface Scattering for Production Path Tracing, 2016), or by
// Christensen and Burley's profile (Approximate Reflectance Profiles for Efficient Subsurface
// Scattering, 2015). Only the surface of the object itself bounds it.
#pragma once

#include <optional>

#include "bsdf/subsurface.h"
#include "scene/scene.h"

namespace photon_splat {

// Random numbers of a walk; of the first steps, where there are, from a low-discrepancy sequence.
class WalkNumbers {
 public:
  explicit WalkNumbers(Random& random) : random_(random) {}
  WalkNumbers(Random& random, uint32_t sample, uint32_t seed, uint32_t first, uint32_t end)
      : random_(random), sample_(sample), seed_(seed), pair_(first), end_(end) {}

  Vec2 next2() { return pair_ < end_ ? sobol_2d(sample_, pair_++, seed_) : random_.next2(); }
  float next() { return random_.next(); }

 private:
  Random& random_;
  uint32_t sample_ = 0, seed_ = 0, pair_ = 0, end_ = 0;
};

struct SubsurfaceExit {
  Surface surface;  // as seen from outside, along -way
  Vec3 way;         // unit, out of the body
  Rgb weight;       // what of the light at the entry leaves here: albedo and closure weight too
};

// `carried`: what the path carries, by which channels are chosen. Nothing: the light stays in the
// body, or is lost beyond an open mesh.
std::optional<SubsurfaceExit> scatter_below(const Scene& scene, const Surface& entry,
                                            const Subsurface& closure, const Vec3& wo,
                                            const Rgb& carried, WalkNumbers& numbers,
                                            float time = kShutterCentre);

// A walk alone, from the entry in the direction `way`. Without the closure's weight.
std::optional<SubsurfaceExit> walk_below(const Scene& scene, const Surface& entry,
                                         const Subsurface& closure, const Vec3& way,
                                         const Rgb& carried, WalkNumbers& numbers,
                                         float time = kShutterCentre);

// The exit by Burley's profile instead of a walk.
std::optional<SubsurfaceExit> project_below(const Scene& scene, const Surface& entry,
                                            const Subsurface& closure, WalkNumbers& numbers,
                                            float time = kShutterCentre);

}  // namespace photon_splat
