#include "density/bent_places.h"

#include "density/bent_mass.h"
#include "density/point_block.h"

namespace photon_splat {
namespace {

constexpr float kSmall = 0.28f;  // radius of small branches, in h

float stretch_of(const Instance& placed, const Vec3& normal, float volume) {
  const float size = length(normal);
  return size > 0 ? volume * length(placed.to_local.transposed_vector(normal)) / size : volume;
}

}  // namespace

BentPlaces::BentPlaces(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x,
                       const Vec3& normal, float h)
    : placed_(scene.instances[instance]),
      mesh_(scene.meshes[placed_.mesh]),
      x_(x),
      normal_(normal),
      inverse_h2_(1 / (h * h)),
      side_(side_of_patch(placed_, mesh_, triangle, normal)) {
  const float volume = placed_.shared ? std::abs(determinant(placed_.to_world)) : 1.0f;
  mesh_.surface_tree->visit(
      mesh_.topology.patch[triangle],
      [&](const SurfaceNode& node) {
        const Vec3 centre = placed_.shared ? placed_.to_world.point(node.centre) : node.centre;
        const float radius = node.radius * placed_.scale,
                    near = std::max(length(centre - x) - radius, 0.0f);
        if (near >= h || !(node.area > 0)) return false;
        if (!node.is_leaf() && radius > kSmall * h) return true;
        const float stretch = placed_.shared ? stretch_of(placed_, node.normal(), volume) : 1.0f;
        const float most = 1 - sqr(near) * inverse_h2_;
        total_ += node.area * stretch * most;
        pieces_.push_back({&node, most, stretch, total_});
        return false;
      },
      [](uint32_t) {});
}

bool BentPlaces::draw(Random& random, Place& place) const {
  const auto piece = std::upper_bound(pieces_.begin(), pieces_.end(), random.next() * total_,
                                      [](float at, const Piece& p) { return at < p.sum; });
  if (piece == pieces_.end()) return false;
  const uint32_t triangle = mesh_.surface_tree->pick(*piece->node, random.next(), [&](uint32_t t) {
    const Triangle& v = mesh_.triangles[t];
    const Vec3 a = mesh_.positions[v[0]];
    return length(cross(mesh_.positions[v[1]] - a, mesh_.positions[v[2]] - a));
  });
  const Triangle& v = mesh_.triangles[triangle];
  const Vec3 corners[3] = {mesh_.positions[v[0]], mesh_.positions[v[1]], mesh_.positions[v[2]]};
  Vec3 a = corners[0], b = corners[1], c = corners[2];
  if (placed_.shared)
    a = placed_.to_world.point(a), b = placed_.to_world.point(b), c = placed_.to_world.point(c);
  const Vec3 n = cross(b - a, c - a),
             local = cross(corners[1] - corners[0], corners[2] - corners[0]);
  const float area = length(n), local_area = length(local);
  const float s = std::sqrt(random.next()), t = random.next();
  if (!(area > 0 && local_area > 0)) return false;
  place.position = a * (1 - s) + b * (s * (1 - t)) + c * (s * t);
  place.normal = n * ((placed_.mirrored ? -side_ : side_) / area);
  place.distance2 = length2(place.position - x_) * inverse_h2_;
  place.weight = area / (local_area * piece->stretch);
  const float kernel = std::max(1 - place.distance2, 0.0f) *
                       std::clamp(kNormalWeightSlope * dot(place.normal, normal_), 0.0f, 1.0f);
  return random.next() * piece->most < kernel;
}

}  // namespace photon_splat
