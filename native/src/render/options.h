// What a render is asked for: one value per question, decided by the plan before build().
#pragma once

#include <cstdint>
#include <string>

#include "render/render_part.h"

namespace photon_splat {

// What brings indirect light: photons where camera paths first meet a diffuse surface, or after one
// more bounce (final gathering). "Or paths": a trial in the first pass (GatherTrial) may find that
// it is less work if camera paths bring all of it, caustics excepted. Any: photons or paths, and
// final gathering where a pilot finds that few photons arrive.
enum class IndirectLight : uint8_t {
  kPhotons,
  kPhotonsOrPaths,
  kAny,
  kFinalGather,
  kFinalGatherOrPaths
};

struct RenderOptions {
  uint64_t photons_per_pass = 200000;  // paths, in each photon map
  int max_bounces = 32;
  float radius_scale = 1;
  float point_spacing = 1.0f / 3.0f;  // of visible points, in kernel radii; 0: one a gather point
  bool boundary_correction = true;
  // A photon map of their own for caustics, where the scene can make them; else in with the others
  bool caustics = true;
  bool adaptive_radius = true;
  bool adaptive_samples = true;
  bool occlusion = true;          // inside of discs; part of the boundary correction
  bool adaptive_indirect = true;  // camera paths go on for indirect light where photons serve badly
  IndirectLight indirect_light = IndirectLight::kPhotons;
  // One camera sample per pixel where there would be more, for pictures that are looked at before
  // they are done
  bool short_passes = false;
  float ambient_distance = 0;  // how far the Ambient Occlusion pass looks, m; 0: there is none
  uint32_t seed = 0;
  std::string kernel{};  // of the splatter; empty: the fastest
  // Memory for photons that renders of other views find again (begin_again). 0: none, and photons
  // are aimed at what the view sees; else each pass has the same photons and radii whatever the
  // view, and traces those beyond this budget again.
  size_t kept_photon_bytes = 0;
  RenderPart part{};
  float fixed_radius = 0;  // of all discs in all passes, metres; 0: chosen. For comparison

  bool gathers() const { return indirect_light >= IndirectLight::kFinalGather; }
  bool tries_paths() const {
    return indirect_light == IndirectLight::kPhotonsOrPaths ||
           indirect_light == IndirectLight::kAny ||
           indirect_light == IndirectLight::kFinalGatherOrPaths;
  }
  // Photons serve every view, so nothing about them may depend on this one.
  bool keeps_photons() const { return kept_photon_bytes > 0; }
};

}  // namespace photon_splat
