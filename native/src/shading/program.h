// Shader node trees as programs that run at a hit. The compiler is addon/export; the operations are
// listed in ops.def.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/motion.h"
#include "math/sampling.h"

namespace photon_splat {

class Bsdf;
class MediumPoint;
class Scene;

// A program: instructions `opcode, operand...` as 32-bit words. An operand is the offset (in
// floats) of a register, or, with the top bit set, of a constant in `constants`; vectors and
// colours are three consecutive floats. Integers that choose a mode are written as plain words.
// ops.def says for every operation what its operands are.
struct Program {
  std::string name;
  std::vector<uint32_t> code;
  std::vector<float> constants;
  uint32_t registers = 0;  // floats of scratch space
  uint32_t features = 0;   // ProgramFeature bits: what a run may produce
  // Whether shadow rays, and which others, see something else: look_at_program()
  bool asks_shadow = false, asks_kind = false;
  // And those of deltas, later ones, any others
  bool asks_singular = false, asks_depth = false, asks_ray = false;
  bool asks_length = false;       // how far off who sees it is
  bool holds_out = false;         // there may be a hole in the picture
  bool asks_side = false;         // from where it is seen: what it lets through depends on the way
  bool asks_view = false;         // and what it reflects, by more than the side
  bool has_own_normals = false;   // which need not be turned towards who sees it
  bool nearly_mirrors = false;    // a closure is smooth everywhere, or nearly
  bool own_mirrors = false;       // such a one has a normal of its own
  bool on_bent_normals = false;   // its surfaces' smooth normals are far off: Scene::build()
  bool bends_subsurface = false;  // light from below leaves about another normal than the surface's

  // Normals of smooth closures turn towards who sees them: Lobe::given
  bool turns_mirrors() const { return own_mirrors || (nearly_mirrors && on_bent_normals); }
};

enum ProgramFeature : uint32_t {
  // Rest: lobes beyond Lambert
  kProgramEmits = 1,
  kProgramTransparent = 2,
  kProgramGathers = 4,
  kProgramRest = 8,
  kProgramSharp = 16,             // a lobe of roughness below 1/2 is possible: caustics
  kProgramConstantEmission = 32,  // emission is the same everywhere and from every direction
  kProgramTransmits = 64,         // a lobe may send light to the other side
  kProgramSubsurface = 128,       // light may go below the surface
  kProgramMeetsItself = 256,      // it traces rays against its own object: look_at_program()
};

// The ray that found the hit: the Light Path node's outputs.
struct RayInfo {
  // kEmission: none, as an emitter is asked
  // kVolume: left a medium
  enum Kind : uint8_t { kCamera, kShadow, kDiffuse, kGlossy, kTransmission, kEmission, kVolume };
  Kind kind = kCamera;         // kTransmission: glossy, kDiffuse: either way
  bool singular = false;       // left a delta lobe
  bool through = false;        // left to the other side
  bool after_diffuse = false;  // some diffuse lobe sent the path on
  bool catchers_only = false;  // meets shadow catchers, and nothing else
  float length = 0;
  float from = 0;  // where it began to see, m: the camera's clipping, as in Cycles
  // Width of a camera sample where it meets something, m: how far apart Bump looks; 0: not known
  float footprint = 0;
  float time = kShutterCentre;  // of all of its path
  uint32_t left = 0;            // Surface::mark of where it starts
  uint16_t depth = 0, diffuse_depth = 0, glossy_depth = 0, transmission_depth = 0,
           transparent_depth = 0;

