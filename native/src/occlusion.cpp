#include "occlusion.h"

#include <bit>

#include "enclosure.h"
#include "kernel_mass.h"
#include "sampling.h"

namespace photon_splat {
namespace {

constexpr int kScouts = 6;    // directions looked along first
constexpr int kDirections = 24;  // in all, where a scout met something
constexpr int kProbes = 3;       // looked at beyond it, per direction
constexpr float kHeight = 0.03f; // of the rays over the surface, in h: what is lower is no obstacle
constexpr int kCoverScouts = 16, kCoverProbes = 80;  // the mass divides: few probes would make it too small on average
constexpr float kRim = 0.98f;    // in h: beyond, the kernel is nothing, and probes would lie in the blocker itself
constexpr float kCover = 0.12f;  // what lies closer over the surface than this, in h, keeps photons off it
constexpr float kTouching = 1e-3f;
constexpr float kGolden = 2.39996323f;

// The part of a kernel (Epanechnikov) within the share s of its radius.
float mass_within(float s) {
  const float s2 = std::min(1.0f, s * s);
  return s2 * (2 - s2);
}

struct PatchQuery {
  const Scene& scene;
  uint32_t instance, patch;
  Vec3 y, normal;
  float tolerance;
  bool found = false;
};

// Whether the patch comes within the tolerance of y.
bool look_for_patch(RTCPointQueryFunctionArguments* arguments) {
  PatchQuery& q = *static_cast<PatchQuery*>(arguments->userPtr);
  const bool instanced = arguments->context->instStackSize > 0;
  if ((instanced ? arguments->context->instID[0] : arguments->geomID) != q.instance) return false;
  const Instance& placed = q.scene.instances[q.instance];
  const Mesh& mesh = q.scene.meshes[placed.mesh];
  if (mesh.topology.patch[arguments->primID] != q.patch) return false;
  Vec3 corner[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = mesh.positions[mesh.triangles[arguments->primID][i]];
    corner[i] = placed.shared ? placed.to_world.point(p) : p;
  }
  // Does the normal through y pass the triangle, near y? Edges take half a tolerance more, so that no seam shows.
  const Vec3 n = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const float len = length(n);
  if (!(len > 0) || std::abs(dot(q.y - corner[0], n)) > q.tolerance * len) return false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 edge = corner[(i + 1) % 3] - corner[i];
    if (dot(cross(edge, q.y - corner[i]), n) < -1e-4f * q.tolerance * len * length(edge)) return false;
  }
  q.found = true;
  arguments->query->radius = 0;
  return true;
}

bool on_patch(const Scene& scene, uint32_t instance, uint32_t patch, const Vec3& y, const Vec3& normal, float tolerance) {
  PatchQuery q{scene, instance, patch, y, normal, tolerance};
  RTCPointQuery query{y.x, y.y, y.z, 0, tolerance};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene.embree(), &query, &context, look_for_patch, &q);
  return q.found;
}

// What lies close over a point is looked for from above it, down to just before the surface.
float length_of_look(const Vec3& y, float h) { return kCover * h - std::max(kTouching * h, ray_epsilon(y, h)); }

bool is_cover(const Scene& scene, const Vec3& y, const Vec3& normal, float h) {
  Surface hit;
  return scene.intersect(y + normal * (kCover * h), -normal, 0, length_of_look(y, h), false, hit) && is_dark(scene, hit, normal);
}

bool covered(const Scene& scene, const Vec3& y, const Vec3& normal, float h) {
  const float far = length_of_look(y, h);
  return far > 0 && scene.occluded(y + normal * (kCover * h), -normal, 0, far) && is_cover(scene, y, normal, h);
}

// Whether light comes in from the rim of the cover of y: by one direction, so that the mean tells how much.
bool lit_from_the_rim(const Scene& scene, const Vec3& y, const Basis& basis, float h, Random& random) {
  const Vec3 way = basis.to_world(sample_cosine_hemisphere(random.next2()));
  return !scene.occluded(y + basis.normal * ray_epsilon(y, h), way, 0, h);
}

