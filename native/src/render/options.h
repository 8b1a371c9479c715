// What a render is asked for: one value per question, decided by the plan before build().
#pragma once

#include <cstdint>
#include <string>

namespace photon_splat {

// Whether camera paths take one more bounce before photons light them (final gathering). By trial:
// they do, or they bring all of the indirect light, caustics excepted, where the first pass finds
// that to be less work (GatherTrial).
enum class FinalGather : uint8_t { kOff, kOn, kByTrial };

struct RenderOptions {
  uint64_t photons_per_pass = 200000;  // paths, in each photon map
  int max_bounces = 32;
  float radius_scale = 1;
  float point_spacing = 1.0f / 3.0f;  // of visible points, in kernel radii; 0: one a gather point
  bool boundary_correction = true;
  // A photon map of their own for caustics, where the scene can make them; else in with the others
  bool caustics = true;
  bool force_caustics = false;  // even where it cannot: for tests of what that costs
  bool adaptive_radius = true;
  bool adaptive_samples = true;
  bool occlusion = true;  // inside of discs; part of the boundary correction
  bool fallback = true;   // camera paths go on for indirect light where photons serve badly
  FinalGather final_gather = FinalGather::kOff;
  // Without final gathering: paths bring all of the indirect light, caustics excepted, where a
  // trial finds that photons take little off their noise
  bool tries_paths = false;
  float ambient_distance = 0;  // how far the Ambient Occlusion pass looks, m; 0: there is none
  uint32_t seed = 0;
  std::string kernel{};  // of the splatter; empty: the fastest
  // Of photons that renders of other views find again (begin_again). 0: none, and photons are aimed
  // at what the view sees; else each pass has the same photons and radii whatever the view, beyond
  // this budget traced again.
  size_t kept_photon_bytes = 0;
  float fixed_radius = 0;  // of all discs in all passes, metres; 0: chosen. For comparison

  bool gathers() const { return final_gather != FinalGather::kOff; }
  // Photons serve every view, so nothing about them may depend on this one.
  bool keeps_photons() const { return kept_photon_bytes > 0; }
};

}  // namespace photon_splat
