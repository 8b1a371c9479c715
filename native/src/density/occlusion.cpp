#include "density/occlusion.h"

#include <bit>

#include "density/cover.h"
#include "density/enclosure.h"
#include "density/kernel_mass.h"
#include "math/sampling.h"
#include "scene/patch_outline.h"

namespace photon_splat {
namespace {

constexpr int kScouts = 6;       // directions looked along first
constexpr int kDirections = 24;  // in all, where a scout met something
constexpr int kProbes = 3;       // looked at beyond it, per direction
constexpr float kHeight =
    0.03f;  // of the rays over the surface, in h: what is lower is no obstacle
// The mass divides: few probes would make it too small on average
constexpr int kCoverScouts = 16, kCoverProbes = 80;
// In h: beyond, the kernel is nothing, and probes would lie in the blocker itself
constexpr float kRim = 0.98f;
constexpr int kMuchLight = kCoverProbes / 10;  // probes that light comes to
constexpr float kUnderWall = 0.2f;             // in h: of discs in the gap below a wall that hovers
// Away from walls: from one, from another that stands across the first, and once more
constexpr int kSteps = 3;
constexpr float kPastRim = 1.05f;  // of a disc's radius: so far from its middle a wall is to be
constexpr float kFurthest = 3;     // of it: so far a disc may be moved

// The part of a kernel (Epanechnikov) within the share s of its radius.
float mass_within(float s) {
  const float s2 = std::min(1.0f, s * s);
  return s2 * (2 - s2);
}

// The parts of the two kernels where the patch is covered. Under a cover itself nothing is left
// out; under a wall that hovers light ends a few gaps from where it comes in, and so does the disc;
// under what shines it does where that ends, and below a cover that lets much light in, too: what
// is thrown to and fro there is another light than that of open places.
void add_covered(const Scene& scene, RayMask kinds, PatchOutline& outline, const Vec3& x,
                 const Basis& basis, float h, uint32_t seed, DiscOcclusion& out) {
  const Vec3& normal = basis.normal;
  Random random(seed, 0xc07e);
  const float turn = 2 * kPi * random.next();
  if (const auto cover = cover_of(scene, kinds, x, normal, h)) {
    if (cover->parts()) out.clear = kUnderWall * h;
    return;
  }
  const float far = length_of_look(x, h);
  if (!(far > 0)) return;
  bool any = false;
  int lit = 0;     // of those that are covered
  float edge = h;  // how close they are
  Vec3 way{};
  constexpr int kTogether = Scene::kPacket;
  static_assert(kCoverScouts % kTogether == 0 && kCoverProbes % kTogether == 0);
  for (int first = 0; first < kCoverProbes; first += kTogether) {
    if (first == kCoverScouts && !any) return;
    Vec3 offsets[kTogether], above[kTogether];
    float squares[kTogether];
    for (int i = 0; i < kTogether; ++i) {
      // Each stands for as much of the kernel. The scouts go all over it, and so does what follows.
      const int k = first + i;
      const int place = k < kCoverScouts ? k : k - kCoverScouts,
                of = k < kCoverScouts ? kCoverScouts : kCoverProbes - kCoverScouts;
      squares[i] = 1 - std::sqrt(1 - (static_cast<float>(place) + 0.5f) / static_cast<float>(of));
      const float s = std::sqrt(squares[i]), angle = turn + kGoldenAngle * static_cast<float>(k);
      offsets[i] = Vec3{std::cos(angle), std::sin(angle), 0} * (h * s);
      above[i] = x + basis.to_world(offsets[i]) + normal * (kCover * h);
    }
    for (unsigned met = scene.occluded_packet(above, kTogether, -normal, far, kinds); met;
         met &= met - 1) {
      const int i = std::countr_zero(met);
      const Vec3 y = x + basis.to_world(offsets[i]);
      const auto cover = cover_of(scene, kinds, y, normal, h);
      if (!cover || !outline.holds(offsets[i].x, offsets[i].y)) continue;
      any = true;
      // Through the gap below a wall light of a far brighter place may come, and there is such
      // light below what shines
      const float distance = h * std::sqrt(squares[i]);
      if (cover->parts() && distance < out.clear) {
        out.clear = distance;
        out.wall = basis.to_world(offsets[i] / distance);
      }
      if (cover->shines) continue;
      const FromRim light = light_from_rim(scene, kinds, y, normal, h, random);
      if (light != FromRim::kNone) {
        ++lit;
        if (distance < edge) {
          edge = distance;
          way = basis.to_world(offsets[i] / distance);
        }
      }
      if (light == FromRim::kStraight) continue;
      out.hidden += 1.0f / kCoverProbes;
      const float s2 = squares[i], n2 = sqr(kNarrow);
      if (s2 < n2) out.narrow_hidden += (1 - s2 / n2) / (n2 * (1 - s2)) / kCoverProbes;
    }
  }
  if (lit > kMuchLight && edge < out.clear) {
    out.clear = edge;
    out.wall = way;
  }
}

// Places on the patch beyond what rays from x have met, each for a part of the kernels; as many
// together as a packet has rays.
class Probes {
 public:
  Probes(const Scene& scene, RayMask kinds, PatchOutline& outline, uint32_t key, const Vec3& x,
         const Basis& basis, float h, uint32_t seed, DiscOcclusion& out)
      : scene_(scene),
        kinds_(kinds),
        outline_(outline),
        x_(x),
        basis_(basis),
        h_(h),
        far_(length_of_look(x, h)),
        enclosures_(scene, kinds, key, basis, kHeight * h, seed),
        out_(out) {}

