// Area lamps and emissive meshes that lie in the plane of a surface. Elsewhere what stands within
// rounding of a light is no obstacle, and photons start clear of it; here that decides whether the
// light lights anything. For a lamp, as in Cycles, rays decide that go to the very place on it, and
// rounding with them: all estimators ask the same. A mesh sends the same share past the surface
// everywhere, and light samples alone find it: which of the two rays meet first says nothing.
#include "lights/emission/photon_emitter.h"

namespace photon_splat {
namespace {

constexpr int kProbes = 16;
constexpr int kFirstProbes = 4;  // of a mesh: others are sent where one of these finds a surface
// What an emissive mesh sends past the surface. In Cycles rounding decides for each ray, and lets
// .57 to .80 pass in rooms of any size and turn.
constexpr float kPastSurface = 0.63f;
constexpr float kShare = 0.25f;  // of the probes that a surface must be at
constexpr float kSlack = 1e-5f;  // of a distance: what light samples pass over before other lights
constexpr float kClear = 4;      // roundings that a photon starts away from the lamp
constexpr float kOfEdges = 2e-7f;  // of a triangle's longest edge: where it is, but for rounding

}  // namespace

// Counts a surface found across a light's plane, `gap` away from the place on it.
void Lights::Closeness::add(const Scene& scene, const Vec3& place, const Surface& s, float gap) {
  Vec3 corner[3];
  scene.corners(s.instance, s.triangle, kShutterCentre, corner);
  const float longest =
      std::sqrt(std::max({length2(corner[1] - corner[0]), length2(corner[2] - corner[1]),
                          length2(corner[0] - corner[2])}));
  ++found;
  if (gap > std::max(kClear * ray_epsilon(place, 0), kOfEdges * longest)) return;
  ++within_rounding;
  instance = s.instance;
}
bool Lights::Closeness::in_surface() const {
  return static_cast<float>(within_rounding) >= kShare * kProbes;
}
bool Lights::Closeness::near_surface() const {
  return static_cast<float>(found) >= kShare * kProbes;
}

// By rays across the lamp's plane.
Lights::Closeness Lights::closeness(const Lamp& lamp) const {
  Closeness out;
  for (int i = 0; i < kProbes; ++i) {
    const Vec2 u{(static_cast<float>(i % 4) + 0.5f) / 4, (static_cast<float>(i / 4) + 0.5f) / 4};
    const Vec2 p = lamp.s.ellipse ? sample_disk(u) : Vec2{2 * u.x - 1, 2 * u.y - 1};
    const Vec3 place =
        lamp.center + lamp.axis_x * (p.x * lamp.half_x) + lamp.axis_y * (p.y * lamp.half_y);
    const float reach = std::max(kClear * ray_epsilon(place, 0), 2 * kSlack * scene_.near_radius());
    Surface s;
    if (!scene_.intersect(place - lamp.forward * reach, lamp.forward, 0, 2 * reach, false, s) ||
        scene_.may_be_transparent(s) || s.on_strand())
      continue;
    out.add(scene_, place, s, std::abs(s.distance - reach));
  }
  return out;
}

// By rays across its triangles from either side, of which one at the least meets the surface first,
// unless it is the mesh's twin.
Lights::Closeness Lights::closeness(const Emitter& mesh) const {
  Closeness out;
  for (int i = 0; i < kProbes && (i < kFirstProbes || out.found); ++i) {
    const Vec2 u = sobol_2d(static_cast<uint32_t>(i), 1, 0);
    EmissiveTriangle moved;
    const MeshPoint p =
        mesh.mesh.point_at(scene_, mesh.instance, sobol_2d(static_cast<uint32_t>(i), 0, 0).x, u,
                           kShutterCentre, moved);
    const float reach =
        std::max(kClear * ray_epsilon(p.position, 0), 2 * kSlack * scene_.near_radius());
    for (const float side : {1.0f, -1.0f}) {
      const Vec3 towards = p.triangle->normal * side;
      Surface s;
      if (!scene_.intersect(p.position - towards * reach, towards, 0, 2 * reach, false, s) ||
          s.instance == mesh.instance || scene_.may_be_transparent(s) || s.on_strand())
        continue;
      out.add(scene_, p.position, s, std::abs(s.distance - reach));
      break;
    }
  }
  return out;
}

void Lights::find_lights_in_surfaces() {
  if (scene_.bounds().empty()) return;
  for (Emitter& e : emitters_) {
    const Lamp* const lamp = e.lamp >= 0 ? &lamps_[e.lamp] : nullptr;
    if (lamp && lamp->s.kind != LampKind::kArea) continue;
    const Closeness close = lamp ? closeness(*lamp) : closeness(e);
    if (lamp && close.near_surface())
      e.exact = any_exact_ = true;
    else if (close.in_surface())
      e.past_surface = kPastSurface;
    if (close.in_surface())
      in_surfaces_.push_back(
          {lamp ? static_cast<int32_t>(lamp->number) : -1, e.instance, close.instance});
  }
}

bool Lights::blocked_exactly(uint32_t emitter, const Vec3& origin, const Vec3& place, float time,
                             RayMask kinds) const {
  const Vec3 way = place - origin;
  const float distance = length(way);
  if (!(distance > 0)) return false;
  Surface s;
  for (float near = 0;
       scene_.intersect(origin, way / distance, near, distance, false, s, kinds, time);
       near = past(s))
    if (emitters_[emitter].blockers & scene_.instances[s.instance].group &&
        !scene_.may_be_transparent(s))
      return true;
  return false;
}

float Lights::reach_of_exact(float far) const { return any_exact_ ? far * (1 + kSlack) : far; }

// Starts clear of the surface; what it meets first is lit if the lamp's place can be seen from
// there.
void PhotonEmitter::start_exactly(uint32_t emitter, PhotonStart& start) const {
  start.exact = static_cast<int32_t>(emitter);
  start.place = start.origin;
  start.origin += lamps_[emitters_[emitter].lamp].forward * (kClear * ray_epsilon(start.origin, 0));
}

}  // namespace photon_splat
