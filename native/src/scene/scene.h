// Geometry, materials and textures as the tracers see them, in metres relative to the scene's
// origin.
#pragma once

#include <embree4/rtcore.h>

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "bsdf/bsdf.h"
#include "geometry/mesh.h"
#include "geometry/swept_boxes.h"
#include "scene/crossings.h"
#include "scene/instance.h"
#include "scene/material.h"
#include "scene/moving_place.h"
#include "scene/ray_hits.h"
#include "scene/shading_view.h"
#include "scene/surface.h"
#include "shading/program.h"
#include "textures/texture.h"
#include "textures/volume_grid.h"
#include "util/large_pages.h"
#include "util/parallel.h"

namespace photon_splat {

class Media;
class MediumStack;

struct Coincident;

class Scene {
 public:
  explicit Scene(int threads);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  // Filling; indices are checked here and reported with std::invalid_argument.
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<int32_t> slot_materials;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<std::shared_ptr<const VolumeGrid>> grids;  // those that meshes may share
  std::vector<TransformMotion> motions;
  Shutter shutter;
  std::vector<Program> programs;
  Rgb world{};  // constant radiance, or the factor of the map
  WorldMap world_map;
  int world_program = -1;  // into programs: then neither is read
  int world_volume = -1;   // into programs: a medium that is everywhere
  // Whose light is kept apart as well; photons are then splatted group by group
  int light_groups = 0;
  int16_t world_light_group = kNoLightGroup;
  RayMask world_seen_by = kAllRays;
  std::vector<SunDisc> sun_discs;
  ShadingView view;  // for programs
  std::vector<InstanceAttribute> instance_attributes;
  std::vector<Affine> world_to_object;  // of each instance, shared or not; filled by build()
  double origin[3] = {0, 0, 0};
  // m around the origin: what the camera sees best, where other things are very far off; else 0
  float near = 0;

  // Adds a mesh placed by a matrix that is already relative to `origin`.
  void add_instance(uint32_t mesh, const std::array<double, 12>& to_world,
                    const std::vector<int32_t>& slot_materials_of_instance);

  // Sets the transform of the instance added last at steps of the shutter, an odd number of them,
  // relative to `origin`; the middle one is that of add_instance().
  void set_motion(uint32_t instance, std::span<const Affine> steps);

  // Patches, world-space meshes and the acceleration structure. Stops with Cancelled.
  void build(const CancelFlag& cancel);

