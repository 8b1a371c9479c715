// Subsurface light by Christensen and Burley's profile: a ray through the body near the entry finds
// where light leaves (King et al., BSSRDF Importance Sampling, 2013).
#include "bsdf/fresnel.h"
#include "subsurface/walk.h"

namespace photon_splat {
namespace {

// In units of d: where the profile ends, and its integral up to there
constexpr float kEnd = 16, kWithin = 0.9963790093708328f;
constexpr int kMostHits = 4;         // of a ray, that are thought of
constexpr int kMostCrossings = 256;  // that it looks at

// The profile times 2 pi r, 1/m; 0 from its end on.
float profile(float d, float r) {
  if (!(d > 0) || r >= kEnd * d) return 0;
  const float third = std::exp(-r / (3 * d));
  return (third * third * third + third) / (4 * d * kWithin);
}

// r/d at which the integral of the profile is u: Newton's method, from below, where it is concave.
float sample_profile(float u) {
  const float all = u * kWithin;
  float r = -3 * std::log1p(-all) * 0.5f;
  for (int i = 0; i < 12; ++i) {
    const float third = std::exp(-r / 3), whole = third * third * third;
    const float miss = 1 - 0.25f * whole - 0.75f * third - all;
    const float slope = 0.25f * (whole + third);
    if (std::abs(miss) < 1e-6f || !(slope > 0)) break;
    r = std::clamp(r - miss / slope, 0.0f, kEnd);
  }
  return r;
}

struct Found {
  SubsurfaceExit exit;
  float mean;  // of its weight
};

}  // namespace

std::optional<SubsurfaceExit> project_below(const Scene& scene, const Surface& entry,
                                            const Subsurface& closure, WalkNumbers& numbers,
                                            float time) {
  const Vec2 u = numbers.next2();
  const Rgb d = closure.radius;
  // The channels that go below
  int channels[3], count = 0;
  for (int i = 0; i < 3; ++i)
    if (closure.weight[i] > 0 && d[i] > 0) channels[count++] = i;
  if (count == 0) return std::nullopt;
  // Through the surface half of the time, else along it
  const Basis frame(entry.ng);
  const Vec3 axes[3] = {entry.ng, frame.tangent, frame.bitangent};
  const int axis = u.y < 0.5f ? 0 : u.y < 0.75f ? 1 : 2;
  const float turn = axis == 0 ? u.y * 2 : (u.y - (axis == 1 ? 0.5f : 0.75f)) * 4;
  const float pick = u.x * static_cast<float>(count);
  const int place = std::min(static_cast<int>(pick), count - 1);
  const float own = d[channels[place]];
  const float distance = own * sample_profile(std::min(pick - static_cast<float>(place), 0.9999f));
  const float height = std::sqrt(std::max(0.0f, sqr(kEnd * own) - sqr(distance)));
  const Vec2 around = cos_sin_of_turn(std::min(turn, 1.0f));
  const Vec3 &n = axes[axis], &a = axes[(axis + 1) % 3], &b = axes[(axis + 2) % 3];
  const Vec3 start = entry.position + n * height + (a * around.x + b * around.y) * distance;
  float pdf = 0;
  for (int i = 0; i < count; ++i)
    pdf += profile(d[channels[i]], distance) / static_cast<float>(count);
  if (!(pdf > 0)) return std::nullopt;

  std::optional<Found> kept[kMostHits];
  int hits = 0;
  float near = 0;
  Scene::OwnHit hit;
  for (; hits < kMostCrossings && near < 2 * height &&
         scene.meets_itself(entry.instance, start, -n, near, 2 * height, time, hit);
       ++hits) {
    near = std::nextafter(hit.distance + ray_epsilon(start, hit.distance), INFINITY);
    // A random choice where there are too many
    int slot = hits;
    if (hits >= kMostHits) slot = static_cast<int>(numbers.next() * static_cast<float>(hits + 1));
    if (slot >= kMostHits) continue;
    // The side of the entry
    const Surface surface =
        scene.surface_at(entry.instance, hit.triangle, hit.u, hit.v, entry.back, time);
    float by_axes = 0, by_own = 0;
    for (int i = 0; i < 3; ++i) {
      const float p = (i == 0 ? 0.5f : 0.25f) * std::abs(dot(axes[i], surface.ng));
      by_axes += sqr(p);
      if (i == axis) by_own = p;
    }
    const float r = length(surface.position - entry.position);
    const Rgb eval{profile(d.x, r), profile(d.y, r), profile(d.z, r)};
    const Rgb weight = by_axes > 0 ? eval * (by_own / by_axes / pdf) : Rgb{};
    kept[slot] = Found{{surface, surface.ng, weight}, average(weight)};
  }
  float all = 0;
  for (int i = 0; i < std::min(hits, kMostHits); ++i) all += kept[i]->mean;
  if (!(all > 0)) return std::nullopt;
  float choice = numbers.next() * all;
  int chosen = 0;
  for (int i = 0; i < std::min(hits, kMostHits); ++i) {
    if (!(kept[i]->mean > 0)) continue;
    chosen = i;
    if (choice < kept[i]->mean) break;
    choice -= kept[i]->mean;
  }
  SubsurfaceExit exit = kept[chosen]->exit;
  exit.weight *=
      all / kept[chosen]->mean * (hits > kMostHits ? static_cast<float>(hits) / kMostHits : 1.0f);
  return exit;
}

}  // namespace photon_splat
