// Nodes that trace rays from the hit: Ambient Occlusion, Bevel, Raycast.
#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

constexpr RayMask kBlocking = ray_bit(RayInfo::kShadow);

bool can_trace(const Frame& f) { return f.is_on_surface() && f.scene.is_built(); }

// Seed from the place alone: a hit that is shaded twice looks the same.
uint32_t seed_at(const Frame& f, uint32_t node) {
  const uint32_t there = hash_combine(f.point.triangle, f.point.instance);
  return hash_combine(hash_combine(node, there), hash_of(f.point.position));
}

Vec3 start(const Frame& f, const Vec3& direction) {
  if (f.strands()) return f.point.position;
  const float known = ray_epsilon(f.point.position, f.point.ray.length),
              epsilon = known + f.scene.rounding_beyond(known, f.point.instance, f.point.triangle);
  return f.point.position + f.point.ng * (dot(direction, f.point.ng) > 0 ? epsilon : -epsilon);
}

bool meets(const Frame& f, const Vec3& origin, const Vec3& direction, float far, bool itself) {
  if (!itself) return f.scene.occluded(origin, direction, 0, far, kBlocking, f.point.ray.time);
  Scene::OwnHit hit;
  return f.scene.meets_itself(f.point.instance, origin, direction, 0, far, f.point.ray.time, hit);
}

// A disc around the hit that Bevel looks through: axes, the first of them across it, and the chance
// to be taken.
struct Disc {
  Vec3 across, x, y;
  float chance;
};

// Density of the offset on a disc, 10 (R - r)^3 / (pi R^5): what lies farther off counts less.
float offset_density(float radius, float r) {
  if (r >= radius) return 0;
  const float left = 1 - r / radius;
  return 10 * left * left * left / (kPi * radius * radius);
}

// An offset of that density, m: the root of 10 x^2 - 20 x^3 + 15 x^4 - 4 x^5 = u by Newton's method
// and halving.
float sample_offset(float radius, float u) {
  float low = 0, high = 1, x = 0.5f;
  for (int i = 0; i < 16; ++i) {
    const float x2 = x * x, error = x2 * (10 + x * (-20 + x * (15 - 4 * x))) - u;
    (error < 0 ? low : high) = x;
    const float left = 1 - x, slope = 20 * x * left * left * left;
    const float next = slope > 0 ? x - error / slope : low;
    x = next > low && next < high ? next : 0.5f * (low + high);
  }
  return x * radius;
}

Surface surface_met(const Frame& f, const Scene::OwnHit& hit, const Vec3& direction) {
  const bool back = dot(hit.normal, direction) > 0;
  return f.scene.surface_at(f.point.instance, hit.triangle, hit.u, hit.v, back, f.point.ray.time);
}

// Sum of the normals that a ray through a disc meets, by distance and by the chance that a ray
// along another axis would have met them.
Vec3 normals_met(const Frame& f, const Disc* discs, const Disc& disc, float radius, const Vec2& u) {
  constexpr int kMostMet = 16;
  const float r = sample_offset(radius, u.y), phi = 2 * kPi * u.x;
  const float half = std::sqrt(std::max(radius * radius - r * r, 0.0f));
  if (!(half > 0)) return {};
  const Vec3 origin = f.point.position + disc.across * half + disc.x * (r * std::cos(phi)) +
                      disc.y * (r * std::sin(phi));
  Vec3 sum{};
  float near = 0;
  Scene::OwnHit hit;
  for (int i = 0; i < kMostMet && f.scene.meets_itself(f.point.instance, origin, -disc.across, near,
                                                       2 * half, f.point.ray.time, hit);
       ++i) {
    const Vec3 place = origin - disc.across * hit.distance;
    float squares = 0;
    for (int k = 0; k < 3; ++k) {
      const float p = discs[k].chance * dot(discs[k].across, hit.normal);
      squares += p * p;
    }
    const float own = disc.chance * std::abs(dot(disc.across, hit.normal));
    const float weight = own / squares * offset_density(radius, length(place - f.point.position)) /
                         offset_density(radius, r);
    const Surface met = surface_met(f, hit, -disc.across);
    if (std::isfinite(weight)) sum += (met.back ? -met.ns : met.ns) * weight;
    near = std::nextafter(hit.distance + ray_epsilon(place, hit.distance), INFINITY);
  }
  return sum;
}