  // True and fills `surface` when the ray hits something between `near` and `far` that rays of
  // `kinds` see. left: Surface::mark of where it starts.
  bool intersect(const Vec3& origin, const Vec3& direction, float near, float far, bool coherent,
                 Surface& surface, RayMask kinds = kAllRays, float time = kShutterCentre,
                 uint32_t left = 0) const;
  // Where a ray meets the surface of one instance, whose materials have subsurface closures or ask
  // for such rays: others are not there.
  struct OwnHit {
    uint32_t triangle;
    float u, v, distance;
    Vec3 normal;  // unit, of the front
  };
  bool meets_itself(uint32_t instance, const Vec3& origin, const Vec3& direction, float near,
                    float far, float time, OwnHit& hit) const;
  // All that a short ray meets, not the nearest alone.
  Crossings crossings(const Vec3& origin, const Vec3& direction, float near, float far,
                      RayMask kinds, float time) const;
  // Another surface, or another triangle of the same one, that lies in this one to within rounding:
  // two opaque ones that shadow rays meet, or of which light passes one and rays of these kinds
  // meet both. Without a share.
  std::optional<Coincident> coincides(const Surface& s, RayMask kinds) const;
  // What a ray meets next that has found `s` and passes it: a surface in which that one lies, or
  // what is beyond. True and fills `s` when there is something.
  bool intersect_past(Surface& s, const Vec3& origin, const Vec3& direction, float far,
                      bool coherent, RayMask kinds = kAllRays, float time = kShutterCentre,
                      uint32_t left = 0) const {
    return (instances[s.instance].layered && meets_layer(s, origin, direction, kinds, time)) ||
           intersect(origin, direction, past(s), far, coherent, s, kinds, time, left);
  }
  // True and fills `s` with the next of the surfaces in which it lies to within rounding, where
  // rays of `kinds` meet one.
  bool meets_layer(Surface& s, const Vec3& origin, const Vec3& direction, RayMask kinds,
                   float time) const;
  // intersect() for `count` <= kPacket incoherent rays from 0 to infinity; bit k of the result
  // tells whether ray k hit.
  static constexpr uint32_t kPacket = 8;
  unsigned intersect_packet(const Vec3* origins, const Vec3* directions, uint32_t count,
                            Surface* surfaces, RayMask kinds = kAllRays) const;
  // intersect() for `count` <= RayHits::kMost rays as arrays. Embree's packets are a fifth faster
  // than single rays even for photons, which are incoherent.
  struct Rays {
    const float *origin_x, *origin_y, *origin_z, *direction_x, *direction_y, *direction_z;
    const RayMask* kinds = nullptr;  // of each, if not all
    const float* time = nullptr;     // of each, if not the shutter's centre
    const uint32_t* left = nullptr;  // Surface::mark of where each starts, if not 0
    Vec3 direction(uint32_t k) const { return {direction_x[k], direction_y[k], direction_z[k]}; }
  };
  unsigned intersect(const Rays& rays, uint32_t count, RayHits& hits) const;
  // Describes in `out` the hits of `which` that are on surfaces without a program; returns their
  // bits.
  unsigned plain_surfaces(const RayHits& hits, unsigned which, PlainSurfaces& out) const;
  // One of them as intersect() has it.
  Surface surface_of(const RayHits& hits, uint32_t k, const Vec3& direction,
                     float time = kShutterCentre) const;
  // The surface at a point of a triangle, as a ray that meets that side head-on would find it.
  Surface surface_at(uint32_t instance, uint32_t triangle, float u, float v, bool back,
                     float time = kShutterCentre) const;
  bool occluded(const Vec3& origin, const Vec3& direction, float near, float far,
                RayMask kinds = kAllRays, float time = kShutterCentre, uint32_t left = 0) const;
  // occluded() for `count` <= kPacket parallel rays from 0 to `far`; bit k of the result is ray
  // k's.
  unsigned occluded_packet(const Vec3* origins, uint32_t count, const Vec3& direction, float far,
                           RayMask kinds = kAllRays) const;
  // Share of light that comes through on the way: 1 where nothing stands, 0 behind what is opaque,
  // between them what transparent surfaces let pass. `ray` is what programs are told of the ray,
  // and says when it is on its way. Only instances of the groups `blockers` count.
  Rgb transmittance(const Vec3& origin, const Vec3& direction, float far, const RayInfo& ray,
                    uint64_t blockers = ~uint64_t{0}) const;
  // Transmittance through surfaces and media; `around`: the media at the origin.
  Rgb transmittance(const Vec3& origin, const Vec3& direction, float far, const RayInfo& ray,
                    uint64_t blockers, MediumStack around, Random& random) const;
  const Media* media() const { return media_.get(); }  // or null: there are none

  // Whether anything moves while the shutter is open, the camera aside.
  bool moves() const { return moves_; }
  bool has_strands() const { return strands_; }
  bool has_catchers() const { return catchers_; }
  // Whether photons do not bring all light: not what media emit, nor what strands do, nor what
  // media scatter that straight light passes unseen, nor what shines by how far off it is seen, nor
  // to and from what asks how deep a camera path is (Light Path).
  bool needs_paths() const;
  bool scatters_in_media() const;
  // Whether rays that media scatter see an instance as diffuse rays do not, or the other way round.
  bool volume_differs(uint32_t instance) const {
    const RayMask seen_by = instances[instance].seen_by;
    return !(seen_by & ray_bit(RayInfo::kVolume)) != !(seen_by & ray_bit(RayInfo::kDiffuse));
  }
  bool moves(uint32_t instance) const { return moves_ && instances[instance].moves; }
  // The hits of `which` on instances that do not move.
  unsigned still(const RayHits& hits, unsigned which) const;
  // Whether something that moves comes so near to x that light there may change with the time by
  // much.
  bool moves_near(const Vec3& x) const { return moves_ && swept_->hold(x); }
  // Rays that find what keeps photons off a surface of an instance all of the time. Strands are too
  // thin.
  RayMask keeping_off(uint32_t instance) const {
    return (moves_ || strands_) && !instances[instance].moves ? kStillRays
                                                              : ray_bit(RayInfo::kDiffuse);
  }
  Pose pose_at(uint32_t instance, float time) const;
  // Corners of a triangle in the world.
  void corners(uint32_t instance, uint32_t triangle, float time, Vec3 corner[3]) const;
  // The place at the shutter's centre of a surface of a moving instance, as a ray found it at that
  // time.
  PlaceAtRest at_rest(const Surface& s, float time) const;

