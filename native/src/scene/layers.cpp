// Surfaces that let light pass and lie in others to within rounding: decals on walls, drinks that
// fill their glass. A ray goes on beyond rounding from what it passes, and would miss the other.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "math/sampling.h"
#include "media/media.h"
#include "scene/scene.h"

namespace photon_splat {
namespace {

constexpr float kGrazing = 0.02f;       // least cosine for which the way between them is known
constexpr uint32_t kSamples = 1 << 15;  // looks for them in the whole scene
constexpr uint32_t kMostLooks = 16;     // at one triangle

}  // namespace

// They are passed one by one in an order of their own, those last that surely stop light.
bool Scene::meets_layer(Surface& s, const Vec3& origin, const Vec3& direction, RayMask kinds,
                        float time) const {
  using Place = std::tuple<bool, float, uint32_t, uint32_t>;
  const auto has_medium = [&](uint32_t instance, uint32_t triangle) {
    return media_ && media_->region_of(instance, triangle) >= 0;
  };
  if (has_medium(s.instance, s.triangle)) return false;  // Media::meet_touched() knows
  const float offset = ray_offset(s),
              reach = offset / std::max(std::abs(dot(direction, s.ng)), kGrazing);
  const Crossings crossings = this->crossings(
      origin, direction, std::max(s.distance - 2 * reach, 0.0f), s.distance + reach, kinds, time);
  const auto place = [&](const Crossings::Met& m) {
    return Place{stops_light(m.instance, m.triangle), m.distance, m.instance, m.triangle};
  };
  Place own{false, s.distance, s.instance, s.triangle};
  for (const Crossings::Met& met : crossings)
    if (met.instance == s.instance && met.triangle == s.triangle) own = place(met);
  const Material* const material = &material_of(s.instance, s.triangle);
  const Crossings::Met* next = nullptr;
  for (const Crossings::Met& met : crossings) {
    if (meshes[instances[met.instance].mesh].strands ||
        &material_of(met.instance, met.triangle) == material ||
        has_medium(met.instance, met.triangle))
      continue;
    if (place(met) > own && (!next || place(met) < place(*next))) next = &met;
  }
  if (!next) return false;
  const float beyond = past(s);
  s = surface_at(next->instance, next->triangle, next->u, next->v, next->back, time);
  s.distance = std::max(next->distance, beyond);
  return true;
}

bool Scene::stops_light(uint32_t instance, uint32_t triangle) const {
  const int program = material_of(instance, triangle).program;
  return program < 0 || !(programs[program].features & kProgramTransparent);
}

// Looked up at points of their surfaces: what none of them finds is too small to be seen.
void Scene::update_layers(const CancelFlag& cancel) {
  for (Instance& instance : instances) instance.layered = false;
  if (!(features_ & kProgramTransparent)) return;
  std::vector<uint32_t> clear;
  for (uint32_t i = 0; i < instances.size(); ++i) {
    const Instance& instance = instances[i];
    bool any = false;
    for (uint32_t slot = 0; slot < instance.slot_count; ++slot) {
      const int program = materials[slot_materials[instance.first_material + slot]].program;
      any |= program >= 0 && programs[program].features & kProgramTransparent;
    }
    if (any && !meshes[instance.mesh].strands && !meshes[instance.mesh].triangles.empty())
      clear.push_back(i);
  }
  if (clear.empty()) return;
  const size_t step = (clear.size() - 1) / kSamples + 1,
               samples = std::max<size_t>(kSamples * step / clear.size(), 1);
  bool any = false;
  for (size_t i = 0; i < clear.size(); i += step) {
    cancel.check();
    any |= instances[clear[i]].layered = lies_in_another(clear[i], static_cast<uint32_t>(samples));
  }
  if (any && step > 1)  // not all have been asked
    for (const uint32_t i : clear) instances[i].layered = true;
}

bool Scene::lies_in_another(uint32_t instance, uint32_t samples) const {
  const uint32_t triangles =
                     static_cast<uint32_t>(meshes[instances[instance].mesh].triangles.size()),
                 step = (triangles - 1) / samples + 1,
                 looks = std::clamp(samples / triangles, 1u, kMostLooks);
  for (uint32_t triangle = 0; triangle < triangles; triangle += step) {
    if (stops_light(instance, triangle)) continue;
    for (uint32_t look = 0; look < looks; ++look) {
      Vec2 at = sobol_2d(look, 0, triangle);
      if (at.x + at.y > 1) at = {1 - at.x, 1 - at.y};
      Surface s = surface_at(instance, triangle, at.x, at.y, false);
      if (!is_finite(s.position) || !is_finite(s.ng)) continue;
      const float distance = near_radius();
      s.distance = distance;
      if (meets_layer(s, s.position + s.ng * distance, -s.ng, kAllRays, kShutterCentre))
        return true;
    }
  }
  return false;
}

}  // namespace photon_splat
