// All lights of a scene: sampled from a point and met by rays (light_sampler.cpp, linking.cpp), and
// as starting places of photons (photon_emitter.cpp, photon_aiming.cpp). What a light of one kind
// is stands in a file of its own: lamp.h, mesh_light.h, environment.h.
//
// To add a kind of lamp: LampKind and the functions of lamp.h, a file with them, and a line in each
// switch over LampKind.
#pragma once

#include <optional>
#include <span>

#include "lights/close_light.h"
#include "lights/emission/emission_discs.h"
#include "lights/environment.h"
#include "lights/environment_guide.h"
#include "lights/lamp.h"
#include "lights/light_tree.h"
#include "lights/mesh_light.h"
#include "lights/near_lamps.h"

namespace photon_splat {

// Something that emits: a lamp or an emissive instance. `importance` over squared distance ranks
// them.
struct Emitter {
  int lamp = -1;
  uint32_t instance = 0;
  Vec3 center;
  float radius = 0;  // bounding sphere
  Bounds bounds;
  float importance = 0;
  uint64_t lit_groups = ~uint64_t{0}, blockers = ~uint64_t{0};
  int16_t light_group = kNoLightGroup;
  RayMask seen_by = kAllRays;
  uint32_t max_bounces = ~0u;
  bool met_by_rays = true, casts_shadows = true;
  double power = 0;
  // Flux of a sun through a surface that faces it, mean over RGB, W/m^2
  double parallel_flux = 0;
  bool exact = false;      // a lamp that lies in a surface: lights_in_surfaces.cpp
  float past_surface = 1;  // of a mesh's light, where it lies in a surface
  float over_share = 0;    // one over its share of all lights' power
  MeshLight mesh{};        // of an instance
};

struct AlongWay;

class Lights {
 public:
  Lights(Scene& scene, const std::vector<LampSettings>& lamps);

  // A light that lies in the plane of a surface: an area lamp, by its number among those given, or
  // an emissive instance; and the instance of the surface.
  struct InSurface {
    int32_t lamp;       // -1: none
    uint32_t emissive;  // where it is none
    uint32_t instance;
  };
  const std::vector<InSurface>& in_surfaces() const { return in_surfaces_; }
  // Whether something opaque stands between `origin` and a place on such a lamp, to the last bit of
  // the distance.
  bool blocked_exactly(uint32_t emitter, const Vec3& origin, const Vec3& place, float time,
                       RayMask kinds = kAllRays) const;

  // One light sample; nullopt when no light reaches the place.
  std::optional<LightSample> sample(const Receiver& to, float choice, const Vec2& u) const;

  // Where along a ray between `near` and `far` (which may be infinite) light of lamps and of
  // emissive meshes had better be scattered: in proportion to the inverse squared distance of one
  // of them (equiangular sampling: Kulla and Fajardo, Importance Sampling Techniques for Path
  // Tracing in Participating Media, 2012). Nothing where there are none to aim at.
  struct AlongRay {
    float distance, pdf;  // 1/m
  };
  std::optional<AlongRay> sample_along(const Vec3& origin, const Vec3& direction, float near,
                                       float far, float choice, float u) const;
  // Whether that is all of the light that media scatter.
  bool all_near() const { return along_.size() == emitters_.size() && environment_.black(); }
  // Density of sample_along() at `distance`, 1/m; none where there is nothing to aim at.
  std::optional<float> pdf_along(const Vec3& origin, const Vec3& direction, float near, float far,
                                 float distance) const;

  // Sample `i` of to.world_samples, of one world altogether, where the guide has learnt how to see
  // it from there; `sample` then leaves the world out. The numbers are those of all of them.
  std::optional<LightSample> sample_world(const Receiver& to, uint32_t i, const Vec2& u) const;
  // Lives as long as it is used here; none at first.
  void set_guide(const EnvironmentGuide* guide) { guide_ = guide; }
  const EnvironmentGuide::Cell* guide_at(const Vec3& x, const Vec3& n) const {
    return guide_ && !world_by_rays() ? guide_->find(x, n) : nullptr;
  }

  // True when a BSDF-sampled ray could add light that `sample` leaves to it (world, lights near
  // by).
  bool wants_bsdf_ray(const Receiver& to) const;

