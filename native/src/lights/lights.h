// Light sources: sampled from a point (direct light), met by a ray, and as starting places of
// photons.
#pragma once

#include <optional>

#include "lights/emission_discs.h"
#include "lights/emission_guide.h"
#include "lights/emission_targets.h"
#include "lights/environment.h"
#include "lights/environment_guide.h"
#include "lights/light_tree.h"
#include "math/spherical_triangle.h"

namespace photon_splat {

enum class LampKind { kPoint, kSpot, kSun, kArea };

// A lamp as Blender means it; positions relative to the scene's origin. Which radiometric quantity
// `strength` stands for is said in lights.cpp, beside the conversion.
struct LampSettings {
  LampKind kind = LampKind::kPoint;
  Affine to_world;
  Rgb strength{};
  float radius = 0;
  bool soft_falloff = true;
  float spot_size = kPi / 4, spot_blend = 0;
  float angle = 0;
  float size_x = 1, size_y = 1;
  bool ellipse = false;
  float spread = kPi;
  bool normalize = true;
  bool camera_visible = false;
  int program = -1;  // into Scene::programs: its emission is a factor of `strength`
  uint64_t lit_groups = ~uint64_t{0};  // of light linking: instances with one of these bits see it
  uint64_t blockers = ~uint64_t{0};    // of shadow linking: the others let its light pass
  int16_t light_group = kNoLightGroup;
  // Rays of these kinds bring its light; what shadow rays bring is scattered as if by one of them
  RayMask seen_by = kAllRays;
  uint32_t max_bounces = ~0u;  // of a path before it finds the lamp
  bool met_by_rays = true;     // else by light samples alone
  // Else light samples pass everything, which other rays to the lamp do not
  bool casts_shadows = true;
};

// Sums of light by group, each times a factor.
struct GroupLight {
  Rgb* sums;  // by number of the group
  Rgb factor;
  void add(const Rgb& light, int16_t group) {
    if (const Rgb scaled = factor * light; group != kNoLightGroup && can_be_added(scaled))
      sums[group] += scaled;
  }
};

// Where light is wanted.
struct Receiver {
  Vec3 x;
  Vec3 n;  // unit; 0 where light from either side counts
  // Scatters in narrow lobes: its rays share all lights they can find with `sample`, not near ones
  // only
  bool sharp = false;
  uint64_t group = ~uint64_t{0};  // Instance::group
  // Of Lights::guide_at(), if any: by what the world is looked for from there
  const EnvironmentGuide::Cell* guide = nullptr;
  uint8_t world_samples = 1;  // how many sample_world() is asked for
  uint8_t ray = 0xff;         // RayMask of the ray on its way from there
  uint16_t bounces = 0;       // of the path before that
  // unit: it scatters in proportion to the cosine with this, more or less; 0: who knows
  Vec3 ns{};

  // Whether light is to be sampled in proportion to the cosine.
  bool diffuse() const { return !sharp && !is_black(n * n) && !is_black(ns * ns); }
};

// Light arriving at a point from one direction. weight = radiance / pdf (solid angle, choice of
// light included).
struct LightSample {
  Vec3 direction;
  float distance;
  // Of an emissive surface, towards the point; 0 for lamps, which nothing shadows but what is
  // before them
  Vec3 normal;
  Rgb weight;
  float pdf;  // solid angle; 0 for directions no BSDF sample can find
  bool use_mis;
  uint64_t blockers = ~uint64_t{0};
  int16_t light_group = kNoLightGroup;
  RayMask seen_by = kAllRays;
  bool from_world = false;
  int32_t exact = -1;  // a lamp's emitter that lies in a surface: see Lights::blocked_exactly()
  Vec3 place;          // on it
};

// Where a photon path starts. `power` is that of the whole light field divided by the pdf: W for
// one photon of one.
struct PhotonStart {
  Vec3 origin, direction;
  Rgb power;
  // Of a lamp that faces its receiver, see `accepts`: its squared radius, the squared distance at
  // which the ray passes its centre, and how far from the origin that is.
  float soft_radius2 = -1, soft_miss2 = 0, soft_nearest = 0;
  // Distances at which the first surface is lit by this photon
  float first_hit_from = 0, first_hit_to = INFINITY;
  uint64_t lit_groups = ~uint64_t{0};  // the first surface is lit if it is of one of these
  uint64_t blockers = ~uint64_t{0};    // and lets the light pass if it is of none of these
  int16_t light_group = kNoLightGroup;
  RayMask seen_by = kAllRays;  // the first surface scatters it by lobes of these kinds
  uint32_t max_bounces = ~0u;  // lobes that it goes through
  bool deltas = true;          // the first surface's may be deltas
  // Else nothing blocks it, but behind what would have done so deltas do not scatter it
  bool casts_shadows = true;
  int32_t aim = -1;  // pair of EmissionTargets; -1: natural emission
  // An emitter that lies in a surface, and the place on it that the first surface must be seen from
  int32_t exact = -1;
  Vec3 place;
  // a lamp with a program: `power` lacks Lights::first_hit_factor(), which needs the distance
  int32_t shaded_by = -1;
  // Of a world: `power` lacks Environment::share() of the ray that sees it
  bool asks_ray = false;

