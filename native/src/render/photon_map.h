// Photons of one kind, the visible points they are splatted on, and what is known of both: indirect
// light has a photon map, caustics have another one where something in the scene can make them.
#pragma once

#include <memory>
#include <optional>

#include "density/adaptive_radius.h"
#include "density/splatter.h"
#include "photons/photon_cache.h"
#include "photons/viewport_photons.h"
#include "render/context.h"
#include "render/light_group_sums.h"

namespace photon_splat {

// What a pilot is to teach.
struct PilotTask {
  const SurfaceFilter& useful;         // surfaces on which photons are wanted
  bool all_surfaces = false;           // radii of the others as well: they may turn out to be seen
  const SeenPlaces* places = nullptr;  // where photons are wanted; none: all over those surfaces
  bool more = false;                   // than the task before, which was of the same view
  Vec3 middle{};
  float reach = INFINITY;  // half of what is seen is no further from the middle, m
};

class PhotonMap {
 public:
  // `viewer`: who is to see what the photons leave; nullptr where they serve every view.
  PhotonMap(const RenderContext& context, const Lights& lights, const Camera* viewer,
            PhotonStream stream, size_t number);

  PhotonStream stream() const { return stream_; }
  bool caustic() const { return stream_ == PhotonStream::kCaustic; }
  // Another view: passes begin anew, with a pilot of their own where photons are aimed at it.
  void reset_view(int width, int height);
  // What an earlier generation has known of the radii, after reset_view().
  void set_radii_known(std::vector<AdaptiveRadius::Known> known);
  std::vector<AdaptiveRadius::Known> radii_known() const { return adaptive_radius_.known(); }
  // The passes that follow are those of a part: paths begin anew, and what has been learnt stays.
  void begin_part();
  // Another render of the same scene: counts begin anew, kept photons stay.
  void begin_again();

  // --- the stages of a pass, in this order ---

  // Traces a pilot, which tells where useful photons start and how dense they land. Once for a view
  // or, where photons serve all of them, once.
  void learn(const PilotTask& task);
  bool learnt() const { return radii_ != nullptr; }
  // The surfaces on which gather points want these photons; nullptr: all.
  SurfaceFilter wanted_on(const GatherPoints* gather_points) const;
  // Visible points for the gather points of the pass, with radii and kernel masses; sums 0.
  void place_points(const GatherPoints& gather_points, uint32_t pass);
  void clear_points();
  // What a pass shows of these gather points' pixels before photons add to it.
  void see_light(const GatherPoints& gather_points, const PackedFilm& pass);
  // Photon paths [first, first + count) of the pass: a batch, kept until the next one.
  void trace(uint64_t first, uint64_t count);
  // Instead of trace(): photons made elsewhere.
  void set_photons(Photons photons);
  // Adds the batch to the points.
  void splat();
  // Kernel masses of the points that the batch has reached, after a splatter elsewhere; splat()
  // calls it itself.
  void find_masses();
  // Instead of splat(), for a splatter elsewhere: which of the photons [first, first + count) of
  // the batch each block may catch. That splatter writes its sums into points().blocks().
  const Splatter& find_pairs(size_t first, size_t count);
  // No more photons come in this pass than `paths` paths have brought: their light counts for all.
  void end_photons(uint64_t paths);
  void join_light_groups() { groups_.join(points_.blocks()); }
  // Adds the points' irradiance to the pixels of the gather points: of those that paths have left
  // after a gather, whose noise is the camera's, or of all others. `ranges`: of the gather points
  // by the film's tiles. Returns how many of them had light that is not finite, which is left out.
  uint64_t add_to_film(const GatherPoints& gather_points, const std::vector<size_t>& ranges,
                       bool after_gather, PackedFilm& film);
  void adapt_radii();  // to what the pass has shown
  void end_pass();     // the next pass has other paths

  // --- for a viewport: photons that serve every view ---

