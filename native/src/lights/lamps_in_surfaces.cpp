// Area lamps that lie in the plane of a surface. Elsewhere what stands within rounding of a light
// is no obstacle, and photons start clear of it; here that decides whether the lamp lights
// anything. As in Cycles rays decide that go to the very place on the lamp, and rounding with them:
// all estimators ask the same.
#include "lights/emission/photon_emitter.h"

namespace photon_splat {
namespace {

constexpr int kProbes = 16;
constexpr float kShare = 0.25f;  // of the probes that a surface must be at
constexpr float kSlack = 1e-5f;  // of a distance: what light samples pass over before other lights
constexpr float kClear = 4;      // roundings that a photon starts away from the lamp

}  // namespace

// By rays across the lamp's plane. `instance`: of a surface found.
bool Lights::lies_in_surface(const Lamp& lamp, uint32_t& instance) const {
  int found = 0;
  for (int i = 0; i < kProbes; ++i) {
    const Vec2 u{(static_cast<float>(i % 4) + 0.5f) / 4, (static_cast<float>(i / 4) + 0.5f) / 4};
    const Vec2 p = lamp.s.ellipse ? sample_disk(u) : Vec2{2 * u.x - 1, 2 * u.y - 1};
    const Vec3 place =
        lamp.center + lamp.axis_x * (p.x * lamp.half_x) + lamp.axis_y * (p.y * lamp.half_y);
    const float reach = std::max(kClear * ray_epsilon(place, 0), 2 * kSlack * scene_.near_radius());
    Surface s;
    if (!scene_.intersect(place - lamp.forward * reach, lamp.forward, 0, 2 * reach, false, s) ||
        scene_.may_be_transparent(s))
      continue;
    instance = s.instance;
    ++found;
  }
  return static_cast<float>(found) >= kShare * kProbes;
}

void Lights::find_lamps_in_surfaces() {
  if (scene_.bounds().empty()) return;
  for (Emitter& e : emitters_) {
    uint32_t instance = 0;
    if (e.lamp < 0 || lamps_[e.lamp].s.kind != LampKind::kArea ||
        !lies_in_surface(lamps_[e.lamp], instance))
      continue;
    e.exact = any_exact_ = true;
    in_surfaces_.push_back({lamps_[e.lamp].number, instance});
  }
}

bool Lights::blocked_exactly(uint32_t emitter, const Vec3& origin, const Vec3& place) const {
  const Vec3 way = place - origin;
  const float distance = length(way);
  if (!(distance > 0)) return false;
  Surface s;
  for (float near = 0; scene_.intersect(origin, way / distance, near, distance, false, s);
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