// The parts of the two kernels where the patch is covered. Under a cover itself all is alike: nothing is left out.
void add_covered(const Scene& scene, uint32_t instance, uint32_t patch, const Vec3& x, const Vec3& normal, const Basis& basis, float h,
                 uint32_t seed, DiscOcclusion& out) {
  Random random(seed, 0xc07e);
  const float turn = 2 * kPi * random.next();
  if (covered(scene, x, normal, h)) return;
  const float far = length_of_look(x, h);
  if (!(far > 0)) return;
  bool any = false;
  constexpr int kTogether = Scene::kPacket;
  static_assert(kCoverScouts % kTogether == 0 && kCoverProbes % kTogether == 0);
  for (int first = 0; first < kCoverProbes; first += kTogether) {
    if (first == kCoverScouts && !any) return;
    Vec3 places[kTogether], above[kTogether];
    float squares[kTogether];
    for (int i = 0; i < kTogether; ++i) {
      // Each stands for as much of the kernel. The scouts go all over it, and so does what follows.
      const int k = first + i;
      const int place = k < kCoverScouts ? k : k - kCoverScouts, of = k < kCoverScouts ? kCoverScouts : kCoverProbes - kCoverScouts;
      squares[i] = 1 - std::sqrt(1 - (static_cast<float>(place) + 0.5f) / static_cast<float>(of));
      const float s = std::sqrt(squares[i]), angle = turn + kGolden * static_cast<float>(k);
      places[i] = x + basis.to_world({h * s * std::cos(angle), h * s * std::sin(angle), 0});
      above[i] = places[i] + normal * (kCover * h);
    }
    for (unsigned met = scene.occluded_packet(above, kTogether, -normal, far); met; met &= met - 1) {
      const int i = std::countr_zero(met);
      const Vec3& y = places[i];
      if (!is_cover(scene, y, normal, h) || !on_patch(scene, instance, patch, y, normal, 0.25f * kHeight * h)) continue;
      any = true;
      if (lit_from_the_rim(scene, y, basis, h, random)) continue;
      out.hidden += 1.0f / kCoverProbes;
      const float s2 = squares[i], n2 = sqr(kNarrow);
      if (s2 < n2) out.narrow_hidden += (1 - s2 / n2) / (n2 * (1 - s2)) / kCoverProbes;
    }
  }
}

}  // namespace

DiscOcclusion disc_occlusion(const Scene& scene, uint32_t instance, uint32_t triangle, uint32_t key, const Vec3& x,
                             const Vec3& normal, float h, uint32_t seed) {
  DiscOcclusion out{0, 0, h};
  const Topology& topology = scene.meshes[scene.instances[instance].mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  if (!topology.planar[patch]) return out;  // rays along the tangent plane tell little of a bent surface
  const Basis basis(normal);
  const float turn = to_unit_float(hash32(seed));
  const Vec3 origin = x + normal * std::max(kHeight * h, ray_epsilon(x, h));
  const auto direction_of = [&](int i) {
    const float angle = 2 * kPi * (static_cast<float>(i) + turn) / kDirections;
    return basis.to_world({std::cos(angle), std::sin(angle), 0});
  };
  const auto met = [&](int i, float& distance) {
    Surface hit;
    if (!scene.intersect(origin, direction_of(i), 0, h, false, hit) || hit.key == key) return false;
    distance = hit.distance;
    return true;
  };
  Enclosures enclosures(scene, key, basis, kHeight * h, seed);
  float distance[kDirections];
  bool blocked[kDirections] = {}, any = false;
  add_covered(scene, instance, patch, x, normal, basis, h, seed, out);
  for (int i = 0; i < kDirections; i += kDirections / kScouts) any |= blocked[i] = met(i, distance[i]);
  if (!any) return out;
  for (int i = 0; i < kDirections; ++i) {
    if (i % (kDirections / kScouts)) blocked[i] = met(i, distance[i]);
    if (!blocked[i]) continue;
    const float first = distance[i] / h;
    if (first > kRim) continue;
    for (int k = 0; k < kProbes; ++k) {
      const float inner = first + (1 - first) * static_cast<float>(k) / kProbes, outer = first + (1 - first) * static_cast<float>(k + 1) / kProbes;
      const Vec3 y = x + direction_of(i) * (h * 0.5f * (inner + outer));
      if (!on_patch(scene, instance, patch, y, normal, 0.25f * kHeight * h)) continue;
      if (covered(scene, y, normal, h)) continue;  // counted already
      if (enclosures.hold(y)) {
        out.hidden += (mass_within(outer) - mass_within(inner)) / kDirections;
        out.narrow_hidden += (mass_within(outer / kNarrow) - mass_within(inner / kNarrow)) / kDirections;
      } else {
        out.clear = std::min(out.clear, distance[i]);
      }
    }
  }
  return out;
}

}  // namespace photon_splat
