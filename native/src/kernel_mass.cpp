#include "kernel_mass.h"

#include "point_block.h"

namespace photon_splat {
namespace {

constexpr uint32_t kFewEdges = 48;         // planar patches up to here are summed whole, without cancellation
constexpr float kGentle = 0.3f;               // h times curvature up to which the ball's mass is good to 0.3 %
constexpr float kRadiusOverCurvature = 0.7f;
constexpr uint32_t kMostTriangles = Topology::kManyTriangles;  // summed one by one
constexpr double kSmall2 = 0.04;  // squared edges of small triangles, in squared radii
constexpr float kFewestSamples = 100;         // of a patch that a flat disc would hold, from which its mass is estimated

struct EdgeInPlane {
  double distance;     // from x to the edge's line, positive when x is on the patch's side; in units of h
  double begin, end;   // along the line from x's foot point, counter-clockwise
};

// Masses of the kernels of radius h and kNarrow * h.
struct Masses {
  double wide = 0, narrow = 0;
};

// The edge in units of `scale` of the old unit.
EdgeInPlane rescaled(const EdgeInPlane& e, double scale) { return {e.distance / scale, e.begin / scale, e.end / scale}; }

// Projects an edge to the tangent plane; `front` is the normal about which the edge runs counter-clockwise.
bool project(const Vec3& x, const Vec3& front, float h, const Vec3& a, const Vec3& b, EdgeInPlane& out) {
  const Vec3 along = (b - a) - front * dot(b - a, front);
  const double len = length(along);
  if (!(len > 0)) return false;
  const Vec3 t = along / static_cast<float>(len), inward = cross(front, t);
  const Vec3 from = x - a;
  out.distance = double(dot(inward, from)) / h;
  out.begin = -double(dot(t, from)) / h;
  out.end = out.begin + len / h;
  return true;
}

// Angle and kernel integral of the triangle (x, begin, end), signed by the side of the edge on which x lies.
double triangle_mass(const EdgeInPlane& e) {
  const double d = e.distance;
  if (d == 0) return 0;
  const auto angle = [d](double from, double to) {  // between two points of the edge
    return from == to ? 0.0 : std::atan2((to - from) * std::abs(d), d * d + from * to);
  };
  const double half = std::sqrt(std::max(0.0, 1 - d * d));  // where the line leaves the unit disc
  const double t0 = std::clamp(e.begin, -half, half), t1 = std::clamp(e.end, -half, half);
  // Seen beyond the disc: of a line that misses it all, in two parts, each less than pi.
  double mass = (angle(e.begin, t0) + angle(t1, e.end)) / (2 * M_PI);
  // Inside: integral of (1/pi)(1 - s^2/2) |d| dt with s^2 = d^2 + t^2.
  mass += std::abs(d) / M_PI * ((1 - d * d / 2) * (t1 - t0) - (t1 * t1 * t1 - t0 * t0 * t0) / 6);
  return d > 0 ? mass : -mass;
}

// The kernel's mass beyond an edge: what the edge takes from 1.
double mass_beyond(const EdgeInPlane& e) {
  const double d = e.distance;
  if (std::abs(d) >= 1) return 0;
  const double half = std::sqrt(1 - d * d);
  const double t0 = std::max(e.begin, -half), t1 = std::min(e.end, half);
  if (t0 >= t1) return 0;
  const auto primitive = [d](double t) {  // of (1 - s^2)^2 |d| / s^2
    const double a = std::abs(d);
    return std::atan2(t, a) - 2 * a * t + a * (d * d * t + t * t * t / 3);
  };
  const double mass = (primitive(t1) - primitive(t0)) / (2 * M_PI);
  return d >= 0 ? mass : -mass;
}

// Sums the triangles that a point query finds.
struct TriangleSum {
  const Scene& scene;
  uint32_t instance, patch;
  Vec3 x, normal;
  float h;
  float side = 1;  // -1: x is on the triangles' back
  Masses mass{};
  uint32_t visited = 0;

