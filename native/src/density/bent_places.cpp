#include "density/bent_places.h"

#include "density/bent_mass.h"
#include "density/point_block.h"

namespace photon_splat {
namespace {

constexpr float kSmall = 0.28f;  // radius of small branches, in h
constexpr float kWide = 1;       // and of leaves whose triangles stand for themselves

float stretch_of(const Instance& placed, const Vec3& normal, float volume) {
  const float size = length(normal);
  return size > 0 ? volume * length(placed.to_local.transposed_vector(normal)) / size : volume;
}

float distance_to_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const float square = length2(along);
  return length(x - a - along * (square > 0 ? saturate(dot(x - a, along) / square) : 0));
}

// n: of any length, normal to the plane of the corners.
bool holds(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& n) {
  return dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
         dot(cross(a - c, p - c), n) >= 0;
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
        if (radius > (node.is_leaf() ? kWide : kSmall) * h) return true;
        const float stretch = placed_.shared ? stretch_of(placed_, node.normal(), volume) : 1.0f;
        const float most = 1 - sqr(near) * inverse_h2_;
        total_ += node.area * stretch * most;
        pieces_.push_back({&node, 0, 0, most, stretch, total_});
        return false;
      },
      [&](uint32_t t) { add_triangle(t, h); });
}

BentPlaces::Corners BentPlaces::corners_of(uint32_t triangle) const {
  const Triangle& v = mesh_.triangles[triangle];
  Corners k{mesh_.positions[v[0]], mesh_.positions[v[1]], mesh_.positions[v[2]]};
  if (placed_.shared)
    k = {placed_.to_world.point(k.a), placed_.to_world.point(k.b), placed_.to_world.point(k.c)};
  return k;
}

// Few places of a triangle that is much larger than the ball would lie in it.
void BentPlaces::add_triangle(uint32_t triangle, float h) {
  const auto [a, b, c] = corners_of(triangle);
  const Vec3 n = cross(b - a, c - a);
  const float area = 0.5f * length(n);
  if (!(area > 0)) return;
  const float off = dot(x_ - a, n) / (2 * area), cut2 = h * h - off * off;
  if (!(cut2 > 0)) return;
  if (!holds(x_, a, b, c, n) &&
      !(std::min({distance_to_segment(x_, a, b), distance_to_segment(x_, b, c),
                  distance_to_segment(x_, c, a)}) < h))
    return;
  const float of_plane = kPi * cut2, most = cut2 * inverse_h2_;
  total_ += std::min(area, of_plane) * most;
  pieces_.push_back({nullptr, triangle, of_plane < area ? std::sqrt(cut2) : 0, most, 1, total_});
}

bool BentPlaces::draw(Random& random, Place& place) const {
  const auto piece = std::upper_bound(pieces_.begin(), pieces_.end(), random.next() * total_,
                                      [](float at, const Piece& p) { return at < p.sum; });
  if (piece == pieces_.end()) return false;
  if (!(piece->cut > 0 ? place_in_cut(*piece, random, place) : place_on(*piece, random, place)))
    return false;
  place.distance2 = length2(place.position - x_) * inverse_h2_;
  const float kernel = std::max(1 - place.distance2, 0.0f) *
                       std::clamp(kNormalWeightSlope * dot(place.normal, normal_), 0.0f, 1.0f);
  return random.next() * piece->most < kernel;
}

bool BentPlaces::place_on(const Piece& piece, Random& random, Place& place) const {
  const auto area_of = [&](uint32_t t) {  // twice it, in the mesh
    const Triangle& v = mesh_.triangles[t];
    const Vec3 a = mesh_.positions[v[0]];
    return length(cross(mesh_.positions[v[1]] - a, mesh_.positions[v[2]] - a));
  };
  const uint32_t triangle =
      piece.node ? mesh_.surface_tree->pick(*piece.node, random.next(), area_of) : piece.triangle;
  const auto [a, b, c] = corners_of(triangle);
  const Vec3 n = cross(b - a, c - a);
  const float area = length(n), local_area = piece.node ? area_of(triangle) : area;
  const float s = std::sqrt(random.next()), t = random.next();
  if (!(area > 0 && local_area > 0)) return false;
  place.position = a * (1 - s) + b * (s * (1 - t)) + c * (s * t);
  place.normal = n * ((placed_.mirrored ? -side_ : side_) / area);
  place.weight = area / (local_area * piece.stretch);
  return true;
}

bool BentPlaces::place_in_cut(const Piece& piece, Random& random, Place& place) const {
  const auto [a, b, c] = corners_of(piece.triangle);
  const Vec3 n = cross(b - a, c - a), unit = normalize(n);
  const float r = piece.cut * std::sqrt(random.next()), angle = 2 * kPi * random.next();
  place.position = x_ - unit * dot(x_ - a, unit) +
                   Basis(unit).to_world({r * std::cos(angle), r * std::sin(angle), 0});
  place.normal = unit * (placed_.mirrored ? -side_ : side_);
  place.weight = 1;
  return holds(place.position, a, b, c, n);
}

}  // namespace photon_splat