  // Whether it lights and is stopped by whatever it meets, as it is.
  bool plain() const {
    return !~lit_groups && seen_by == kAllRays && !~max_bounces && deltas && casts_shadows &&
           !~blockers && soft_radius2 < 0 && first_hit_from == 0 && first_hit_to == INFINITY &&
           shaded_by < 0 && !asks_ray && exact < 0;
  }
  // A disc of radius r that faces a receiver shows it, of the rays that pass its centre at a
  // distance m, those that have gone on for t >= m^2 / sqrt(r^2 - m^2) since they were nearest to
  // the centre. (They leave the disc m^2 / t before that.)
  bool accepts(float distance) const {
    if (distance < first_hit_from || distance > first_hit_to) return false;
    if (soft_radius2 < 0) return true;
    const float t = distance - soft_nearest;
    return t > 0 && soft_miss2 <= t * std::sqrt(std::max(0.0f, soft_radius2 - soft_miss2));
  }
};

class Lights {
 public:
  Lights(Scene& scene, const std::vector<LampSettings>& lamps);

  // An area lamp, by its number among those given, that lies in the plane of a surface, and the
  // instance of that.
  struct InSurface {
    uint32_t lamp, instance;
  };
  const std::vector<InSurface>& in_surfaces() const { return in_surfaces_; }
  // Whether something opaque stands between `origin` and a place on such a lamp, to the last bit of
  // the distance.
  bool blocked_exactly(uint32_t emitter, const Vec3& origin, const Vec3& place) const;

  // One light sample; nullopt when no light reaches the place.
  std::optional<LightSample> sample(const Receiver& to, float choice, const Vec2& u) const;

