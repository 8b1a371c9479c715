// The camera's side: paths from the lens through mirrors and glass to surfaces that scatter
// diffusely, direct light on the way, and gather points of what photons are to add later.
#pragma once

#include "film/adaptive_sampler.h"
#include "film/packed_film.h"
#include "integrators/gather_point.h"
#include "integrators/gather_trial.h"
#include "integrators/indirect_strategy.h"
#include "integrators/light_cache.h"
#include "lights/lights.h"
#include "media/media.h"
#include "scene/camera.h"

namespace photon_splat {

// Pixels along the side of a tile, which one thread traces
inline constexpr int kTileSize = PackedFilm::kSide;

class BeamTree;
struct BeamCrossing;

class CameraTracer {
 public:
  CameraTracer(Scene& scene, const Lights& lights, const Camera& camera, uint32_t seed)
      : scene_(scene),
        lights_(lights),
        camera_(camera),
        seed_(seed),
        turned_mirrors_(std::ranges::any_of(scene.programs, &Program::turns_mirrors)) {}

  // Gather points ask for light on bumps: photons are splatted with the ways they come.
  void follow_bumps(bool follow) { follows_bumps_ = follow; }
  // Of the samples from now on.
  void set_seed(uint32_t seed) { seed_ = seed; }

  // Which tiles of the picture one call traces. Scouts: at most an eighth of them, all over it, or
  // all of a small one. Rest: those that have been no scouts; of scouts the pixels with gather
  // points where paths go on by now. Again: the same of all tiles.
  enum class Tiles { kAll, kScouts, kRest, kAgain };

  // The camera samples of pass `pass`, as many as `choice` says, instead of what `film` held;
  // returns the gather points of the pass so far in tile order. Paths go through at most
  // `max_bounces` lobes. Tells `guide` what it has seen of the world, as long as that wants to
  // learn.
  const GatherPoints& trace(uint32_t pass, const AdaptiveSampler& choice, EnvironmentGuide& guide,
                            int max_bounces, PackedFilm& film, const CancelFlag& cancel,
                            Tiles tiles = Tiles::kAll);
  // What the paths of the last call have found for it, if they brought all of the indirect light
  // (IndirectStrategy::Kind::kPathTraced) and were asked to: of photons that light what paths meet
  // first, or after one more bounce.
  enum class Trial { kNone, kDensity, kGather };
  void keep_trial(Trial trial) { trial_ = trial; }
  GatherTrial trial() const;
  // See beam_trial.cpp. With the strategy and the beams that are set.
  struct MediaTrial {
    double share;
    double variance;  // of a sample, of all light: of the pixel that a quarter of all are below
  };
  MediaTrial try_media(uint32_t seed, int max_bounces, uint64_t each, const CancelFlag& cancel);
  // Whether scouts are less than all.
  static bool sends_scouts(const PackedFilm& film);
  static bool scouts(const PackedFilm& film, size_t tile);  // whether the tile is one of them

  // Paths go on for indirect light where `strategy` says so (nullptr: nowhere); with `caustics`
  // photons bring caustics there all the same. `radius_factor`: factor on all radii in the next
  // pass.
  void set_strategy(const IndirectStrategy* strategy, bool caustics, float radius_factor) {
    strategy_ = strategy;
    caustic_photons_ = caustics;
    radius_factor_ = radius_factor;
  }

  // Photon beams that bring light to media, nullptr: paths find it. Of indirect light only where
  // the media are the same everywhere.
  struct Beams {
    const BeamTree *caustic = nullptr, *indirect = nullptr;
  };
  void set_beams(const Beams& beams) { beams_ = beams; }

  // Whether paths go on for the indirect light, where photons bring it, beside what moves: the
  // light there when it is seen may not be that of all times.
  void follow_motion(bool on) { follows_motion_ = on; }
  // The same at surfaces that scatter light through themselves: what is stored there is what
  // diffuse rays see, and things are hidden from those or from rays of transmission alone.
  void follow_translucence(bool on) { follows_translucence_ = on; }
  bool follows_more() const { return follows_motion_ || follows_translucence_; }

  // Distance of the Ambient Occlusion pass, m: how open it is above what pixels show; 0: there is
  // no such pass.
  void look_around(float distance) { ambient_distance_ = distance; }
  // The colours of lobes that are not diffuse are noted.
  void note_lobe_colors(bool noted) { lobe_colors_ = noted; }

  // One sample per pixel of the unbiased path tracer, indirect light included; leaves no gather
  // points.
  void trace_reference(uint32_t sample, int max_bounces, PackedFilm& film,
                       const CancelFlag& cancel);