  // What is known of the ray that leaves a surface, met by this one, by a lobe.
  RayInfo scattered(bool diffuse, bool transmitted, bool delta) const {
    RayInfo out = *this;
    out.kind = diffuse ? kDiffuse : transmitted ? kTransmission : kGlossy;
    out.through = transmitted;
    out.singular = delta;
    out.after_diffuse |= diffuse;
    out.from = 0;
    ++out.depth;
    ++(transmitted ? out.transmission_depth : diffuse ? out.diffuse_depth : out.glossy_depth);
    return out;
  }
  // What is known of a ray that leaves a medium.
  RayInfo scattered_in_medium() const {
    RayInfo out = *this;
    out.kind = kVolume;
    out.through = out.singular = false;
    out.from = 0;
    out.left = 0;
    ++out.depth;
    return out;
  }
};

// Rays by which something is seen: a bit for each kind. Light samples come by shadow rays. What a
// translucent surface scatters through itself sees what rays of transmission see, as in Cycles; for
// lights it has a bit of its own, see light_rays().
using RayMask = uint32_t;
inline constexpr RayMask kAllRays = ~0u;
constexpr RayMask ray_bit(RayInfo::Kind kind) { return 1u << kind; }
// Met by nothing that moves: of no path.
inline constexpr RayMask kStillRays = 1u << 7;
// Where the bits of rays that meet shadow catchers alone begin.
inline constexpr int kCatcherShift = 8;
inline constexpr RayMask kCatcherRays = 0x7fu << kCatcherShift;
// What a ray is met by, or one of another kind on the same path.
constexpr RayMask ray_mask(const RayInfo& ray, RayInfo::Kind kind) {
  return ray_bit(kind) << (ray.catchers_only ? kCatcherShift : 0);
}
constexpr RayMask ray_mask(const RayInfo& ray) {
  const bool translucent = ray.kind == RayInfo::kDiffuse && ray.through;
  return ray_mask(ray, translucent ? RayInfo::kTransmission : ray.kind);
}
inline constexpr RayMask kScatteredRays =
    ray_bit(RayInfo::kDiffuse) | ray_bit(RayInfo::kGlossy) | ray_bit(RayInfo::kTransmission);

// Of lights: what diffuse lobes send through surfaces. Nothing moves there, see kStillRays.
inline constexpr RayMask kTranslucentRays = kStillRays;
constexpr RayMask lobe_rays(bool diffuse, bool transmitted) {
  return diffuse       ? transmitted ? kTranslucentRays : ray_bit(RayInfo::kDiffuse)
         : transmitted ? ray_bit(RayInfo::kTransmission)
                       : ray_bit(RayInfo::kGlossy);
}
// What a light is seen by, from what Blender says. Cycles shows lamps to what translucent surfaces
// scatter if diffuse rays see them, by light samples, and the world if rays of transmission see it,
// too, by rays that find it.
constexpr RayMask light_rays(RayMask seen_by, bool world) {
  const RayMask asked =
      ray_bit(RayInfo::kDiffuse) | (world ? ray_bit(RayInfo::kTransmission) : RayMask{0});
  return (seen_by & asked) == asked ? seen_by | kTranslucentRays : seen_by & ~kTranslucentRays;
}

// Whether a light is seen by some scattered rays and not by others.
constexpr bool hides_from_some(RayMask seen_by) {
  constexpr RayMask all = kScatteredRays | kTranslucentRays;
  return (seen_by & all) != 0 && (seen_by & all) != all;
}

// For light that is scattered only these make a difference.
constexpr RayMask as_scattered(RayMask seen_by) {
  return seen_by | ~(kScatteredRays | kTranslucentRays | ray_bit(RayInfo::kVolume));
}

// Where a lamp stands, in coordinates relative to the scene's origin.
struct LampPlace {
  Affine to_world, to_local;
};

// Where a program runs. World programs: `position` and wi = -direction, no instance. Those of
// lamps: `lamp`, no instance; (1 - u - v, u) are the lamp's own coordinates, from 0 to 1 over it.
struct ShadingPoint {
  static constexpr uint32_t kNoInstance = ~0u;
  Vec3 position;  // m, relative to the scene's origin
  Vec3 ng, ns;    // on the side of wo
  Vec3 wo;        // unit, towards where the ray came from
  bool back = false;
  uint32_t instance = kNoInstance, triangle = 0;
  float u = 0, v = 0;  // barycentric
  RayInfo ray;
  const LampPlace* lamp = nullptr;
  bool suns = true;               // those of skies show their discs
  MediumPoint* medium = nullptr;  // of volume programs: takes the closures; there is no surface
};

// Runs `program` at `point` and adds its closures to `out` (not finished). Never fails, never
// yields NaN or infinity.
void run_program(const Scene& scene, const Program& program, const ShadingPoint& point, Bsdf& out);

// Where `program` moves a vertex, m, in world space: any float. `registers` are its scratch space.
Vec3 run_displacement(const Scene& scene, const Program& program, const ShadingPoint& vertex,
                      std::vector<float>& registers);

// What the registers hold after a run of `program`, which asks for nothing of a hit: for folding of
// constants.
std::vector<float> run_constant_program(const Scene& scene, const Program& program);

// Sets what a checked program asks of the ray, and whether it bends the normals of what leaves from
// below the surface.
void look_at_program(Program& program);

// Throws std::invalid_argument for a program that reads or writes outside its registers, constants
// or textures.
void check_program(const Scene& scene, const Program& program);

}  // namespace photon_splat
