// How light of a random walk crosses the surface where a camera path enters: refracted by rough
// facets, of which skin has some and scatters the rest diffusely. What facets lose between
// themselves is not lost, as in Cycles: densities integrate to 1.
#pragma once

#include <optional>

#include "bsdf/subsurface.h"
#include "math/sampling.h"

namespace photon_splat {

// Both directions point away from the surface, wi on the other side of it. False: no direction.
bool sample_entry(const Subsurface& closure, const Vec3& wo, Vec2 u, Vec3* wi);
// Its density, 1/sr, of facets that are at least kRough.
float entry_pdf(const Subsurface& closure, const Vec3& wo, const Vec3& wi);
inline constexpr float kRough = 0.05f;

// Backwards, for photons: where light leaves that comes up along -wi. `n`, `ng`: shading and
// geometric normal, outside.
struct Leaving {
  Vec3 wo;
  float pdf;  // 1/sr
};
std::optional<Leaving> sample_leaving(const Subsurface& closure, const Vec3& n, const Vec3& ng,
                                      const Vec3& wi, float choice, const Vec2& u);

}  // namespace photon_splat