  // One sample per pixel whose paths read the light of surfaces from a viewport's cache: all but
  // what they mirror sharply, which is followed, and light in media, below surfaces and on strands.
  // Returns the gather points of what the cache does not hold, and of paths that sample light for
  // it.
  struct CacheUse {
    const LightCache* cache = nullptr;
    float pixels = 1;      // of this picture, that cells are wide
    float share = 1;       // of the samples that cells want: so many of them are made; < 0: none
    uint32_t picture = 0;  // its number
  };
  const GatherPoints& trace_from_cache(const CacheUse& use, int max_bounces, PackedFilm& film,
                                       const CancelFlag& cancel);
  // Of tile t, since then. A gather point of a sample has kOfSample in its pixel, and sample_of()
  // is that sample's place among those of its tile.
  const std::vector<CacheReading>& readings(size_t t) const { return tiles_[t].readings; }
  std::vector<CacheSample>& cache_samples(size_t t) { return tiles_[t].cache_samples; }
  double cache_samples_wanted() const;
  static constexpr uint32_t kOfSample = 1u << 31;
  static uint32_t sample_of(uint32_t pixel) { return pixel & (kMostSamples - 1); }

  uint64_t rays() const { return rays_; }
  uint64_t last_rays() const { return last_rays_; }  // of the last pass
  // Samples whose light was not finite and was left out: 0 unless something is wrong.
  uint64_t bad_samples() const { return bad_samples_; }
  // Places where indirect light was wanted, over all calls of trace(), and those of them where
  // paths went on for it.
  uint64_t places() const { return places_; }
  uint64_t continued() const { return continued_; }
  uint64_t last_continued() const { return last_continued_; }  // of the last call
  // GatherPoints of tile t are [tile_ranges()[t], tile_ranges()[t + 1]); no two tiles share a
  // pixel.
  const std::vector<size_t>& tile_ranges() const { return ranges_; }
  // Gives back the memory of gather points: no pass follows.
  void forget_gather_points();

