#include "density/bent_occlusion.h"

#include <bit>

#include "density/bent_mass.h"
#include "density/bent_places.h"
#include "density/cover.h"
#include "density/enclosure.h"

namespace photon_splat {
namespace {

constexpr float kHeight = 0.03f;  // of ways over the surface, in h
constexpr float kReach = 0.7f;    // of a disc's radius: further off it has little weight
// In distances: the patch is looked for so far behind what has been met
constexpr float kBeyond = 0.1f;
// The mass divides: probes until so many have been in the open, as the number that it takes is in
// the mean what it is to be divided by
constexpr int kEnough = 4, kMostProbes = 96, kMostDraws = 1024;
constexpr int kWays = 8;             // to the rim, that look for other things
constexpr float kMostOverOpen = 10;  // whatever the probes say
constexpr float kClose = 0.001f;     // of ways that tell what is inside, in h over the surface
constexpr int kMostSteps = 16;       // of a way: surfaces that it goes through

// A disc, and rays just over the surface about its middle.
struct BentDisc {
  BentDisc(const Scene& s, uint32_t instance, uint32_t triangle, uint32_t surface_key,
           const Vec3& middle, const Vec3& n, float radius)
      : scene(s),
        kinds(s.keeping_off(instance)),
        key(surface_key),
        x(middle),
        h(radius),
        height(std::max(kHeight * radius, ray_epsilon(middle, radius))),
        basis(n) {
    const Instance& placed = scene.instances[instance];
    const float curvature =
        scene.meshes[placed.mesh].topology.curvature_of(triangle) / placed.scale;
    tilt = std::min(0.5f * curvature * h, 0.5f);
  }

  const Vec3& normal() const { return basis.normal; }
  Vec3 origin() const { return x + normal() * height; }
  float close() const { return std::max(kClose * h, ray_epsilon(x, h)); }
  bool is_own(const Surface& hit) const { return (hit.key | 1u) == (key | 1u); }

  // By turns level and a little downwards, as the patch may bend away.
  void aim(float turn, Vec3 ways[Scene::kPacket]) const {
    for (uint32_t k = 0; k < Scene::kPacket; ++k)
      ways[k] = way(turn + 2 * kPi * static_cast<float>(k) / Scene::kPacket, k % 2 ? tilt : 0);
  }
  Vec3 way(float angle, float down) const {
    return normalize(basis.to_world({std::cos(angle), std::sin(angle), -down}));
  }

  // What those rays meet, as bits.
  unsigned meet(const Vec3 ways[Scene::kPacket], Surface hits[Scene::kPacket]) const {
    Vec3 origins[Scene::kPacket];
    std::fill_n(origins, Scene::kPacket, origin());
    return scene.intersect_packet(origins, ways, Scene::kPacket, hits, kinds);
  }