  void add(uint32_t triangle) {
    const Instance& placed = scene.instances[instance];
    const Mesh& mesh = scene.meshes[placed.mesh];
    if (mesh.topology.patch[triangle] != patch) return;
    ++visited;
    Vec3 corner[3];
    for (int i = 0; i < 3; ++i) corner[i] = placed.to_world.point(mesh.positions[mesh.triangles[triangle][i]]);
    if (placed.mirrored) std::swap(corner[1], corner[2]);
    const Vec3 n = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const float len = length(n);
    if (!(len > 0)) return;
    const Vec3 front = n / len;
    // A patch has one side towards the viewer; `normal` is on it, so that the triangles' fronts all agree or all disagree.
    const float weight = std::clamp(kNormalWeightSlope * side * dot(front, normal), 0.0f, 1.0f);
    const float height = dot(x - corner[0], front), relative = height / h;
    if (weight <= 0) return;
    // Wholly within a ball the kernel is a polynomial: the mean of d^2 over a triangle is (sum of the corners' + |sum of corners|^2)/12.
    double squares[3], most = 0, sum_of_squares = 0;
    for (int i = 0; i < 3; ++i) {
      squares[i] = length2(corner[i] - x);
      most = std::max(most, squares[i]);
      sum_of_squares += squares[i];
    }
    const double h2 = double(h) * h, narrow2 = h2 * kNarrow * kNarrow;
    const double mean = (sum_of_squares + length2(corner[0] + corner[1] + corner[2] - x * 3.0f)) / 12;
    const double area = 0.5 * len;
    const bool wide_done = most <= h2, narrow_done = most <= narrow2;
    if (wide_done) mass.wide += weight * area * 2 / (M_PI * h2) * (1 - mean / h2);
    if (narrow_done) mass.narrow += weight * area * 2 / (M_PI * narrow2) * (1 - mean / narrow2);
    if (wide_done && narrow_done) return;
    if (std::max({length2(corner[1] - corner[0]), length2(corner[2] - corner[1]), length2(corner[0] - corner[2])}) < kSmall2 * h2) {
      // Small ones on the rim, where the kernel fades to 0: seven points (corners 1/20, middles of edges 2/15, centre 9/20).
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
    const double cut2 = 1 - relative * relative, narrow_cut2 = cut2 - (1 - double(kNarrow) * kNarrow);
    if (cut2 <= 0) return;
    const Vec3 foot = x - front * height;
    EdgeInPlane e;
    Masses share;
    for (int i = 0; i < 3; ++i) {
      if (!project(foot, front, h, corner[i], corner[(i + 1) % 3], e)) continue;
      if (!wide_done) share.wide += triangle_mass(rescaled(e, std::sqrt(cut2)));
      if (!narrow_done && narrow_cut2 > 0) share.narrow += triangle_mass(rescaled(e, std::sqrt(narrow_cut2)));
    }
    mass.wide += weight * cut2 * cut2 * share.wide;  // the kernel on that plane is cut2^2 times one of the smaller radius
    if (!narrow_done && narrow_cut2 > 0) mass.narrow += weight * std::pow(narrow_cut2 / (double(kNarrow) * kNarrow), 2) * share.narrow;
  }
};

bool add_triangle(RTCPointQueryFunctionArguments* arguments) {
  TriangleSum& sum = *static_cast<TriangleSum*>(arguments->userPtr);
  const bool instanced = arguments->context->instStackSize > 0;
  const uint32_t instance = instanced ? arguments->context->instID[0] : arguments->geomID;
  if (instance == sum.instance) sum.add(arguments->primID);
  if (sum.visited <= kMostTriangles) return false;
  arguments->query->radius = 0;  // enough: the answer is not wanted any more
  return true;
}

// By triangles; negative numbers where they are too many.
Masses sum_triangles(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x, const Vec3& normal, float h) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  TriangleSum sum{scene, instance, mesh.topology.patch[triangle], x, normal, h};
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 a = placed.to_world.point(mesh.positions[t[0]]);
  const Vec3 own = cross(placed.to_world.point(mesh.positions[t[1]]) - a, placed.to_world.point(mesh.positions[t[2]]) - a);
  sum.side = (dot(own, normal) >= 0) != placed.mirrored ? 1.0f : -1.0f;
  RTCPointQuery query{x.x, x.y, x.z, 0, h};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene.embree(), &query, &context, add_triangle, &sum);
  return sum.visited <= kMostTriangles ? sum.mass : Masses{-1, -1};
}

// By points spread over the patch; negative numbers where they lie too far apart for the disc. (How many are
// in it must not decide: the mass would be taken where it came out large.)
Masses sum_samples(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x, const Vec3& normal, float h) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  const Topology& topology = mesh.topology;
  const uint32_t patch = topology.patch[triangle];
  const Triangle& t = mesh.triangles[triangle];
  const Vec3 a = mesh.positions[t[0]];
  const Vec3 own = placed.to_local.transposed_vector(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
  const float side = dot(own, normal) >= 0 ? 1.0f : -1.0f;
  const float volume = placed.shared ? static_cast<float>(std::abs(determinant(placed.to_world))) : 1.0f;
  const float inverse_h2 = 1 / (h * h);
  const uint32_t first = topology.first_sample[patch], end = topology.first_sample[patch + 1];
  const float growth = placed.shared ? volume * length(own) / length(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) : 1.0f;
  if (first == end || kPi * h * h < kFewestSamples * topology.samples[first].area * growth) return {-1, -1};
  Masses sum;
  for (uint32_t i = first; i < end; ++i) {
    const PatchSample& sample = topology.samples[i];
    const Vec3 y = placed.shared ? placed.to_world.point(sample.position) : sample.position;
    const float relative = length2(y - x) * inverse_h2, kernel = 1 - relative;
    if (kernel <= 0) continue;
    // An area element grows by |det M| |M^-T n|; dividing the dot product by that length makes its direction unit.
    const Vec3 n = placed.shared ? placed.to_local.transposed_vector(sample.normal) : sample.normal;
    const float stretch = length(n);
    const float weight = std::clamp(kNormalWeightSlope * side * dot(n, normal) / stretch, 0.0f, 1.0f);
    if (weight <= 0) continue;
    const float area = weight * sample.area * stretch * volume;
    sum.wide += kernel * area;
    sum.narrow += std::max(0.0f, 1 - relative / (kNarrow * kNarrow)) * area;
  }
  const double scale = 2 / M_PI * inverse_h2;
  return {sum.wide * scale, sum.narrow * scale / (double(kNarrow) * kNarrow)};
}

KernelMass positive(const Masses& mass, bool exact) {
  return {std::max(static_cast<float>(mass.wide), kSmallestMass), exact, std::max(static_cast<float>(mass.narrow), kSmallestMass)};
}

}  // namespace