// Cycles leaves edges sharp where rays of little density come; these are such.
bool looks_closely(const RayInfo& ray) {
  return !ray.after_diffuse && (ray.kind == RayInfo::kCamera || ray.kind == RayInfo::kGlossy ||
                                ray.kind == RayInfo::kTransmission);
}

}  // namespace

void ambient_occlusion(Frame& f, const uint32_t* w) {
  const float distance = f.number(w[1]);
  const uint32_t samples = w[3];
  if (!can_trace(f) || !(distance > 0) || !samples) return f.set(w[0], 1.0f);
  Vec3 normal = safe_normalize(f.vector(w[2]));
  if (f.on(w[4])) normal = -normal;
  const Basis basis(normal);
  const uint32_t seed = seed_at(f, w[0]);
  uint32_t open = 0;
  for (uint32_t i = 0; i < samples; ++i) {
    const Vec3 direction = basis.to_world(sample_cosine_hemisphere(sobol_2d(i, 0, seed)));
    open += !meets(f, start(f, direction), direction, distance, f.on(w[5]));
  }
  f.set(w[0], static_cast<float>(open) / static_cast<float>(samples));
}

void bevel(Frame& f, const uint32_t* w) {
  const float radius = f.number(w[1]);
  const uint32_t samples = w[3];
  const Vec3 given = f.vector(w[2]);
  if (!can_trace(f) || f.strands() || !(radius > 0) || !std::isfinite(radius) || !samples ||
      !looks_closely(f.point.ray))
    return f.set(w[0], given);
  const Basis basis(f.point.ng);
  const Vec3 n = f.point.ng, s = basis.to_world({1, 0, 0}), t = basis.to_world({0, 1, 0});
  const Disc discs[3] = {{n, s, t, 0.5f}, {s, n, t, 0.25f}, {t, s, n, 0.25f}};
  const uint32_t seed = seed_at(f, w[0]);
  Vec3 sum{};
  for (uint32_t i = 0; i < samples; ++i) {
    Vec2 u = sobol_2d(i, 0, seed);
    const int which = u.x < 0.5f ? 0 : u.x < 0.75f ? 1 : 2;
    u.x = which == 0 ? 2 * u.x : 4 * (u.x - (which == 1 ? 0.5f : 0.75f));
    sum += normals_met(f, discs, discs[which], radius, u);
  }
  const float l = length(sum);
  if (!(l > 0)) return f.set(w[0], given);
  const Vec3 round = sum * ((f.point.back ? -1.0f : 1.0f) / l);
  f.set(w[0], safe_normalize(given + (round - f.ns)));
}

// The direction is taken as long as it is, and distances in it, as in Cycles.
void raycast(Frame& f, const uint32_t* w) {
  const Vec3 direction = f.vector(w[6]);
  const float far = f.number(w[7]);
  float hits = 0, self = 0, distance = far;
  Vec3 place{}, normal{};
  if (can_trace(f) && length2(direction) > 0 && is_finite(direction) && far > 0) {
    const Vec3 given = f.vector(w[5]), own = f.position();
    const Vec3 from =
        !(length2(given - own) > 0) ? start(f, direction) : f.point.position + (given - own);
    const auto found = [&](float at, uint32_t instance, const Vec3& n) {
      hits = 1;
      self = instance == f.point.instance ? 1.0f : 0.0f;
      distance = at;
      place = given + direction * at;
      normal = n;
    };
    const float time = f.point.ray.time;
    Surface s;
    Scene::OwnHit itself;
    if (!f.on(w[8])) {
      if (f.scene.intersect(from, direction, 0, far, false, s, kAllRays, time))
        found(s.distance, s.instance, s.ns);
    } else if (f.scene.meets_itself(f.point.instance, from, direction, 0, far, time, itself)) {
      found(itself.distance, f.point.instance, surface_met(f, itself, direction).ns);
    }
  }
  f.set(w[0], hits);
  f.set(w[1], self);
  f.set(w[2], distance);
  f.set(w[3], place);
  f.set(w[4], normal);
}

}  // namespace photon_splat::nodes
