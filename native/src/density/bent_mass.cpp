#include "density/bent_mass.h"

#include <span>

#include "density/kernel_mass.h"
#include "density/point_block.h"

namespace photon_splat {
namespace {

constexpr double kNarrow2 = double(kNarrow) * kNarrow;
constexpr double kSmall2 = 0.04;  // squared edges of small triangles, in squared radii
constexpr float kSmall = 0.28f;   // radius of small branches, in h
constexpr float kTiny = 0.02f;    // of those that are taken whole whatever their normals
// No point of a triangle is further than this times its longest edge from the nearest corner.
constexpr double kAboutCorners = 0.57736;
constexpr float kClear = 1.00001f;  // times a squared distance: farther, whatever the rounding
constexpr float kEven = 0.97f;      // length of the mean normal of branches that are nearly flat

// A piece of surface, in world space, as a ball about x sees it.
struct Piece {
  float near, far;  // distances from x that it lies between, m
  double mean2;     // mean squared distance from x, m^2
  double variance;  // of half that squared distance, were the piece far away, m^4

  // Mean over the piece of max(0, 1 - d^2/r^2), given r and 1/r^2. On the rim as if 1 - d^2/r^2
  // were even between its mean +- sqrt(3) times its deviation.
  double kernel(float r, double inverse_r2) const {
    if (near >= r) return 0;
    const double k = 1 - mean2 * inverse_r2;
    if (far <= r) return k;
    const double reach = 2 * std::sqrt(3 * variance) * inverse_r2;
    if (k >= reach) return k;
    return k <= -reach ? 0 : (k + reach) * (k + reach) / (4 * reach);
  }
};

double sqr(double x) { return x * x; }

// What a convex outline holds of a disc's mass, its radius in units of h.
double mass_within(std::span<const EdgeInPlane> outline, double radius) {
  bool cut = false, inside = !outline.empty();
  for (const EdgeInPlane& edge : outline) {
    cut |= comes_within(edge, radius);
    inside &= edge.distance > 0;
  }
  if (!cut) return inside ? 1 : 0;
  double mass = 0;
  for (const EdgeInPlane& edge : outline) mass += triangle_mass(rescaled(edge, radius));
  return mass;
}

struct Sum {
  const Scene& scene;
  const Instance& placed;
  const Mesh& mesh;
  Vec3 x, normal;
  float h;
  float side = 1;     // -1: x is on the triangles' back
  double volume = 1;  // |det M| of the transform
  // Gram matrix of the transform: |to_world v|^2 = v.G v; xx, yy, zz, xy, xz, yz, the last three
  // doubled
  float gram[6] = {1, 1, 1, 0, 0, 0};
  double inverse_h2 = 1 / (double(h) * h), inverse_narrow2 = inverse_h2 / kNarrow2;
  Masses mass{};

  float weight_of(const Vec3& front) const {
    return std::clamp(kNormalWeightSlope * side * dot(front, normal), 0.0f, 1.0f);
  }

  // Whether its children must be looked at.
  bool enter(const SurfaceNode& node) {
    const Vec3 way = (placed.shared ? placed.to_world.point(node.centre) : node.centre) - x;
    const float radius = node.radius * placed.scale, distance2 = length2(way);
    // Most of them: without a root
    if (distance2 > kClear * (h + radius) * (h + radius)) return false;
    const float distance = std::sqrt(distance2);
    if (distance - radius >= h || node.area <= 0) return false;
    const float even = node.even();
    if (even < kEven && radius > kTiny * h) return true;
    const float near = distance - radius, far = distance + radius, narrow = kNarrow * h;
    const bool whole = far <= narrow || (far <= h && near >= narrow);
    if ((!whole && radius > kSmall * h) || even <= 0) return true;
    Vec3 front = node.normal() / even;
    Vec3 towards = way;
    double area = node.area;
    float spread = 0;     // in spread_unit()
    if (placed.shared) {  // an area element grows by |det M| |M^-T n|
      front = placed.to_local.transposed_vector(front);
      const float stretch = length(front);
      front = front / stretch;
      area *= stretch * volume;
      towards = placed.to_world.transposed_vector(way);
      for (int i = 0; i < 6; ++i) spread += gram[i] * node.spread[i];
    } else {
      spread = static_cast<float>(node.spread[0] + node.spread[1] + node.spread[2]);
    }
    const Piece piece{near, far, distance2 + double(spread) * node.spread_unit(),
                      node.variance_along(towards)};
    const double factor = weight_of(front) * area * (2 / M_PI);
    mass.wide += factor * inverse_h2 * piece.kernel(h, inverse_h2);
    if (near < narrow)
      mass.narrow += factor * inverse_narrow2 * piece.kernel(narrow, inverse_narrow2);
    return false;
  }

