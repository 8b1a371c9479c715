// The camera's half of a pass: camera samples with their direct light, and gather points where
// photons are wanted. A render's first pass also finds out how indirect light is best brought
// (IndirectStrategy).
#pragma once

#include "integrators/camera_tracer.h"
#include "render/photon_budget.h"
#include "render/photon_map.h"
#include "render/view_focus.h"

namespace photon_splat {

using PhotonMaps = std::vector<std::unique_ptr<PhotonMap>>;

class CameraPass {
 public:
  // Makes `lights` sample the world by what this learns of it.
  CameraPass(const RenderContext& context, Lights& lights, const Camera& camera);

  // Another view: all is learnt anew. The film is that of the passes to come.
  void reset_view(const PackedFilm& film, const PhotonMaps& maps);
  // The samples that follow are those of the part alone.
  void begin_part();
  // Camera samples of the pass into `film`, which then holds them alone. The first pass after
  // reset_view() chooses the strategy; a pilot of the indirect photon map is part of that.
  void trace(uint32_t pass, const PhotonMaps& maps, PackedFilm& film,
             const PassClock& clock = PassClock(INFINITY));
  // See CameraTracer. Of light groups no ways are kept apart.
  void follow_bumps(bool follow) { tracer_.follow_bumps(follow && !context_.scene.light_groups); }
  // trace() without a choice of strategy: gather points that all want photons.
  void trace_gather_points(uint32_t pass, const PhotonMaps& maps, PackedFilm& film,
                           CameraTracer::Tiles tiles = CameraTracer::Tiles::kAll);
  void trace_reference(uint32_t sample, PackedFilm& film);
  // For a viewport: one sample per pixel that reads light from a cache.
  void trace_from_cache(const CameraTracer::CacheUse& use, const PhotonMaps& maps,
                        PackedFilm& film);
  void set_beams(const CameraTracer::Beams& beams) { tracer_.set_beams(beams); }
  // How much a sample of this view varies by other light than that of beams of caustics, none of
  // which is set: (W/m^2/sr)^2, in places of little noise.
  double variance_beside_beams(const PhotonMaps& maps);
  // Whether most noise of this view is of light that beams of indirect light would bring into
  // media. All beams but those are set.
  bool wants_indirect_beams(const PhotonMaps& maps);
  // Has a pilot teach the map about the surfaces on which the gather points want its photons.
  void teach(PhotonMap& map);
  // Called after a pass: where things stand in the discs of bent surfaces, paths will bring the
  // light.
  void look_for_crowds(uint32_t pass);

  // Gather points of the last pass; nullptr before it.
  const GatherPoints* gather_points() const { return gather_points_; }
  void forget_gather_points();
  // The ranges of these gather points that belong to each tile of the film.
  const std::vector<size_t>& tile_ranges() const { return tracer_.tile_ranges(); }
  // Whether paths go on anywhere at all.
  bool paths_continue() const {
    return strategy_.has_value() || tracer_.follows_more() || context_.scene.scatters_in_media();
  }
  // Whether camera paths bring all of the map's light, so that it has no photons.
  bool path_traced(const PhotonMap& map) const { return all_path_traced() && !map.caustic(); }
  bool all_path_traced() const {
    return strategy_ && strategy_->kind() == IndirectStrategy::Kind::kPathTraced;
  }
  // In camera rays with their shading, of one sample in each of the film's pixels in the last pass.
  double work_of_samples(const PackedFilm& film) const;
  const CameraTracer& tracer() const { return tracer_; }
  CameraTracer& tracer() { return tracer_; }

 private:
  uint32_t common_seed() const;
  void teach(PhotonMap& map, const SurfaceFilter& seen, bool all_surfaces, bool more = false);
  CameraTracer::MediaTrial try_media(const PhotonMaps& maps, uint64_t each);
  bool try_paths(uint32_t pass, const PhotonMaps& maps, PackedFilm& film, const PassClock& clock);
  void take_for_pilot(double seconds);
  void trace_rest(uint32_t pass, const PassClock& clock, double scouted, const PhotonMaps& maps,
                  PackedFilm& film);
  void sample_for_gathers(const PhotonMaps& maps);
  bool photons_are_few(const PhotonMap& indirect) const;
  void choose(uint32_t pass, bool scouts, const PhotonMaps& maps, PackedFilm& film);
  bool trace_more(uint32_t pass, CameraTracer::Tiles tiles, const PhotonMaps& maps,
                  PackedFilm& film);
  void make_strategy(const PhotonMap& indirect, const SurfaceFilter& known);
  void forget_strategy();
  void want_photons(const PhotonMap& indirect);
  bool photons_pay(const PhotonMap& indirect) const;

  const RenderContext context_;
  Lights& lights_;
  CameraTracer tracer_;
  EnvironmentGuide guide_;
  ViewFocus focus_;
  const GatherPoints* gather_points_ = nullptr;
  std::optional<IndirectStrategy> strategy_;  // none: photons bring all of the indirect light
  bool chosen_ = false;
};

}  // namespace photon_splat
