// What work weighs against other work, where a render has to choose between them. The unit is a
// camera ray with its shading. Figures are of two cores of a Xeon with AVX-512; only their ratios
// count, and choices move little if one is off by a third.
#pragma once

namespace photon_splat::cost {

// Of photon tracing and splatting: measured on cornell_box, interior and kitchen.
inline constexpr double kPhotonRays = 3;      // so many rays of photons are one of the camera's
inline constexpr double kShadedPhoton = 1.2;  // a program that runs at a photon's hit
inline constexpr double kSplattedPhoton = 2;  // a photon that is stored, sorted and splatted
inline constexpr double kPointBoundary = 8;   // a visible point with the boundary of its disc

// Of a trial between final gathering and path tracing: measured on street and kitchen.
inline constexpr double kGatherRay =
    1.5;  // one of a path that ends at photons, gather point included
inline constexpr double kGatherPointRay =
    1.25;  // one of a path that leaves gather points at its first diffuse surface
inline constexpr double kPhotonPath = 4.5;  // a photon path, with its part of boundaries

// Of the smallest pass that there may be, beside the first: what photons pay against.
inline constexpr double kLeastOfPhotons = 0.25;

// So many photon paths bring about as many photons as there are points, and take as much memory.
inline constexpr unsigned kPathsPerPoint = 4;

}  // namespace photon_splat::cost