  const Scene& scene;
  RayMask kinds;
  uint32_t key;
  Vec3 x;
  float h, height;
  Basis basis;
  float tilt = 0;  // to where the surface is at the rim
};

// Calls met(surface) for what lies on the way from one place to another, one after the other, until
// it says true: then this is true, too.
template <class Met>
bool walk(const Scene& scene, RayMask kinds, const Vec3& from, const Vec3& way, float far,
          Met&& met) {
  float near = 0;
  Surface hit;
  for (int step = 0; step < kMostSteps; ++step) {
    if (!scene.intersect(from, way, near, far, false, hit, kinds)) return false;
    if (met(hit)) return true;
    near = hit.distance + ray_epsilon(hit.position, hit.distance);
  }
  return false;
}

// Whether anything else is on the ways to the rim of the patch, which go under it where it bends.
bool meets_others(const BentDisc& disc, float turn) {
  const Vec3 from = disc.x + disc.normal() * disc.close();
  for (int k = 0; k < kWays; ++k) {
    const float angle = turn + 2 * kPi * static_cast<float>(k) / kWays;
    if (walk(disc.scene, disc.kinds, from, disc.way(angle, disc.tilt), disc.h,
             [&](const Surface& hit) { return !disc.is_own(hit); }))
      return true;
  }
  return false;
}

// Whether anything else lies close over the disc, by looks down to it from all over it.
bool is_covered_somewhere(const BentDisc& disc, float turn) {
  Vec3 origins[Scene::kPacket], ways[Scene::kPacket];
  for (uint32_t k = 0; k < Scene::kPacket; ++k) {
    const float s = std::sqrt((static_cast<float>(k) + 0.5f) / Scene::kPacket),
                angle = turn + kGoldenAngle * static_cast<float>(k);
    origins[k] = disc.x + disc.basis.to_world({disc.h * s * std::cos(angle),
                                               disc.h * s * std::sin(angle), kCover * disc.h});
    ways[k] = -disc.normal();
  }
  Surface hits[Scene::kPacket];
  for (unsigned met = disc.scene.intersect_packet(origins, ways, Scene::kPacket, hits, disc.kinds);
       met; met &= met - 1) {
    const Surface& hit = hits[std::countr_zero(met)];
    if (hit.distance < disc.h && !disc.is_own(hit)) return true;
  }
  return false;
}

// Whether something lies, or hovers, close over that place, and no light comes in under it.
bool is_covered(const BentDisc& disc, const Vec3& place, const Vec3& normal, Random& random) {
  const auto cover = cover_of(disc.scene, disc.kinds, place, normal, disc.h);
  return cover && !cover->shines && (cover->key | 1u) != (disc.key | 1u) &&
         light_from_rim(disc.scene, disc.kinds, place, normal, disc.h, random) !=
             FromRim::kStraight;
}

// Whether the way from over x to over that place ends inside of something closed that lets no light
// through.
bool is_inside(const BentDisc& disc, const BentPlaces::Place& place) {
  const Vec3 from = disc.x + disc.normal() * disc.close(),
             way = place.position + place.normal * disc.close() - from;
  const float distance = length(way);
  if (!(distance > 0)) return false;
  struct Entered {
    uint32_t instance;
    int times;
  } entered[kMostSteps];
  int count = 0;
  walk(disc.scene, disc.kinds, from, way / distance, distance, [&](const Surface& hit) {
    const Mesh& mesh = disc.scene.meshes[disc.scene.instances[hit.instance].mesh];
    if (hit.on_strand() || !mesh.topology.closed || !is_dark(disc.scene, hit, -way / distance))
      return false;
    int i = 0;
    while (i < count && entered[i].instance != hit.instance) ++i;
    if (i == count) entered[count++] = {hit.instance, 0};
    entered[i].times += hit.back ? -1 : 1;
    return false;
  });
  return std::any_of(entered, entered + count, [](const Entered& e) { return e.times != 0; });
}

}  // namespace

bool stands_in_bent_disc(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                         const Vec3& x, const Vec3& normal, float h) {
  const BentDisc disc(scene, instance, triangle, key, x, normal, h);
  const Vec3 origin = disc.origin();
  const auto patch_below = [&](const Vec3& place, Surface& found) {
    return scene.intersect(place, -normal, 0, h, false, found) && disc.is_own(found);
  };
  Vec3 ways[Scene::kPacket];
  const uint32_t draw = hash_combine(std::bit_cast<uint32_t>(x.x), std::bit_cast<uint32_t>(x.y));
  disc.aim(2 * kPi * to_unit_float(draw), ways);
  Surface hits[Scene::kPacket];
  for (unsigned met = disc.meet(ways, hits); met; met &= met - 1) {
    const int k = std::countr_zero(met);
    const Surface& hit = hits[k];
    if (hit.distance >= kReach * h || disc.is_own(hit)) continue;
    // What has been met may hang over the surface, or stand beside a fold of it: only what also
    // parts the surface under it stands in the disc.
    Surface before, behind, wall;
    const float to_before = std::max(0.0f, hit.distance - kBeyond * h);
    if (!patch_below(origin + ways[k] * (hit.distance + kBeyond * h), behind) ||
        !patch_below(origin + ways[k] * to_before, before))
      continue;
    const Vec3 from = before.position + normal * disc.height;
    const Vec3 way = behind.position + normal * disc.height - from;
    const float distance = length(way);
    if (distance > 0 &&
        scene.intersect(from, way / distance, 0, distance, false, wall, disc.kinds) &&
        !disc.is_own(wall))
      return true;
  }
  return false;
}

OverOpen over_open_share(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                         const Vec3& x, const Vec3& normal, float h, uint32_t seed) {
  const BentDisc disc(scene, instance, triangle, key, x, normal, h);
  Random random(seed, 0xbe47);
  const float turn = 2 * kPi * random.next();
  const bool covered =
      is_covered_somewhere(disc, turn) && !cover_of(scene, disc.kinds, x, normal, h);
  if (!covered && !meets_others(disc, turn)) return {};
  const BentPlaces places(scene, instance, triangle, x, normal, h);
  Masses all, open;
  int probes = 0, opened = 0;
  for (int draw = 0; draw < kMostDraws && probes < kMostProbes && opened < kEnough; ++draw) {
    BentPlaces::Place y;
    if (!places.draw(random, y)) continue;
    ++probes;
    // Of the narrow kernel, as a share of the other
    const double narrow =
        y.weight * std::max(1 - y.distance2 / sqr(kNarrow), 0.0f) / (1 - y.distance2);
    all.wide += y.weight, all.narrow += narrow;
    if ((covered && is_covered(disc, y.position, y.normal, random)) || is_inside(disc, y)) continue;
    ++opened;
    open.wide += y.weight, open.narrow += narrow;
  }
  const auto over = [](double whole, double part) {
    return static_cast<float>(whole < kMostOverOpen * part ? whole / part : kMostOverOpen);
  };
  if (!(all.wide > 0)) return {};
  return {over(all.wide, open.wide), all.narrow > 0 ? over(all.narrow, open.narrow) : 1.0f};
}

}  // namespace photon_splat
