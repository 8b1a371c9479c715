// What work weighs against other work, where a render has to choose between them. The unit is a
// camera ray with its shading. Each figure is a ratio of times on two cores of a Xeon with AVX-512
// (2026-11-22 and 23), and names the scenes of blend_scenes that it was measured on; choices move
// little if one is off by a third.
#pragma once

namespace photon_splat::cost {

// Photon tracing and splatting: seconds of the stages over those of the camera in cornell_box,
// interior and kitchen.
inline constexpr double kPhotonRays = 3;      // so many rays of photons are one of the camera's
inline constexpr double kShadedPhoton = 1.2;  // a node program that runs where a photon hits
inline constexpr double kSplattedPhoton = 2;  // a photon that is stored, sorted and splatted
inline constexpr double kPointBoundary = 8;   // a visible point with the kernel mass of its disc

// Final gathering against path tracing (GatherTrial): seconds of passes in street and kitchen.
inline constexpr double kGatherRay = 1.5;  // of a path that ends at photons, gather point included
inline constexpr double kGatherPointRay =
    1.25;  // of a path that leaves gather points at its first diffuse surface
inline constexpr double kPhotonPath = 4.5;  // a photon path, kernel masses included

// The smallest pass that there may be beside the first, over the first: what photons pay against. A
// rule of AdaptiveSampler's (PhotonSet::fewest), not a measurement.
inline constexpr double kLeastOfPhotons = 0.25;

// So many photon paths bring about as many photons as there are visible points, and take as much
// memory. Measured on the Cornell box at 960x540, where time then hardly depends on the radius (an
// 8-fold range), and at 128x128 (memory of 10,000 to 100 million photons).
inline constexpr unsigned kPathsPerPoint = 4;

}  // namespace photon_splat::cost
