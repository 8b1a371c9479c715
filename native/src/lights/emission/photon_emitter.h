// Lights as starting places of photons: in proportion to power, where a guide sends them, or aimed
// at what makes caustics.
#pragma once

#include "lights/emission/emission_guide.h"
#include "lights/emission/emission_targets.h"
#include "lights/lights.h"

namespace photon_splat {

// Where other things are very far off, photons of lamps and meshes there are aimed at spheres
// around what is near as well: about the share of photons from x that so come to be drawn.
double near_share(const Scene& scene, const Vec3& x);

// Follows the lights, which must outlive it.
class PhotonEmitter {
 public:
  explicit PhotonEmitter(const Lights& lights)
      : scene_(lights.scene()),
        environment_(lights.environment()),
        discs_(lights.discs()),
        lamps_(lights.lamps()),
        emitters_(lights.emitters()),
        power_cdf_(lights.power_cdf()),
        total_power_(lights.total_power()),
        world_power_(lights.world_power()),
        over_world_share_(lights.over_world_share()) {}

  // Photon number `index` of the stream `seed` starts in proportion to power, or where `guide`
  // sends it.
  EmissionPrimary primary(uint64_t index, uint32_t seed, const EmissionGuide* guide) const {
    EmissionPrimary out;
    primaries(index, 1, seed, guide, &out);
    return out;
  }
  // primary() for `count` <= SobolPair::kMost indices in a row.
  void primaries(uint64_t first, uint32_t count, uint32_t seed, const EmissionGuide* guide,
                 EmissionPrimary* out) const;
  PhotonStart emit(const EmissionPrimary& primary) const;
  // emit() for `count` <= SobolPair::kMost at once, with the same bits, in vectors of lanes.
  void emit(const EmissionPrimary* primaries, uint32_t count, PhotonStart* out) const;
  // What the program of the photon's lamp makes of its power at the first surface that scatters it,
  // `distance` away at `receiver`.
  Rgb first_hit_factor(const PhotonStart& start, const Vec3& receiver, float distance) const;
  // A guide for these emitters that has learnt nothing yet.
  EmissionGuide make_guide() const;

  // A mixture that aims all but an eighth of the photons at the spheres (those of weight 0
  // excepted). One share of natural emission more makes sure that no light is lost, wherever it
  // goes.
  EmissionTargets aim_at(std::vector<EmissionTargets::Sphere> spheres) const;
  // Photon number `index` of the stream `seed`. Its power is that of the whole light field divided
  // by the mixture's density, so that sums over photons have the same expectation as with emit().
  // Without targets: natural emission.
  PhotonStart emit_towards(const EmissionTargets& targets, uint64_t index, uint32_t seed) const;
  // Tells the targets what use that photon was of.
  void learn(EmissionTargets& targets, uint64_t index, uint32_t seed, double useful) const;
  // A photon of one lamp, before its node program. coin: whether a photon of a spherical lamp that
  // holds things starts inside.
  PhotonStart emit_lamp(const Lamp& lamp, float coin, const Vec2& place, const Vec2& way,
                        float time = kShutterCentre) const;

 private:
  void start_exactly(uint32_t emitter, PhotonStart& start) const;
  // Sets what is the same for all that an emitter sends; the world is the one after the last.
  void tell(uint32_t emitter, PhotonStart& start) const;
  // That, weighed.
  PhotonStart& finished(PhotonStart& start, const EmissionPrimary& primary) const;
  void emit_meshes(const EmissionPrimary* primaries, const uint32_t* which, uint32_t count,
                   PhotonStart* out) const;
  void emit_areas(const EmissionPrimary* primaries, const uint32_t* which, uint32_t count,
                  PhotonStart* out) const;
  // A photon that is not weighted yet, and what its weight is made of: photon_aiming.cpp.
  struct Draft;
  struct Aimed {
    EmissionPrimary primary;
    int32_t pair;  // -1: natural emission
  };
  Aimed aimed_primary(const EmissionTargets& targets, uint64_t index, uint32_t seed) const;
  Draft natural_draft(const EmissionPrimary& primary) const;
  Draft aimed_draft(const EmissionPrimary& primary, const EmissionTargets::Sphere& target) const;
  void cross_scene(Draft& draft) const;
  void weigh_parallel(Draft& draft) const;
  void weigh_lamp(const Lamp& lamp, Draft& draft) const;
  void weigh_mesh(const Emitter& e, const MeshPoint& point, Draft& draft) const;
  float aimed_density(const Draft& draft, const EmissionTargets::Sphere& target, bool own) const;
  double flux_between(uint32_t emitter, const EmissionTargets::Sphere& target) const;
  PhotonStart emit_parallel(const Vec3& direction, const Vec2& place, float time) const;
  PhotonStart emit_world(const Vec2& place, const Vec2& way, float time) const;
  Vec3 parallel_origin(const Vec3& direction, const Vec3& through, const Vec3& outside, float width,
                       float time) const;
  PhotonStart emit_nearby(const EmissionPrimary& primary) const;
  void start_nearby(const Vec3& across, float time, PhotonStart& start) const;

  const Scene& scene_;
  const Environment& environment_;
  const EmissionDiscs& discs_;
  const std::vector<Lamp>& lamps_;
  const std::vector<Emitter>& emitters_;
  const std::vector<double>& power_cdf_;
  const double &total_power_, &world_power_;
  const float& over_world_share_;
};

}  // namespace photon_splat