  // Sample `i` of to.world_samples, of one world altogether, where the guide has learnt how to see
  // it from there; `sample` then leaves the world out. The numbers are those of all of them.
  std::optional<LightSample> sample_world(const Receiver& to, uint32_t i, float choice,
                                          const Vec2& u) const;
  // Lives as long as it is used here; none at first.
  void set_guide(const EnvironmentGuide* guide) { guide_ = guide; }
  const EnvironmentGuide::Cell* guide_at(const Vec3& x, const Vec3& n) const {
    return guide_ ? guide_->find(x, n) : nullptr;
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
  Rgb lamps_met(const Receiver& to, const Vec3& direction, float near, float far, float bsdf_pdf,
                GroupLight* groups = nullptr) const;
  // Whether some light passes through what blocks others: then linked_met() adds the light of
  // those, lamps and surfaces alike, that comes to the receiver against a ray from `origin`,
  // through whatever does not block it, weighted as above.
  bool shadow_linked() const { return !shadow_linked_.empty(); }
  Rgb linked_met(const Receiver& to, const Vec3& origin, const Vec3& direction, float bsdf_pdf,
                 const RayInfo& ray, GroupLight* groups = nullptr) const;
  // Radiance of the world in a direction that a ray from the receiver left the scene in, weighted
  // likewise.
  Rgb world_met(const Receiver& to, const Vec3& direction, float bsdf_pdf) const;
  // The same for a camera ray, unweighted: only lamps that the camera may see.
  Rgb lamps_seen(const Vec3& origin, const Vec3& direction, float near, float far,
                 GroupLight* groups = nullptr) const;

  const Environment& environment() const { return environment_; }
  // Photons of suns and of the world start about what is seen, of which half lies within `radius`
  // of `center`, and fewer everywhere else. To be called before any photon is emitted, guided or
  // aimed.
  void focus(const Vec3& center, float radius);
  bool focused() const { return discs_.focused(); }
  double total_power() const { return total_power_; }  // W, mean over RGB

  // Photon number `index` of the stream `seed` starts in proportion to power, or where `guide`
  // sends it.
  EmissionPrimary primary(uint64_t index, uint32_t seed, const EmissionGuide* guide) const {
    EmissionPrimary out;
    primaries(index, 1, seed, guide, &out);
    return out;
  }
  // The same for `count` <= SobolPair::kMost indices in a row.
  void primaries(uint64_t first, uint32_t count, uint32_t seed, const EmissionGuide* guide,
                 EmissionPrimary* out) const;
  PhotonStart emit(const EmissionPrimary& primary) const;
  // The same for `count` <= SobolPair::kMost at once, bit for bit; vectors of lanes.
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

 private:
  struct Lamp {
    static constexpr uint32_t kUnnumbered = ~0u;
    uint32_t number = kUnnumbered;  // among those given
    LampSettings s;
    Vec3 center, axis_x, axis_y, forward;  // unit axes; forward: where the light shines
    // W/m^2/sr; W/sr of point and spot; W/m^2 of a sun in `intensity`
    Rgb radiance, intensity;
    float half_x = 0, half_y = 0, area = 0;
    bool holds_geometry = false;  // a spherical lamp with something inside it
    bool faces_geometry = false;  // the same of one that faces its receiver
    float one_minus_cos = 0;      // of a sun's half angle
    float cos_half = 0, inverse_smooth = 0, scale_x = 1, scale_y = 1, scale_z = 1;  // spot cone
    float tan_half_spread = 0, normalize_spread = 0;
    // Of the photon's direction: spots and narrow areas, see lights_photons.cpp
    std::vector<float> angle_cdf;
    // Lower end of the tabled variable; the upper end is 1 (spot) or in angle_high
    float angle_low = 0;
    float angle_high = 1;
    LampPlace place;  // of those with a program
  };
  // All that sampling reads of a triangle that emits: one line of the cache.
  struct alignas(64) EmissiveTriangle {
    Vec3 corner[3];
    Vec3 normal;        // unit, on the front side
    float pdf;          // of its places, area measure, among all of the emitter
    float front_share;  // of its power
    uint32_t triangle;  // of the mesh
    uint32_t material;  // into Scene::materials
  };
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
    // Of a sun: through a surface that faces it, mean over RGB, W/m^2
    double parallel_flux = 0;
    bool exact = false;    // lies in a surface: lights_exact.cpp
    float over_share = 0;  // one over its share of all lights' power
    std::vector<EmissiveTriangle> triangles;
    std::vector<float> cdf;           // over triangles, by power
    std::vector<uint32_t> cdf_start;  // where to begin looking, for equal steps of the cdf

    size_t step_at(float target) const {
      const float at = target / cdf.back() * static_cast<float>(cdf_start.size());
      return std::min(static_cast<size_t>(at), cdf_start.size() - 1);
    }
    // The triangle whose share of the cdf holds `target`: a look-up and a step or two instead of a
    // search.
    size_t triangle_at(float target) const {
      return triangle_from(cdf_start[step_at(target)], target);
    }
    size_t triangle_from(size_t i, float target) const {
      while (i > 0 && cdf[i - 1] > target) --i;
      while (i + 1 < cdf.size() && cdf[i] <= target) ++i;
      return i;
    }
    // Of the whole: what the mesh's `triangle` is picked with; 0 where it does not emit.
    float share_of(uint32_t triangle) const {
      // Right where no other stands between them
      size_t i = size_t{triangle} - triangles.front().triangle;
      if (i >= triangles.size() || triangles[i].triangle != triangle)
        i = std::lower_bound(
                triangles.begin(), triangles.end(), triangle,
                [](const EmissiveTriangle& t, uint32_t number) { return t.triangle < number; }) -
            triangles.begin();
      if (i == triangles.size() || triangles[i].triangle != triangle) return 0;
      return (cdf[i] - (i ? cdf[i - 1] : 0)) / cdf.back();
    }
  };