float curvature_radius_limit(const Scene& scene, uint32_t instance, uint32_t triangle) {
  const Instance& placed = scene.instances[instance];
  const float curvature = scene.meshes[placed.mesh].topology.curvature_of(triangle);
  return curvature > 0 ? kRadiusOverCurvature * placed.scale / curvature : INFINITY;
}

float patch_width(const Scene& scene, uint32_t instance, uint32_t triangle) {
  const Instance& placed = scene.instances[instance];
  const Topology& topology = scene.meshes[placed.mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  return topology.patch_rim[patch] > 0 ? 2 * topology.patch_area[patch] / topology.patch_rim[patch] * placed.scale : INFINITY;
}

KernelMass kernel_mass(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x, const Vec3& normal, float h) {
  const Instance& placed = scene.instances[instance];
  const Mesh& mesh = scene.meshes[placed.mesh];
  const Topology& topology = mesh.topology;
  const uint32_t patch = topology.patch[triangle];
  const uint32_t first = topology.first_edge[patch], count = topology.first_edge[patch + 1] - first;
  const bool planar = topology.planar[patch] != 0;
  if (!planar && h * topology.patch_curvature[patch] > kGentle * placed.scale) {
    Masses mass = sum_triangles(scene, instance, triangle, x, normal, h);
    if (mass.wide < 0) mass = sum_samples(scene, instance, triangle, x, normal, h);
    if (mass.wide >= 0) return positive(mass, true);
    return {0, false, 0};  // too bent for the ball's mass, too fine to sum: the disc must be smaller
  }
  if (!count) return {1, planar, 1};

  // The side about which edges run counter-clockwise in world space.
  const auto world_front = [&](const BoundaryEdge& edge) {
    const Vec3 n = placed.shared ? placed.to_local.transposed_vector(edge.normal) : edge.normal;
    const Vec3 front = dot(n, normal) >= 0 ? normal : -normal;
    return placed.mirrored ? -front : front;
  };
  const auto world = [&](const Vec3& p) { return placed.shared ? placed.to_world.point(p) : p; };

  Masses mass;
  EdgeInPlane e;
  if (planar && count <= kFewEdges) {
    EdgeInPlane edges[kFewEdges];
    uint32_t used = 0;
    bool cut = false;
    for (uint32_t i = first; i < first + count; ++i) {
      const BoundaryEdge& edge = topology.edges[i];
      if (!project(x, world_front(edge), h, world(edge.a), world(edge.b), e)) continue;
      edges[used++] = e;
      const double half2 = 1 - e.distance * e.distance;  // does it come within the disc?
      cut |= half2 > 0 && (e.begin < 0 || e.begin * e.begin < half2) && (e.end > 0 || e.end * e.end < half2);
    }
    if (!cut) return {1, true, 1};
    for (uint32_t i = 0; i < used; ++i) {
      mass.wide += triangle_mass(edges[i]);
      mass.narrow += triangle_mass(rescaled(edges[i], kNarrow));
    }
  } else {
    mass = {1, 1};
    const Vec3 local = placed.shared ? placed.to_local.point(x) : x;
    const float stretch = placed.shared ? std::max({length(placed.to_local.column(0)), length(placed.to_local.column(1)),
                                                    length(placed.to_local.column(2))}) : 1.0f;
    mesh.edge_tree->near(local, h * stretch, patch, [&](const BoundaryEdge& edge) {
      if (!project(x, world_front(edge), h, world(edge.a), world(edge.b), e)) return;
      mass.wide -= mass_beyond(e);
      mass.narrow -= mass_beyond(rescaled(e, kNarrow));
    });
  }
  return positive(mass, planar);
}

}  // namespace photon_splat