  // Share of a BSDF-sampled direction in the emission of an emissive surface hit by a ray from the
  // receiver. `bsdf_pdf`: solid angle; infinity for deltas, which no light sample can find. 0 for
  // what linked_met() finds.
  float surface_mis_weight(const Receiver& to, const Surface& hit, float bsdf_pdf) const;

  // Radiance of the lamps that a ray meets between `near` and `far`, weighted as above; without
  // those of linked_met(). Here and below `groups`, if any, get what is returned.
  // `attenuation`: where there are media.
  Rgb lamps_met(const Receiver& to, const Vec3& direction, float near, float far, float bsdf_pdf,
                GroupLight* groups = nullptr, const Attenuation* attenuation = nullptr) const;
  // Whether some light passes through what blocks others: then linked_met() adds the light of
  // those, lamps and surfaces alike, that comes to the receiver against a ray from `origin`,
  // through whatever does not block it, weighted as above.
  bool shadow_linked() const { return !shadow_linked_.empty(); }
  // Whether some scattered rays see a lamp or the world and others do not.
  bool hide_from_some() const { return hide_from_some_; }
  // Some rays see the world otherwise than others.
  bool world_asks() const {
    return environment_.asks_ray() || hides_from_some(scene_.world_seen_by);
  }
  // Something lets rays of shadows pass and not others, or the other way round: then it shows which
  // part of the world's light comes by light samples and which by rays of BSDFs, and each gets its
  // part as in Cycles.
  bool world_shares() const { return !environment_.constant() && scene_.shadows_differ(); }
  // Of an even world all of it comes by rays.
  bool world_by_rays() const { return environment_.constant() && scene_.shadows_differ(); }
  // The part of rays. `ray_pdf`: Bsdf::ray_pdf(); infinity for deltas.
  float ray_share_of_world(const Vec3& direction, float ray_pdf) const;
  // The same of a lamp, where Emitter::lamp is one; 0 where such rays do not find it.
  float ray_share_of_lamp(uint32_t emitter, const Receiver& to, const Vec3& direction,
                          float ray_pdf) const;
  // Of the light of a lamp without shadow, behind what would block it: what light samples bring;
  // rays that look for it end there, as in Cycles. 0 for deltas.
  float unshadowed_share(uint32_t emitter, const Receiver& to, const Vec3& direction,
                         float ray_pdf) const;
  // Of light samples of the world about as Cycles takes them, which has none of one that is the
  // same everywhere; for Bsdf::diffuse_share().
  float world_density(const Vec3& direction) const;
  // `through`: what comes through up to there, past all but these blockers.
  using Through = std::function<Rgb(float far, uint64_t blockers)>;
  Rgb linked_met(const Receiver& to, const Vec3& origin, const Vec3& direction, float bsdf_pdf,
                 const RayInfo& ray, const Through& through, GroupLight* groups = nullptr) const;
  // Radiance of the world in a direction that a ray from the receiver left the scene in, weighted
  // likewise.
  Rgb world_met(const Receiver& to, const Vec3& direction, float bsdf_pdf) const;
  // lamps_met() for a camera ray, without MIS weights: only lamps that the camera may see.
  Rgb lamps_seen(const Vec3& origin, const Vec3& direction, float near, float far, float time,
                 GroupLight* groups = nullptr, const Attenuation* attenuation = nullptr) const;

  const Environment& environment() const { return environment_; }
  // No photons bring the light of such a world: camera paths do, beside what photons bring of
  // others.
  bool world_by_paths() const { return environment_.asks_depth() && !environment_.black(); }
  // Photons of suns and of the world start about what is seen, of which half lies within `radius`
  // of `center`, and fewer everywhere else. To be called before any photon is emitted, guided or
  // aimed.
  void focus(const Vec3& center, float radius);
  bool focused() const { return discs_.focused(); }

  const Scene& scene() const { return scene_; }
  const EmissionDiscs& discs() const { return discs_; }
  const std::vector<Lamp>& lamps() const { return lamps_; }
  // In the order of power_cdf(), where the world comes last.
  const std::vector<Emitter>& emitters() const { return emitters_; }
  const std::vector<double>& power_cdf() const { return power_cdf_; }
  // W, mean over RGB; these change with focus().
  const double& total_power() const { return total_power_; }
  const double& world_power() const { return world_power_; }
  const float& over_world_share() const { return over_world_share_; }