  // From `inner` to `outer` (in h) along `way` (in the basis), on which something has been met
  // `distance` away.
  void add(const Vec3& way, float inner, float outer, float distance) {
    const Vec3 offset = way * (h_ * 0.5f * (inner + outer));
    if (!outline_.holds(offset.x, offset.y)) return;
    places_[count_] = x_ + basis_.to_world(offset);
    parts_[count_] = {inner, outer, distance, way};
    if (++count_ == Scene::kPacket) look();
  }

  // At those that still wait.
  void look() {
    if (!count_) return;
    unsigned open = (1u << count_) - 1;
    if (far_ > 0) {  // what is covered has been counted already
      Vec3 above[Scene::kPacket];
      for (uint32_t i = 0; i < count_; ++i) above[i] = places_[i] + basis_.normal * (kCover * h_);
      for (unsigned met = scene_.occluded_packet(above, count_, -basis_.normal, far_, kinds_); met;
           met &= met - 1)
        if (const int i = std::countr_zero(met);
            cover_of(scene_, kinds_, places_[i], basis_.normal, h_))
          open &= ~(1u << i);
    }
    const unsigned held = enclosures_.hold(places_, count_, open);
    for (; open; open &= open - 1) {
      const int i = std::countr_zero(open);
      const Part& part = parts_[i];
      if (held >> i & 1) {
        out_.hidden += (mass_within(part.outer) - mass_within(part.inner)) / kDirections;
        out_.narrow_hidden +=
            (mass_within(part.outer / kNarrow) - mass_within(part.inner / kNarrow)) / kDirections;
      } else if (part.distance < out_.clear) {
        out_.clear = part.distance;
        out_.wall = basis_.to_world(part.way);
      }
    }
    count_ = 0;
  }

 private:
  struct Part {
    float inner, outer, distance;
    Vec3 way;
  };
  const Scene& scene_;
  RayMask kinds_;
  PatchOutline& outline_;
  const Vec3& x_;
  const Basis& basis_;
  float h_, far_;
  Enclosures enclosures_;
  DiscOcclusion& out_;
  Vec3 places_[Scene::kPacket];
  Part parts_[Scene::kPacket];
  uint32_t count_ = 0;
};

}  // namespace

DiscOcclusion disc_occlusion(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                             const Vec3& x, const Vec3& normal, float h, uint32_t seed) {
  DiscOcclusion out{0, 0, h};
  const Topology& topology = scene.meshes[scene.instances[instance].mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  // Rays along the tangent plane tell little of a bent surface
  if (!topology.planar[patch]) return out;
  const RayMask kinds = scene.keeping_off(instance);
  const Basis basis(normal);
  const float turn = to_unit_float(hash32(seed));
  const Vec3 origin = x + normal * std::max(kHeight * h, ray_epsilon(x, h));
  const auto way_of = [&](int i) {
    const float angle = 2 * kPi * (static_cast<float>(i) + turn) / kDirections;
    return Vec3{std::cos(angle), std::sin(angle), 0};
  };
  const auto met = [&](int i, float& distance) {
    Surface hit;
    if (!scene.intersect(origin, basis.to_world(way_of(i)), 0, h, false, hit, kinds) ||
        hit.key == key)
      return false;
    distance = hit.distance;
    return true;
  };
  float distance[kDirections];
  bool blocked[kDirections] = {}, any = false;
  PatchOutline outline(scene, instance, patch, x, basis, h);
  add_covered(scene, kinds, outline, x, basis, h, seed, out);
  for (int i = 0; i < kDirections; i += kDirections / kScouts)
    any |= blocked[i] = met(i, distance[i]);
  if (!any) return out;
  for (int i = 0; i < kDirections; ++i)
    if (i % (kDirections / kScouts)) blocked[i] = met(i, distance[i]);
  Probes probes(scene, kinds, outline, key, x, basis, h, seed, out);
  for (int i = 0; i < kDirections; ++i) {
    if (!blocked[i]) continue;
    const float first = distance[i] / h;
    if (first > kRim) continue;
    for (int k = 0; k < kProbes; ++k)
      probes.add(way_of(i), first + (1 - first) * static_cast<float>(k) / kProbes,
                 first + (1 - first) * static_cast<float>(k + 1) / kProbes, distance[i]);
  }
  probes.look();
  return out;
}

bool wall_between(const Scene& scene, uint32_t instance, const Vec3& a, const Vec3& b,
                  const Vec3& normal, float h) {
  const Vec3 from = a + normal * std::max(kHeight * h, ray_epsilon(a, h)), way = b - a;
  const float distance = length(way);
  return distance > 0 &&
         scene.occluded(from, way / distance, 0, distance, scene.keeping_off(instance));
}

bool step_clear_of_walls(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key,
                         Vec3& x, const Vec3& normal, float r, uint32_t seed, DiscOcclusion& near) {
  const uint32_t patch = scene.meshes[scene.instances[instance].mesh].topology.patch[triangle];
  const Basis basis(normal);
  Vec3 y = x;
  DiscOcclusion there = near;
  for (int step = 0; step < kSteps; ++step) {
    y = y - there.wall * (kPastRim * r - there.clear);
    PatchOutline outline(scene, instance, patch, x, basis, kFurthest * r);
    const float a = dot(y - x, basis.tangent), b = dot(y - x, basis.bitangent);
    if (length2(y - x) > sqr(kFurthest * r) || !outline.holds(a, b) ||
        wall_between(scene, instance, x, y, normal, r))
      return false;
    there = disc_occlusion(scene, instance, triangle, key, y, normal, r, hash_combine(seed, step));
    if (there.clear < r) continue;
    x = y;
    near = there;
    return true;
  }
  return false;
}

}  // namespace photon_splat
