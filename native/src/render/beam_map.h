// Photons in media, caustic ones or the others: beams of each pass, traced before its camera paths,
// which see them on their way.
#pragma once

#include <optional>

#include "media/beam_tree.h"
#include "photons/photon_tracer.h"
#include "render/context.h"

namespace photon_splat {

class BeamMap {
 public:
  BeamMap(const RenderContext& context, const Lights& lights, const Camera& viewer, BeamLight light,
          PhotonStream stream);

  // Another view or another render of the same scene: passes begin anew.
  void begin_again();
  // The passes that follow are those of a part: paths begin anew, and what has been learnt stays.
  void begin_part();
  // As a few paths tell, the first time that it is asked.
  double beams_per_path();
  // Before the first pass: how much a camera sample varies by other light, (W/m^2/sr)^2. Beams are
  // looked at as closely as is worth it beside that.
  void set_variance_beside(double variance) { variance_beside_ = variance; }
  bool learnt() const { return tree_.learnt(); }
  // The beams of the next pass; the first time a pilot chooses radii.
  void trace_pass();
  const BeamTree& tree() const { return tree_; }
  // In this render, without the pilot.
  PhotonCounts counts() const { return since(before_, tracer_.counts()); }

 private:
  void learn();

  const RenderContext context_;
  const Camera& viewer_;
  PhotonTracer tracer_;
  BeamTree tree_;
  uint32_t seed_;
  bool smooth_;                  // light that is not caustic
  uint64_t most_paths_, paths_;  // of a pass
  double variance_beside_ = 0;   // 0: not known
  std::optional<double> beams_per_path_;
  uint64_t passes_ = 0, first_path_ = 0;
  PhotonCounts before_{};
};

}  // namespace photon_splat