  void add(uint32_t triangle) {
    Vec3 corner[3];
    for (int i = 0; i < 3; ++i)
      corner[i] = placed.to_world.point(mesh.positions[mesh.triangles[triangle][i]]);
    if (placed.mirrored) std::swap(corner[1], corner[2]);
    double squares[3], least = INFINITY, most = 0, sum_of_squares = 0;
    float longest = 0;
    for (int i = 0; i < 3; ++i) {
      squares[i] = length2(corner[i] - x);
      least = std::min(least, squares[i]);
      most = std::max(most, squares[i]);
      sum_of_squares += squares[i];
      longest = std::max(longest, length2(corner[i] - corner[(i + 1) % 3]));
    }
    const double about_corners = kAboutCorners * std::sqrt(double(longest));
    if (least > sqr(h + about_corners)) return;
    const Vec3 n = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const float len = length(n);
    if (!(len > 0)) return;
    const Vec3 front = n / len;
    const float weight = weight_of(front);
    const float height = dot(x - corner[0], front), relative = height / h;
    if (weight <= 0) return;
    const double h2 = double(h) * h, narrow2 = h2 * kNarrow2;
    // Wholly within a ball the kernel is a polynomial: the mean of d^2 over a triangle is (sum of
    // the corners' + |sum of corners|^2)/12.
    const double mean =
        (sum_of_squares + length2(corner[0] + corner[1] + corner[2] - x * 3.0f)) / 12;
    const double area = 0.5 * len;
    const bool wide_done = most <= h2, narrow_done = most <= narrow2,
               narrow_apart = least > sqr(kNarrow * h + about_corners);
    if (wide_done) mass.wide += weight * area * 2 / (M_PI * h2) * (1 - mean / h2);
    if (narrow_done) mass.narrow += weight * area * 2 / (M_PI * narrow2) * (1 - mean / narrow2);
    if (wide_done && (narrow_done || narrow_apart)) return;
    if (longest < kSmall2 * h2) {
      // Small ones on the rim, where the kernel fades to 0: seven points (corners 1/20, middles of
      // edges 2/15, centre 9/20).
      double wide = 0, narrow = 0;
      const auto at = [&](double d2, double share) {
        wide += share * std::max(0.0, 1 - d2 / h2);
        narrow += share * std::max(0.0, 1 - d2 / narrow2);
      };
      for (int i = 0; i < 3; ++i) {
        at(squares[i], 1.0 / 20);
        at(length2((corner[i] + corner[(i + 1) % 3]) * 0.5f - x), 2.0 / 15);
      }
      at(length2((corner[0] + corner[1] + corner[2]) * (1.0f / 3) - x), 9.0 / 20);
      if (!wide_done) mass.wide += weight * area * 2 / (M_PI * h2) * wide;
      if (!narrow_done) mass.narrow += weight * area * 2 / (M_PI * narrow2) * narrow;
      return;
    }
    // Squared radii, in h, of the discs that the balls cut from the plane.
    const double cut2 = 1 - relative * relative, narrow_cut2 = cut2 - (1 - kNarrow2);
    if (cut2 <= 0) return;
    const Vec3 foot = x - front * height;
    EdgeInPlane edges[3];
    int count = 0;
    for (int i = 0; i < 3; ++i)
      count += project(foot, front, h, corner[i], corner[(i + 1) % 3], edges[count]);
    const std::span<const EdgeInPlane> outline(edges, count);
    // The kernel on that plane is cut2^2 times one of the smaller radius
    if (!wide_done) mass.wide += weight * cut2 * cut2 * mass_within(outline, std::sqrt(cut2));
    if (!narrow_done && !narrow_apart && narrow_cut2 > 0)
      mass.narrow +=
          weight * sqr(narrow_cut2 / kNarrow2) * mass_within(outline, std::sqrt(narrow_cut2));
  }
};

}  // namespace

float side_of_patch(const Instance& placed, const Mesh& mesh, uint32_t triangle,
                    const Vec3& normal) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 a = placed.to_world.point(mesh.positions[t[0]]);
  const Vec3 own = cross(placed.to_world.point(mesh.positions[t[1]]) - a,
                         placed.to_world.point(mesh.positions[t[2]]) - a);
  return (dot(own, normal) >= 0) != placed.mirrored ? 1.0f : -1.0f;
}

Masses bent_mass(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x,
                 const Vec3& normal, float h) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  Sum sum{scene, placed, mesh, x, normal, h, side_of_patch(placed, mesh, triangle, normal)};
  if (placed.shared) {
    const Vec3 c[3] = {placed.to_world.column(0), placed.to_world.column(1),
                       placed.to_world.column(2)};
    const float gram[6] = {dot(c[0], c[0]),     dot(c[1], c[1]),     dot(c[2], c[2]),
                           2 * dot(c[0], c[1]), 2 * dot(c[0], c[2]), 2 * dot(c[1], c[2])};
    std::copy(gram, gram + 6, sum.gram);
    sum.volume = std::abs(determinant(placed.to_world));
  }
  mesh.surface_tree->visit(
      mesh.topology.patch[triangle], [&](const SurfaceNode& node) { return sum.enter(node); },
      [&](uint32_t leaf) { sum.add(leaf); });
  return sum.mass;
}

}  // namespace photon_splat
