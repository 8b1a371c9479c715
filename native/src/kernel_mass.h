// M(x): how much of the kernel around x lies on the surface patch of x.
#pragma once

#include "scene.h"

namespace photon_splat {

// M(x) = integral over the patch of K_h(|x - y|) dA(y) for the Epanechnikov kernel K(s) = 2/pi (1 - s^2), |s| < 1.
// Exact on planar patches (with x on them), from their boundary edges alone: the divergence theorem turns the integral
// into one over edges of G(r) (r.n)/r^2, G(r) = integral of K(s) s ds. On curved patches M = 1 away from boundaries
// (Euclidean ball; exact on spheres) and edges near x count as projected to the tangent plane.
// `normal` is the geometric normal at x, on either side. Never 0: at least kSmallestMass. `exact` tells which case it was.
struct KernelMass {
  float mass;
  bool exact;
};
KernelMass kernel_mass(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x, const Vec3& normal, float h);

inline constexpr float kSmallestMass = 1e-6f;

// Largest kernel radius that the surface's curvature at a triangle allows, m; infinity on planar patches.
float curvature_radius_limit(const Scene& scene, uint32_t instance, uint32_t triangle);

}  // namespace photon_splat
