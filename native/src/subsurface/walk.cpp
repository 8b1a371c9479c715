#include "subsurface/walk.h"

#include "media/phase.h"
#include "subsurface/entry.h"
#include "subsurface/scattering.h"

namespace photon_splat {
namespace {

// As in Cycles: of white bodies a few percent of the light are lost on longer ways.
constexpr int kMostSteps = 256;
// Scatterings after which a medium's phase function no longer tells: as in Cycles
constexpr int kDirectedSteps = 10;
constexpr float kFaint = 0.05f;  // of what entered: broken off by chance
// Walks start so far below the surface, of their distance from the origin: a place by barycentric
// coordinates is that exact. One on a ray is not, and paths of a micrometre would start too deep.
constexpr float kOffset = 4e-7f;
// Of the shortest mean free path: where walks would start deeper, they start on the surface, and
// their rays behind it.
constexpr float kDeepest = 2e-3f;
// Of Surface::rounding, which is a bound: how far rays are off the surface. With a quarter of this,
// walks in a ball modelled 400 m off its origin lost 3 %.
constexpr float kLeastRounding = 0.25f;
// Mean free paths below so many offsets, or below that, cannot be told from none.
constexpr float kLeastOffsets = 4;
constexpr float kGrazing = 0.1f;  // least cosine for which rays start further back
constexpr int kMostEntries = 8;   // that a ray passes within rounding of its start

float min_component(const Rgb& c) { return std::min({c.x, c.y, c.z}); }

SubsurfaceExit leave(const Scene& scene, const Surface& entry, const Scene::OwnHit& hit,
                     const Vec3& way, const Rgb& weight, float time) {
  const bool back = dot(hit.normal, way) < 0;
  return {scene.surface_at(entry.instance, hit.triangle, hit.u, hit.v, back, time), way, weight};
}

// True where the walk leaves the body before `far`. By rounding x may lie on the other side of the
// surface that is to be left, or of the one that was entered: rays start that far behind it.
bool meets_from_within(const Scene& scene, const Surface& entry, const Vec3& x, const Vec3& way,
                       float rounding, float far, float time, Scene::OwnHit& hit) {
  if (rounding == 0) return scene.meets_itself(entry.instance, x, way, 0, far, time, hit);
  const float back = rounding / std::max(std::abs(dot(way, entry.ng)), kGrazing);
  const Vec3 origin = x - way * back;
  float near = 0;
  for (int i = 0; i < kMostEntries &&
                  scene.meets_itself(entry.instance, origin, way, near, far + back, time, hit);
       ++i) {
    const bool outwards = (dot(hit.normal, way) > 0) != entry.back;
    if (outwards || hit.distance > 2 * back) {
      hit.distance = std::max(hit.distance - back, 0.0f);
      return true;
    }
    near = std::nextafter(hit.distance, INFINITY);
  }
  return false;
}

// The chance of each channel to be walked by.
Rgb chances(const Rgb& weight, const Rgb& albedo) {
  const Rgb c = absolute(weight) * albedo;
  const float all = c.x + c.y + c.z;
  return all > 0 && std::isfinite(all) ? c / all : Rgb{1, 1, 1} / 3;
}

Vec3 scattered(const Vec3& way, float g, const Vec2& u) {
  return turned(way, Phase{PhaseKind::kHenyeyGreenstein, g, 0}.sample_cosine(u.x), u.y);
}

}  // namespace

// Each step is drawn by one channel and weighed as drawn by any (balance heuristic). Steps aimed at
// the surface (Krivanek and d'Eon, A Zero-variance-based Sampling Scheme for Monte Carlo Subsurface
// Scattering, 2014) changed the variance by -12 to +5 %: not worth their work.
std::optional<SubsurfaceExit> walk_below(const Scene& scene, const Surface& entry,
                                         const Subsurface& closure, const Vec3& way,
                                         const Rgb& carried, WalkNumbers& numbers, float time) {
  const Surface from =
      scene.surface_at(entry.instance, entry.triangle, entry.u, entry.v, entry.back, time);
  const float offset = std::max(kOffset * max_abs(from.position), 1e-30f);
  const float least = std::max(kLeastOffsets * offset, kLeastRounding * from.rounding);
  Scattering medium = scattering_of(closure);
  // Too short to be told from its start
  if (1 / std::max(min_component(medium.extinction), 1e-30f) < least)
    return SubsurfaceExit{entry, entry.ng, {1, 1, 1}};
  medium.extinction = min(medium.extinction, Rgb{1, 1, 1} / least);
  Rgb weight = medium.factor;
  const float start = max_abs(weight * carried);
  const bool on_surface = from.rounding > 0 || offset * max_component(medium.extinction) > kDeepest;
  const float rounding = on_surface ? std::max(kLeastRounding * from.rounding, 2 * offset) : 0;
  Vec3 x = on_surface ? from.position : from.position - entry.ng * offset, direction = way;
  for (int step = 0; step < kMostSteps; ++step) {
    if (step == kDirectedSteps && medium.g != 0) medium = medium.reduced();
    if (step > 0) direction = scattered(direction, medium.g, numbers.next2());
    const Rgb chance = chances(weight * carried, medium.albedo);
    Vec2 u = numbers.next2();
    int channel = 0;
    for (; channel < 2 && u.x >= chance[channel]; ++channel) u.x -= chance[channel];
    float t = -std::log1p(-u.y) / medium.extinction[channel];
    Scene::OwnHit hit;
    const bool leaves = meets_from_within(scene, entry, x, direction, rounding, t, time, hit);
    if (leaves) t = hit.distance;
    if (!std::isfinite(t)) return std::nullopt;
    const Rgb there = attenuation(medium.extinction, t);
    const float pdf = dot(chance, leaves ? there : medium.extinction * there);
    if (!(pdf > 0)) return std::nullopt;
    weight *= (leaves ? there : medium.scattering() * there) / pdf;
    if (leaves) return leave(scene, entry, hit, direction, weight, time);
    x += direction * t;
    const float left = max_abs(weight * carried);
    if (!(left > 0) || !is_finite(x)) return std::nullopt;
    if (left >= kFaint * start) continue;
    const float survival = left / (kFaint * start);
    if (numbers.next() >= survival) return std::nullopt;
    weight *= 1 / survival;
  }
  return std::nullopt;
}

std::optional<SubsurfaceExit> scatter_below(const Scene& scene, const Surface& entry,
                                            const Subsurface& closure, const Vec3& wo,
                                            const Rgb& carried, WalkNumbers& numbers, float time) {
  std::optional<SubsurfaceExit> exit;
  if (closure.method == SubsurfaceMethod::kBurley) {
    exit = project_below(scene, entry, closure, numbers, time);
  } else {
    Vec3 way;
    if (!sample_entry(closure, wo, numbers.next2(), &way) || dot(way, entry.ng) >= 0)
      return std::nullopt;
    exit = walk_below(scene, entry, closure, way, carried * closure.weight, numbers, time);
  }
  if (!exit) return std::nullopt;
  exit->weight *= closure.weight;
  if (!is_finite(exit->weight)) return std::nullopt;
  return exit;
}

}  // namespace photon_splat