  // True when the bounds of some primitive come within `radius` of `x`.
  bool anything_within(const Vec3& x, float radius) const;

  // Closures of the surface for light that leaves towards `wo` (camera) or came from there
  // (photons), ready for use.
  void shade(const Surface& s, const Vec3& wo, const RayInfo& ray, Bsdf& bsdf) const;
  // What a program that only finds a vector finds there; `registers` are its scratch space.
  Vec3 value_at(const Program& program, const Surface& s, const Vec3& wo, const RayInfo& ray,
                std::vector<float>& registers) const;
  // The same place as a ray finds it that comes to its other side.
  static Surface other_side(const Surface& s);
  // Lambertian reflectance of a surface without a program.
  Rgb albedo(const Surface& s) const { return textured(s.side->albedo, s.side->albedo_texture, s); }
  // Radiance towards `wo`.
  Rgb emission(const Surface& s, const Vec3& wo, const RayInfo& ray) const;
  // That of a point of a triangle of this material, for whoever samples lights: surface_at() is
  // left out where it tells nothing. depth: RayInfo::depth of the ray that would find it, which is
  // as long as that (m; 0: as things of the scene are far off each other).
  Rgb emission_at(const Material& material, uint32_t instance, uint32_t triangle, float u, float v,
                  bool back, const Vec3& wo, float time = kShutterCentre, uint16_t depth = 1,
                  float length = 0) const;
  // Whether the material lets light through without scattering it, or could (its program knows).
  bool may_be_transparent(const Surface& s) const {
    return s.program && s.program->features & kProgramTransparent;
  }
  // What of light along `direction` the surface lets straight on: as the ray sees it that looks
  // back along the light's way, and so meets its other side.
  Rgb lets_through(const Surface& s, const Vec3& direction, const RayInfo& ray) const;
  // Features of any material in use, as ProgramFeature bits; the plain ones gather and emit.
  uint32_t features() const { return features_; }
  // Whether some instance is not seen by every ray; and whether what happens to photons then
  // depends on the kind of ray that looks back along them: along all of their ways, or straight
  // from a light.
  bool limits_rays() const { return any_ray_ == 0; }
  bool kinds_differ() const {
    return kinds_differ_ && features_ & (kProgramRest | kProgramTransmits);
  }
  // Whether something is hidden from diffuse rays or from those that surfaces scatter through
  // themselves, and not from both.
  bool translucence_differs() const {
    return translucence_differs_ && features_ & kProgramTransmits;
  }
  // Whether something lets rays of shadows pass as scattered ones do not, or the other way round.
  bool shadows_differ() const { return shadows_differ_ || programs_ask_shadow_; }
  bool first_kinds_differ() const { return first_kinds_differ_ && features_ & kProgramSharp; }
  // To be called when materials have changed after build(). Throw Cancelled.
  void update_features();
  void update_own_scenes(const CancelFlag& cancel);
  void update_media(const CancelFlag& cancel);
  void update_layers(const CancelFlag& cancel);
  Vec2 uv_at(uint32_t instance, uint32_t triangle, float u, float v) const;
  const Material& material_of(uint32_t instance, uint32_t triangle) const;
  // Whether a hit's mesh is so coarse that shadow rays from below its smooth horizon matter.
  bool bent(const Surface& surface) const;
  // Whether the patch that a triangle belongs to lies in a plane.
  bool is_planar(uint32_t instance, uint32_t triangle) const {
    const Topology& topology = meshes[instances[instance].mesh].topology;
    return topology.planar[topology.patch[triangle]];
  }
  // How far off its place in the world a ray may meet a triangle because of how large that is, or
  // how far from the origin of a mesh that is instanced, as far as that is more than `known`.
  float rounding_beyond(float known, uint32_t instance, uint32_t triangle) const {
    return lookups_[instance].rounding > known ? large_rounding(instance, triangle) : 0;
  }
  bool smooth(const Surface& surface) const { return lookups_[surface.instance].normals_mask; }
  // The surface's own place, or one beyond it where its mesh is too coarse for its smooth normals.
  Vec3 shadow_ray_origin(const Surface& surface, const Vec3& to_light,
                         float time = kShutterCentre) const;

