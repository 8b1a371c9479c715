// Photons before they scatter first, and what lets them pass.
#include "photons/photon_tracer.h"

namespace photon_splat {
namespace {

constexpr int kMaxTransparent = 4096;  // layers that let a path through before it is given up
constexpr float kGrazing = 0.1f;       // cosine, below which seen_twin() does not look all the way

}  // namespace

bool PhotonTracer::arrives(const Path& path, const Vec3& place, float distance,
                           const PhotonStart& start) const {
  if (start.exact >= 0 &&
      lights_.blocked_exactly(static_cast<uint32_t>(start.exact), place, start.place, path.time))
    return false;
  const float since_lamp = distance - start.soft_nearest;
  if (start.soft_radius2 >= 0 && !(since_lamp >= path.soft_from && since_lamp <= path.soft_to))
    return false;
  return start.accepts(distance);
}

// Whether the surface takes the light: the first one only what its lamp gives it.
bool PhotonTracer::lit(const Path& path, const Surface& hit, const PhotonStart& start) const {
  if (path.bounces > 0) return true;
  return (start.lit_groups & scene_.instances[hit.instance].group) &&
         arrives(path, hit.position + hit.ng * ray_epsilon(hit.position, hit.distance),
                 path.travelled + hit.distance, start);
}

// Where a path scatters first, its power is known if its lamp has a program; false where that is
// nothing.
bool PhotonTracer::light_up(Path& path, const Vec3& place, float distance,
                            const PhotonStart& start) const {
  if (path.bounces > 0) return true;
  if (scene_.media()) path.power *= transmittance_at_lamp(path, distance, start);
  if (start.shaded_by < 0) return true;
  const Rgb factor = emitter_.first_hit_factor(start, place, distance);
  path.power *= factor;
  path.reference *= max_component(factor);
  return path.reference > 0;
}

// Where a world asks by what ray it is seen: by that of the lobe that scatters its photon first.
// `diffuse`: share of the light that diffuse lobes send that way.
bool PhotonTracer::light_up_by_ray(Path& path, const PhotonStart& start, const Rgb& diffuse,
                                   bool transmitted, bool delta) const {
  if (path.bounces > 0 || !start.asks_ray) return true;
  const auto share = [&](bool by_diffuse) {
    RayInfo ray = Environment::photon_ray(by_diffuse, transmitted, delta);
    ray.transparent_depth = path.passed;
    return lights_.environment().share(-start.direction, ray);
  };
  Rgb factor{};
  if (!is_black(diffuse)) factor += diffuse * share(true);
  if (const Rgb rest = Rgb{1, 1, 1} - diffuse; !is_black(rest)) factor += rest * share(false);
  path.power *= factor;
  path.reference *= max_component(factor);
  return path.reference > 0;
}

// Light passes what the ray that looks back along its way does not see, and, straight from its
// lamp, what does not block that; it lights those all the same.
bool PhotonTracer::blocks(const Path& path, const Surface& hit, const PhotonStart& start) const {
  if (!(scene_.instances[hit.instance].seen_by & ray_bit(kind_of_way(path, path.bounces))))
    return false;
  return path.bounces > 0 ||
         (start.casts_shadows && start.blockers & scene_.instances[hit.instance].group);
}

// A surface that stands before the point nearest to the centre of a lamp that faces its receivers.
// The nearer of them are lit from before the surface, and it shadows them; those further off are
// lit from behind it. Of a transparent surface either, by chance.
bool PhotonTracer::pass_before_lamp(Path& path, const Surface& hit, const Vec3& direction,
                                    const PhotonStart& start, Vec3& origin) const {
  Rgb weight{1, 1, 1};
  const float before = start.soft_nearest - path.travelled - hit.distance;
  if (blocks(path, hit, start) && before > 0) {
    const float limit = start.soft_miss2 / before;
    Rgb transparency{};
    if (scene_.may_be_transparent(hit)) {
      RayInfo ray;
      ray.kind = RayInfo::kShadow;
      ray.transparent_depth = path.passed;
      ray.time = path.time;
      transparency = scene_.lets_through(hit, direction, ray);
    }
    const bool either = average(transparency) > 0;
    if (either && path.random.next() < 0.5f) {
      path.soft_to = std::min(path.soft_to, limit);
      weight = transparency * 2;
    } else {
      path.soft_from = std::max(path.soft_from, limit);
      if (either) weight = {2, 2, 2};
    }
  }
  path.unshadowed |= !start.casts_shadows;
  return path.soft_from <= path.soft_to && go_straight_on(path, hit, weight, origin);
}

// The surface in which one lies that the path passes unseen, if rays that see along its way meet
// that: going on from there would miss it.
std::optional<Surface> PhotonTracer::seen_twin(const Path& path, const Surface& hit,
                                               const Vec3& direction) const {
  const RayMask kinds = ray_bit(kind_of_way(path, path.bounces));
  if (scene_.instances[hit.instance].seen_by & kinds || hit.on_strand()) return {};
  const float far =
      2 * ray_epsilon(hit.position, hit.distance) / std::max(-dot(direction, hit.ng), kGrazing);
  Surface twin;
  if (!scene_.intersect(leave(hit, hit.ng), direction, 0, far, false, twin, kinds, path.time))
    return {};
  twin.distance = hit.distance;
  return twin;
}

// The next surface in which one lies that the path passes.
std::optional<Surface> PhotonTracer::layer(const Path& path, const Surface& hit, const Vec3& origin,
                                           const Vec3& direction) const {
  if (!scene_.instances[hit.instance].layered) return {};
  Surface next = hit;
  if (!scene_.meets_layer(next, origin, direction, ray_bit(kind_of_way(path, path.bounces)),
                          path.time))
    return {};
  return next;
}

// Sends a path on that a surface lets pass with this weight (its transparency over the chance to
// pass); false where it ends.
bool PhotonTracer::go_straight_on(Path& path, const Surface& hit, const Rgb& weight,
                                  Vec3& origin) const {
  path.power *= weight * std::exchange(path.painted, Rgb{1, 1, 1});
  const float survival = std::min(1.0f, max_abs(path.power) / path.reference);
  if (++path.passed > kMaxTransparent || !(survival > 0) || path.random.next() >= survival)
    return false;
  path.power *= 1 / survival;
  path.travelled += hit.distance;
  if (scene_.media()) scene_.media()->cross(path.media, hit, gap_beside(hit, -hit.ng), path.time);
  origin = leave(hit, -hit.ng);
  return true;
}

}  // namespace photon_splat