  // Traces `paths` more of them, up to `most_bytes` in memory.
  void trace_viewport_photons(uint64_t paths, size_t most_bytes);
  // Points for these gather points with the light of all of those photons.
  void place_viewport_points(const GatherPoints& gather_points);
  // What the points bring to gather point i, if it wants this light: radiance times what its path
  // makes of it.
  Rgb light_at(const GatherPoints& gather_points, size_t i) const;
  const std::optional<ViewportPhotons>& viewport_photons() const { return viewport_photons_; }

  // Photon paths of a pass: one at the least where there are any, as a pass without them would lack
  // their light.
  uint64_t paths_per_pass() const;
  uint64_t first_pass_paths() const { return first_pass_paths_; }
  uint64_t paths_done() const { return first_path_; }  // of the passes of this render
  double photons_per_disc() const { return photons_per_disc_; }
  // On all radii in the pass to come: the user's scale, and shrinking over passes.
  float radius_factor() const;
  const RadiusMap& radii() const { return *radii_; }
  const VisiblePoints& points() const { return points_; }
  PointBlocks& blocks() { return points_.blocks(); }
  const Photons& photons() const { return *batch_; }
  PhotonTracer& tracer() { return tracer_; }
  // Work of the last pass, in the unit of the cost model.
  double work() const;
  // Likewise, of a first pass by what the pilot has just shown.
  double pilot_work_per_pass() const;
  // Photons of equal power that would be as noisy as those of a first pass, by the pilot.
  double effective_photons() const { return effective_photons_; }
  // Those of a first pass on the surfaces that want them, by the pilot.
  double useful_photons() const { return useful_photons_; }
  uint64_t rays() const { return tracer_.counts().rays - before_.rays; }
  const std::string& kernel_name() const { return splatter_->kernel_name(); }
  PhotonMapStatistics statistics() const;

  std::optional<double> seconds_per_path;  // of the last batch: what a time limit is kept by

 private:
  // W/m^2, of a visible point, on the normal that the gather point wants it on.
  Rgb irradiance_on(const GatherPoint& at, uint32_t point) const;
  const RenderContext context_;
  const Camera* viewer_;
  PhotonStream stream_;
  size_t number_;
  double photons_per_disc_;  // wanted from one pass, before radii shrink
  uint32_t seed_;            // of what is learnt; passes have that of the part
  uint64_t first_pass_paths_;
  const Lights& lights_;
  PhotonTracer tracer_;
  std::unique_ptr<RadiusMap> radii_;
  double effective_photons_ = 0, useful_photons_ = 0;
  float dispersion_ = 1;  // of the power of caustic photons: their noise over that of equal ones
  std::unique_ptr<Splatter> splatter_;
  VisiblePoints points_;
  std::vector<float> light_beside_;  // LightBeside::luminance
  const GatherPoints* gather_points_ = nullptr;
  uint64_t traced_in_pass_ = 0;  // paths so far; 0 where photons were made elsewhere
  LightGroupSums groups_;
  AdaptiveRadius adaptive_radius_;
  std::optional<ViewportPhotons> viewport_photons_;
  std::optional<Splatter> viewport_splatter_;  // of them alone
  PhotonCache cache_;                          // of the passes' photons, for renders of other views
  // The last batch
  const Photons* batch_ = &given_;
  const std::vector<int16_t>* batch_groups_ = &no_groups_;  // of those photons, or empty
  Photons given_;
  const std::vector<int16_t> no_groups_;
  uint64_t batch_paths_ = 0;
  // In this render
  PhotonCounts pilot_{}, before_{};  // of the pilot; of the tracer when it began
  uint64_t used_ = 0, reused_ = 0;   // photons handed to the splatter; of those, kept ones
  uint64_t batch_photons_ = 0;
  uint64_t first_path_ = 0;  // of this pass: so many were of the passes before
};

}  // namespace photon_splat