  const Bounds& bounds() const { return bounds_; }
  Vec3 center() const { return bounds_.empty() ? Vec3{} : bounds_.center(); }
  float radius() const {
    return bounds_.empty() ? 1.0f : std::max(0.5f * bounds_.diagonal(), 1e-20f);
  }
  // Centre and radius of what matters: things that are very far off do not count.
  bool has_far_things() const { return near > 0 && near < radius(); }
  Vec3 near_center() const { return has_far_things() ? Vec3{} : center(); }
  float near_radius() const { return has_far_things() ? near : radius(); }
  ThreadPool& pool() { return pool_; }
  RTCScene embree() const { return top_; }
  bool is_built() const { return is_built_; }

 private:
  Rgb textured(const Rgb& factor, int texture, const Surface& s) const;
  struct RawHit {
    uint32_t instance, triangle;
    float u, v, distance;
    Vec3 position;
    Vec3 normal;  // unit length, of the front
    float time = kShutterCentre;
  };
  void fill_surface(const RawHit& hit, const Vec3& direction, Surface& surface) const;
  // What is of triangles, and of strands, alone
  void fill_triangle(const RawHit& hit, const Vec3& direction, Surface& surface) const;
  void fill_strand(const RawHit& hit, const Vec3& direction, Surface& surface) const;
  RTCGeometry make_geometry(const Mesh& mesh) const;
  void intersect_eight(const Rays& rays, uint32_t count, RayHits& hits, uint32_t place) const;
  // Where an instance's mesh holds what is asked of every hit. What is the same for all triangles
  // lies at 0 of an array of its own, and its mask is 0 instead of ~0: so no branch asks which it
  // is, which nothing could foresee as rays meet one thing after another.
  struct alignas(64) Lookup {
    const Vec3* normals;      // 3 per triangle, or
    const Triangle* corners;  // one for each vertex of these, if not null
    const uint32_t* patches;
    const uint16_t* slots;
    uint32_t normals_mask, patches_mask, slots_mask;
    uint32_t seed;   // Instance::seed
    bool shared;     // Instance::shared
    float rounding;  // the most that rounding_beyond() may find
    const Strands* strands;

    const Vec3* normals_of(uint32_t triangle, Vec3 made[3]) const {
      return Mesh::normals_of(triangle & normals_mask, normals, corners, normals, made);
    }
    void fetch_ahead(uint32_t triangle) const;
    uint32_t key(uint32_t triangle, bool back) const;
  };
  float large_rounding(uint32_t instance, uint32_t triangle) const;
  void make_lookups();
  void see_limits();
  void see_bent_normals();
  bool emits(const Instance& instance) const;
  bool stops_light(uint32_t instance, uint32_t triangle) const;
  bool lies_in_another(uint32_t instance, uint32_t samples) const;
  Vec3 smooth_normal(uint32_t instance, uint32_t triangle, float u, float v, float time) const;
  Surface moving_surface_at(uint32_t instance, uint32_t triangle, float u, float v, bool back,
                            float time) const;
  Vec3 moving_normal(uint32_t instance, uint32_t triangle, float u, float v, float time) const;
  // World normal from one that Embree has found on an instanced mesh.
  Vec3 normal_from_mesh(uint32_t instance, const Vec3& n, float time) const {
    if (moves(instance)) return pose_at(instance, time).to_local.transposed_vector(n);
    return instances[instance].to_local.transposed_vector(n);
  }
  void find_moving();
  void find_swept();
  RayMask mask_of(const Instance& instance) const;
  // Every thread calls `meanwhile` once.
  void commit(RTCScene scene, const CancelFlag& cancel,
              const std::function<void()>& meanwhile = {});
  void throw_on_error(const CancelFlag& cancel) const;

  ThreadPool pool_;
  RTCDevice device_ = nullptr;
  RTCScene top_ = nullptr;
  uint32_t features_ = 0;
  // Rays are of these kinds as well: all, where no instance's mask is set
  RayMask any_ray_ = kAllRays;
  bool kinds_differ_ = false, first_kinds_differ_ = false, translucence_differs_ = false,
       shadows_differ_ = false, programs_ask_shadow_ = false;
  bool moves_ = false, strands_ = false, strands_emit_ = false, asks_depth_ = false,
       emission_asks_length_ = false, catchers_ = false, is_built_ = false;
  std::unique_ptr<SweptBoxes> swept_;  // where that is so
  bool packets_ = false;               // this Embree has code for packets of eight
  std::vector<RTCScene> mesh_scenes_;
  std::vector<RTCScene> own_scenes_;  // by instance: of those not shared that ask for rays
  std::vector<Lookup> lookups_;       // by instance
  Bounds bounds_;
  std::unique_ptr<Media> media_;
};

}  // namespace photon_splat