 private:
  struct Tile {
    std::vector<GatherPoint> gather_points;
    std::vector<EnvironmentGuide::Sighting> sightings;
    uint64_t rays = 0, bad_samples = 0, places = 0, continued = 0;
    std::vector<GatherPoint> kept;  // while some pixels are traced again: all there were
    std::vector<uint8_t> changed;   // for the first of each pixel, whether that is among them
    bool again = false;             // whether that is so
    GatherTrial trial;
    // For the trial: luminance in each pixel that photons would have brought
    std::vector<float> deep;
    // Variances of one sample of each pixel: of all light, and without that
    std::vector<std::pair<float, float>> variances;
    uint64_t deep_rays = 0;
    RadiusMap::Memory near;  // what `strategy_` was asked last
    std::vector<CacheReading> readings;
    std::vector<CacheSample> cache_samples;
    double cache_samples_wanted = 0;
    void clear();
  };
  struct Path;
  enum class Passing { kStays, kPasses, kAbsorbed };
  struct Job {
    uint32_t pass;
    const AdaptiveSampler* choice;  // none: one sample
    int max_bounces;
    bool leaves_gather_points;
    Tiles tiles = Tiles::kAll;
    bool learns = false;
    uint32_t learning_share = 1;  // of the pixels, 1 in so many
    bool reads_light = false;     // see trace_from_cache()
  };
  static constexpr uint32_t kMostSamples = 1 << 12;  // of light, in a tile
  void trace_tiles(const Job& job, PackedFilm& film, const CancelFlag& cancel);
  void trace_tile(const Job& job, size_t t, PackedFilm& film);
  bool find_changed(Tile& tile) const;
  const GatherPoints& join_gather_points(const CancelFlag& cancel);
  static void see_trial(Tile& tile, const PackedFilm::Tile& pixels, int width, int height);
  void trace_pixel(const Job& job, int x, int y, PackedFilm& film, Pixel& pixel, Tile& tile) const;
  void trace_path(Path& path) const;
  // passed: the surface that it has just passed, if it has.
  void follow(Path& path, Surface passed = {}) const;
  bool meet_surface(Path& path, const Surface& hit) const;
  bool seen_clearly(const Path& path) const;
  bool catches(const Path& path, const Surface& hit) const;
  void catch_shadows(Path& path, const Surface& hit) const;
  // A surface whose light has been gathered, for the path's next way from there.
  struct Meeting {
    Receiver receiver;
    bool continued;  // the path goes on for light that photons were to bring
  };
  bool meet(Path& path, const Surface& hit, Bsdf& bsdf) const;
  Meeting light(Path& path, const Surface& hit, Bsdf& bsdf) const;
  bool read_light(Path& path, const Surface& hit, const Bsdf& bsdf) const;
  bool wants_sample(Path& path, const LightCache::Place& place, const CacheLight& albedo) const;
  void sample_light(Path& path, const Surface& hit, Bsdf bsdf, const LightCache::Place& place,
                    const CacheLight& albedo) const;
  bool go_on(Path& path, const Surface& hit, const Bsdf& bsdf, const Meeting& meeting) const;
  bool meet_body(Path& path, const Surface& hit, Bsdf& bsdf) const;
  bool go_below(Path& path, const Surface& hit, const Bsdf& bsdf) const;
  Vec3 exit_normal(const Path& path, const Surface& exit, const Vec3& wo) const;
  static void add_indirect(Path& path, const Rgb& light, const Rgb& diffuse_part);
  void add_met(Path& path, const Rgb& radiance, Rgb& seen,
               int16_t light_group = kNoLightGroup) const;
  void add_lamps(Path& path, float far) const;
  void add_linked(Path& path) const;
  void add_world(Path& path) const;
  Rgb world_seen(const Path& path) const;
  void add_world_by_ray(Path& path, const Rgb& light) const;
  void add_emission(Path& path, const Surface& hit, const Rgb& emission) const;
  void add_unlike_photons(Path& path, const Surface& hit, const Rgb& emission) const;
  void add_found_emission(Path& path, const Surface& hit, const Rgb& emission) const;
  Rgb show_features(Path& path, const Bsdf& bsdf) const;
  void end_features(Path& path, const Bsdf& bsdf, const Rgb& mirrored) const;
  void show_first(Path& path, const Surface& hit, const Bsdf& bsdf) const;
  void show_depth(Path& path, const Surface& hit) const;
  void show_depth_behind(Path& path, Surface hit) const;
  void add_ambient_occlusion(Path& path, const Surface& hit, const Bsdf& bsdf) const;
  void pass_glass(Path& path) const;
  enum class InMedium { kNothing, kScattered, kAbsorbed };
  InMedium pass_media(Path& path, const Surface* hit, float far) const;
  void add_emission_of_media(Path& path, const Rgb& emission) const;
  InMedium split_in_medium(Path& path, const MediumPoint& medium, const Surface* hit, float far,
                           bool single) const;
  bool sees_beams(const Path& path) const;
  bool beams_bring_all(const Path& path) const;
  void add_beams(Path& path, float far) const;
  void add_beams(Path& path, float far, const BeamTree& tree, float weight) const;
  float kernel_share(const Path& path, const BeamCrossing& at) const;
  bool add_single_scattering(Path& path, float far) const;
  bool scatter_in_medium(Path& path, const Flight& flight, bool direct) const;
  void add_direct_in_medium(Path& path, const MediumPoint& point, const Receiver& receiver) const;
  void add_light_in_medium(Path& path, const MediumPoint& point, const Receiver& receiver,
                           const LightSample& light) const;
  Passing pass_through(Path& path, const Surface& hit, const Bsdf& bsdf) const;
  void add_direct(Path& path, const Surface& hit, const Bsdf& bsdf, const Receiver& receiver) const;
  void add_first_direct(Path& path, const Surface& hit, const Bsdf& bsdf,
                        const Receiver& receiver) const;
  void add_light(Path& path, const Surface& hit, const Bsdf& bsdf, const Receiver& receiver,
                 const LightSample& light, bool world) const;
  void see_world(Path& path, const Receiver& from, const Vec3& direction, const Rgb& light,
                 bool ray) const;
  bool passes_below(const Surface& hit, const Vec3& to_light) const;
  // `offset`: off the surface, m
  Vec3 shadow_origin(const Surface& hit, const Vec3& direction, const Path& path,
                     float offset) const;
  Rgb light_through(const LightSample& light, const Surface& hit, Path& path) const;
  Rgb transmittance(const Vec3& origin, const Vec3& direction, float far, const RayInfo& ray,
                    uint64_t blockers, const MediumStack& media, Random& random) const;
  static void see_deep(const Path& path, const Rgb& light);
  Vec3 place_of(const Path& path, const Surface& hit) const;
  bool brings_all() const {
    return strategy_ && strategy_->kind() == IndirectStrategy::Kind::kPathTraced;
  }
  bool continues(Path& path, const Surface& hit, const Bsdf& bsdf) const;
  void leave_gather_points(Path& path, const Surface& hit, const Bsdf& bsdf,
                           bool caustics_only) const;
  bool scatter(Path& path, const Surface& hit, const Bsdf& bsdf, const Receiver& receiver,
               bool continued) const;
  void look_for_turned_mirrors(const Path& path, const Surface& hit, const Bsdf& bsdf) const;
  void seek_turned_mirror(Path& path) const;

  Scene& scene_;
  const Lights& lights_;
  const Camera& camera_;
  uint32_t seed_;
  std::vector<Tile> tiles_;
  GatherPoints gather_points_;
  std::vector<size_t> ranges_;
  uint64_t rays_ = 0, last_rays_ = 0, bad_samples_ = 0, places_ = 0, continued_ = 0,
           last_continued_ = 0;
  const IndirectStrategy* strategy_ = nullptr;
  Beams beams_;
  CacheUse cache_use_;
  bool caustic_photons_ = false, follows_motion_ = false, follows_translucence_ = false;
  Trial trial_ = Trial::kNone;
  float radius_factor_ = 1, ambient_distance_ = 0;
  bool lobe_colors_ = false;
  bool turned_mirrors_;  // there may be some
  bool follows_bumps_ = false;
};

}  // namespace photon_splat
