// M(x): how much of the kernel around x lies on the surface patch of x.
#pragma once

#include "scene/scene.h"

namespace photon_splat {

// M(x) = integral over the patch of w(n_x.n_y) K_h(|x - y|) dA(y), K(s) = 2/pi (1 - s^2) for s < 1
// (Epanechnikov), w as in point_block.h.
// - Planar patch: exact from its boundary edges alone; the divergence theorem turns the integral
// into one over edges of
//   G(r) (r.n)/r^2, G(r) = integral of K(s) s ds. Cost does not grow with tessellation.
// - Bent patch: a sum over its triangles (bent_mass.h).
// - Gently curved patch: the Euclidean ball's mass, 1 (exact on spheres, 1 + h^2/32 (k1 - k2)^2 in
// general), less what lies
//   beyond edges projected to the tangent plane; `exact` is false.
// `normal` is the geometric normal at x, on either side. An exact mass is at least kSmallestMass.
// `narrow` is the mass of the kernel of radius kNarrow * h, found on the way.
struct KernelMass {
  float mass;
  bool exact;
  float narrow;
};
inline constexpr float kNarrow = 0.70710678f;
KernelMass kernel_mass(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x,
                       const Vec3& normal, float h);

// Whether that mass will be exact, told without finding it.
bool has_exact_mass(const Scene& scene, uint32_t instance, uint32_t triangle, float h);

inline constexpr float kSmallestMass = 1e-6f;

// Largest kernel radius that the surface's curvature at a triangle allows, m; infinity on planar
// patches.
float curvature_radius_limit(const Scene& scene, uint32_t instance, uint32_t triangle);
// Width of the patch that a triangle belongs to, m: of a long strip its width, of a disc its
// radius; infinite for closed surfaces.
float patch_width(const Scene& scene, uint32_t instance, uint32_t triangle);

}  // namespace photon_splat
