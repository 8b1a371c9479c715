// Where light leaves a body that it entered: by a random walk in it (Chiang, Kutz and Burley,
// Practical and Controllable Subsurface Scattering for Production Path Tracing, 2016), or by
// Christensen and Burley's profile (Approximate Reflectance Profiles for Efficient Subsurface
// Scattering, 2015). Only the surface of the object itself bounds it.
#pragma once

#include <optional>

#include "bsdf/subsurface.h"
#include "scene/scene.h"

namespace photon_splat {

struct SubsurfaceExit {
  Surface surface;  // as seen from outside, along -way
  Vec3 way;         // unit, out of the body
  Rgb weight;       // what of the light at the entry leaves here: albedo and closure weight too
};

// `carried`: what the path carries, by which channels are chosen. Nothing: the light stays in the
// body, or is lost beyond an open mesh.
std::optional<SubsurfaceExit> scatter_below(const Scene& scene, const Surface& entry,
                                            const Subsurface& closure, const Vec3& wo,
                                            const Rgb& carried, const Vec2& u, Random& random);

// A walk alone, from the entry in the direction `way`. Without the closure's weight.
std::optional<SubsurfaceExit> walk_below(const Scene& scene, const Surface& entry,
                                         const Subsurface& closure, const Vec3& way,
                                         const Rgb& carried, Random& random);

// The same by the profile.
std::optional<SubsurfaceExit> project_below(const Scene& scene, const Surface& entry,
                                            const Subsurface& closure, const Vec2& u,
                                            Random& random);

}  // namespace photon_splat
