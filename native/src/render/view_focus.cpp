#include "render/view_focus.h"

#include <algorithm>
#include <tuple>

namespace photon_splat {
namespace {

constexpr size_t kLooks = 4096;  // places that tell what photons are to start about

// The middle of points, each coordinate's median, and the distance that half of them are within.
std::pair<Vec3, float> middle_of(const std::vector<Vec3>& points) {
  std::vector<float> values(points.size());
  const auto median = [&](auto&& value) {
    std::transform(points.begin(), points.end(), values.begin(), value);
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
  };
  const Vec3 middle{median([](const Vec3& p) { return p.x; }),
                    median([](const Vec3& p) { return p.y; }),
                    median([](const Vec3& p) { return p.z; })};
  return {middle, median([&](const Vec3& p) { return length(p - middle); })};
}

}  // namespace

void focus_on_geometry(const Scene& scene, Lights& lights) {
  size_t count = 0;
  for (const Instance& instance : scene.instances)
    count += scene.meshes[instance.mesh].triangles.size();
  if (!count) return;
  const size_t step = 1 + count / kLooks;
  std::vector<Vec3> points;
  size_t next = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (; next < mesh.triangles.size(); next += step) {
      const Triangle& t = mesh.triangles[next];
      points.push_back(instance.to_world.point(
          (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) * (1 / 3.0f)));
    }
    next -= mesh.triangles.size();
  }
  const auto [middle, reach] = middle_of(points);
  lights.focus(middle, reach);
}

std::optional<SeenPlaces> ViewFocus::look(const GatherPoints& gather_points, Lights& lights) {
  if (gather_points.empty()) return {};
  const size_t step = 1 + gather_points.size() / kLooks;
  std::vector<Vec3> points;
  for (size_t i = 0; i < gather_points.size(); i += step)
    points.push_back(gather_points[i].position);
  if (!found_) {
    std::tie(middle_, reach_) = middle_of(points);
    lights.focus(middle_, reach_);
    found_ = true;
  }
  if (!lights.focused()) return {};
  SeenPlaces places(middle_, reach_);
  for (const GatherPoint& r : gather_points) places.add(r.key, r.position);
  return places;
}

}  // namespace photon_splat