  // A place on an emissive mesh, in proportion to the power from there.
  struct MeshPoint {
    Vec3 position;
    const EmissiveTriangle* triangle;
    float u, v;
    float side;  // uniform in [0, 1), to choose the side by
  };
  bool lies_in_surface(const Lamp& lamp, uint32_t& instance) const;
  void find_lamps_in_surfaces();
  // How far off such a lamp may be found before something `far` off
  float reach_of_exact(float far) const;
  void start_exactly(uint32_t emitter, PhotonStart& start) const;
  void add_lamp(const LampSettings& settings);
  void add_emissive_instances();
  void add_emissive_triangles(uint32_t instance, Emitter& emitter, Bounds& bounds,
                              double& sum) const;
  Rgb emission_of(const Emitter& e, const EmissiveTriangle& t, float u, float v, bool back,
                  const Vec3& wo) const {
    return scene_.emission_at(scene_.materials[t.material], e.instance, t.triangle, u, v, back, wo);
  }
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
  // Of an emitter among themselves
  float choice_probability(uint32_t emitter, const Receiver& to) const;
  float emitters_weight(const Receiver& to) const;  // of all together
  float world_probability(const Receiver& to, float emitters_weight) const;
  float guided_pdf(const EnvironmentGuide::Cell& cell, const Environment::Density& density) const;
  // lights_shaded.cpp: the factor of the lamp's radiance by its program, at `position` (of a sun:
  // anything) seen from `distance` along -wo. White for lamps without one.
  Rgb shade(const Lamp& lamp, const Vec3& position, const Vec3& wo, float distance) const;
  Vec2 lamp_uv(const Lamp& lamp, const Vec3& position, const Vec3& normal, const Vec3& wo) const;
  float mean_shade(const Lamp& lamp) const;
  float spot_attenuation(const Lamp& lamp, const Vec3& from_lamp) const;
  // Of the angle to the lamp's axis
  float spread_attenuation(const Lamp& lamp, float tangent) const;
  bool inside_shape(const Lamp& lamp, const Vec3& from_center) const;
  float sampled_area(const Lamp& lamp, const Vec3& x) const;  // of an area lamp, from x
  bool sample(const Receiver& to, float choice, const Vec2& u, LightSample& out) const;
  // `by_cosine`: in proportion to the receiver's cosine.
  bool sample_lamp(const Emitter& e, const Receiver& receiver, const Vec2& u, LightSample& out,
                   bool& by_cosine) const;
  bool sample_mesh(const Emitter& e, const Receiver& receiver, const Vec2& u, LightSample& out,
                   bool& by_cosine) const;
  // `pdf` is that of sample_lamp for this direction; 0 where the lamp is not met, else `distance`
  // (if any) says where.
  Rgb lamp_radiance_met(const Lamp& lamp, const Vec3& origin, const Vec3& direction, float near,
                        float far, float& pdf, float* distance = nullptr) const;
  PhotonStart emit_lamp(const Lamp& lamp, float coin, const Vec2& place, const Vec2& way) const;
  // With what is the same for all that its emitter sends.
  PhotonStart& finished(PhotonStart& start, const EmissionPrimary& primary) const;
  void emit_meshes(const EmissionPrimary* primaries, const uint32_t* which, uint32_t count,
                   PhotonStart* out) const;
  void emit_areas(const EmissionPrimary* primaries, const uint32_t* which, uint32_t count,
                  PhotonStart* out) const;
  PhotonStart emit_mesh(const Emitter& e, float pick, const Vec2& place, const Vec2& way) const;
  // A photon that is not weighted yet, and what its weight is made of: lights_aimed.cpp.
  struct Draft;
  // In [0, 1], uniform: where in the triangle's share of the cdf `target` lies.
  static float side_of(const Emitter& e, size_t triangle, float target) {
    const float low = triangle ? e.cdf[triangle - 1] : 0,
                share = std::max(e.cdf[triangle] - low, 1e-37f);
    return std::clamp((target - low) / share, 0.0f, 1.0f);
  }
  MeshPoint point_on_mesh(const Emitter& e, float pick, const Vec2& place) const;
  Draft natural_draft(uint32_t emitter, const Vec2& pick, const Vec2& place, const Vec2& way) const;
  Draft aimed_draft(uint32_t emitter, const EmissionTargets::Sphere& target, const Vec2& pick,
                    const Vec2& place, const Vec2& way) const;
  void cross_scene(Draft& draft) const;
  void weigh_parallel(Draft& draft) const;
  void weigh_lamp(const Lamp& lamp, Draft& draft) const;
  void weigh_mesh(const Emitter& e, const MeshPoint& point, Draft& draft) const;
  float aimed_density(const Draft& draft, const EmissionTargets::Sphere& target, bool own) const;
  double flux_between(uint32_t emitter, const EmissionTargets::Sphere& target) const;
  PhotonStart emit_parallel(const Vec3& direction, const Vec2& place) const;
  PhotonStart emit_world(const Vec2& place, const Vec2& way) const;
  Vec3 parallel_origin(const Vec3& direction, const Vec3& through, const Vec3& outside,
                       float width) const;
  void share_power();
  // Where other things are very far off, photons of lamps and meshes there are aimed at spheres
  // around what is near as well: lights_aimed.cpp.
  float near_sphere(int k) const {
    return scene_.near_radius() * static_cast<float>(1 << 2 * k) * 1.0001f;
  }
  // How many a light at that distance from the origin has
  int near_spheres(float distance) const;
  // About the share of photons from there that so come to be drawn
  double near_share(const Vec3& x) const;
  PhotonStart emit_nearby(const EmissionPrimary& primary) const;
  void start_nearby(const Vec3& across, PhotonStart& start) const;
  // A lamp of a few triangles, seen from a place: lights_close.cpp.
  struct CloseLamp {
    static constexpr int kMost = 4;
    struct Place {
      int triangle;
      Vec3 direction, normal;
      float distance, u, v;
      float pdf;  // solid angle
    };
    int count = 0;
    Vec3 corner[kMost][3];  // relative to the place
    SphericalTriangle seen[kMost];
    bool by_cosine = false;
    float cosine[kMost][3];  // at the corners, by_cosine, and not less than a little
    float share[kMost];      // of the samples, not normalised
    float total = 0;         // of those: solid angle, sr, or times the cosine
    void weigh_by_cosine(const Vec3& ns);
    bool sample(Vec2 u, Place& out) const;
  };
  // False where the emitter is to be sampled by area.
  bool see_close(const Emitter& e, const Receiver& to, CloseLamp& out) const;
  void triangle_corners(uint32_t instance, uint32_t triangle, Vec3 corner[3]) const;

  const Scene& scene_;
  Environment environment_;
  EmissionDiscs discs_;
  const EnvironmentGuide* guide_ = nullptr;
  std::vector<Lamp> lamps_;
  std::vector<Emitter> emitters_;
  std::vector<int32_t> emitter_of_instance_;  // -1: none
  LightTree tree_;                            // of many emitters all but suns; of few: empty
  // Emitters of the tree's items; suns among many emitters
  std::vector<uint32_t> tree_emitters_, suns_;
  std::vector<int32_t> tree_item_;       // of an emitter; -1: a sun
  std::vector<uint32_t> visible_lamps_;  // emitters that the camera may see
  std::vector<uint32_t> shadow_linked_;  // emitters whose light not everything blocks
  std::vector<double> power_cdf_;        // over emitters and, last, the world
  double world_power_ = 0, total_power_ = 0;
  float over_world_share_ = 0;  // one over the world's share of all power
  bool any_exact_ = false;
  std::vector<InSurface> in_surfaces_;
};

}  // namespace photon_splat