 private:
  // Up to here every emitter is ranked at every point
  static constexpr size_t kFewEmitters = NearLamps::kMost;
  // Surfaces that lie in the plane of a light or so close to it that light samples might pass them.
  struct Closeness {
    int found = 0, within_rounding = 0;
    uint32_t instance = 0;  // of one within rounding
    void add(const Scene& scene, const Vec3& place, const Surface& s, float gap);
    bool in_surface() const;
    bool near_surface() const;
  };
  Closeness closeness(const Lamp& lamp) const;
  Closeness closeness(const Emitter& mesh) const;
  void find_lights_in_surfaces();
  // How far off such a lamp may be found before something `far` off
  float reach_of_exact(float far) const;
  void add_lamp(const LampSettings& settings);
  void add_emissive_instances(ThreadPool& pool);
  bool is_emissive(const Instance& instance) const;
  std::optional<Emitter> emitter_of(uint32_t number, ThreadPool* pool) const;
  void choose_along();
  void place_lamps();
  std::span<const AlongWay> ways_to_emitters(const Vec3& origin, const Vec3& direction, float near,
                                             float far, std::span<AlongWay> room) const;
  float emitter_weight(const Emitter& e, const Receiver& to) const;
  bool shares_with_rays(const Emitter& e, const Receiver& to) const;
  struct Pick {
    uint32_t emitter;
    float probability;
  };
  std::optional<Pick> pick_of_many(const Receiver& to, float weight, float choice) const;
  void build_tree();
  Rgb lamp_met(uint32_t emitter, const Receiver& to, const Vec3& direction, float near, float far,
               float bsdf_pdf, float* distance = nullptr) const;
  float mesh_mis_weight(uint32_t emitter, const Receiver& to, const Surface& hit,
                        float bsdf_pdf) const;
  // Probability of an emitter among all emitters
  float choice_probability(uint32_t emitter, const Receiver& to) const;
  float emitters_weight(const Receiver& to) const;  // of all together
  float world_probability(const Receiver& to, float emitters_weight) const;
  float guided_pdf(const EnvironmentGuide::Cell& cell, const Environment::Density& density) const;
  float mean_of_program(const Lamp& lamp) const;
  bool sample(const Receiver& to, float choice, Vec2 u, LightSample& out) const;
  // `by_cosine`: in proportion to the receiver's cosine.
  bool sample_lamp(const Emitter& e, const Receiver& receiver, const Vec2& u, LightSample& out,
                   bool& by_cosine) const;
  bool sample_mesh(const Emitter& e, const Receiver& receiver, const Vec2& u, LightSample& out,
                   bool& by_cosine) const;
  // `pdf` is that of sample_lamp for this direction; 0 where the lamp is not met, else `distance`
  // (if any) says where.
  Rgb lamp_radiance_met(const Lamp& lamp, const Vec3& origin, const Vec3& direction, float near,
                        float far, float& pdf, float* distance = nullptr) const;
  void share_power();
  // False where the emitter is to be sampled by area.
  bool see_close(const Emitter& e, const Receiver& to, CloseLight& out) const;

  const Scene& scene_;
  Environment environment_;
  EmissionDiscs discs_;
  const EnvironmentGuide* guide_ = nullptr;
  std::vector<Lamp> lamps_;
  std::vector<Emitter> emitters_;
  std::vector<int32_t> emitter_of_instance_;  // -1: none
  LightTree tree_;                            // of many emitters all but suns; of few: empty
  NearLamps near_lamps_;                      // of few: by their numbers
  // Emitters of the tree's items; suns among many emitters
  std::vector<uint32_t> tree_emitters_, suns_;
  std::vector<int32_t> tree_item_;       // of an emitter; -1: a sun
  std::vector<uint32_t> visible_lamps_;  // emitters that the camera may see
  std::vector<uint32_t> along_;          // those that rays through media ask
  bool hide_from_some_ = false;
  std::vector<uint32_t> shadow_linked_;  // emitters whose light not everything blocks
  std::vector<double> power_cdf_;        // over emitters and, last, the world
  double world_power_ = 0, total_power_ = 0;
  float over_world_share_ = 0;  // one over the world's share of all power
  bool any_exact_ = false;
  std::vector<InSurface> in_surfaces_;
};

}  // namespace photon_splat
