#include "scene/patch_outline.h"

#include <doctest/doctest.h>

#include "math/sampling.h"
#include "support/meshes.h"

using namespace photon_splat;

namespace {

constexpr float kCos = 0.8f, kSin = 0.6f;
constexpr Placement kTurned{2 * kCos, -2 * kSin, 0, 1, 2 * kSin, 2 * kCos, 0, -3, 0, 0, 2, 5};
constexpr Placement kMirrored{0, 0, 1, 7, -1.5, 0, 0, 0, 0, 3, 0, 0};

// A grid of n x n quads without some of them: holes, islands, and quads that only meet at a corner.
Mesh make_holed(int n) {
  Mesh mesh = make_grid(n);
  LargeArray<Triangle> kept;
  for (std::ptrdiff_t quad = 0; 2 * quad < std::ssize(mesh.triangles); ++quad)
    if (to_unit_float(hash32(static_cast<uint32_t>(quad))) < 0.6f)
      kept.insert(kept.end(), mesh.triangles.begin() + 2 * quad,
                  mesh.triangles.begin() + 2 * quad + 2);
  mesh.triangles = kept;
  return mesh;
}

}  // namespace

TEST_CASE("a place is on the patch if a ray from over it meets the patch there") {
  for (const int n : {2, 5, 30})  // few edges and many
    for (const auto& places : {std::vector<Placement>{identity}, {kTurned, kMirrored}}) {
      Scene scene(1);
      fill(scene, make_holed(n), places);
      Random random(static_cast<uint32_t>(n), 1);
      int on = 0, off = 0;
      while (on + off < 4000) {
        const uint32_t instance =
            random.next() < 0.5f ? 0 : static_cast<uint32_t>(places.size() - 1);
        const Instance& placed = scene.instances[instance];
        const auto head_on = [&](const Vec3& local, Surface& s) {
          const Vec3 over = placed.to_world.point(local + Vec3{0, 0, 0.05f});
          const Vec3 down = normalize(placed.to_world.vector({0, 0, -1}));
          return scene.intersect(over, down, 0, 1, false, s) && s.instance == instance;
        };
        Surface from, to;
        const Vec3 x{random.next(), random.next(), 0};
        if (!head_on(x, from)) continue;
        const uint32_t patch = scene.meshes[placed.mesh].topology.patch[from.triangle];
        const Basis basis(from.ng);
        const float reach = 0.3f * placed.scale;
        PatchOutline outline(scene, instance, patch, from.position, basis, reach);
        for (int i = 0; i < 4; ++i) {
          const float angle = 2 * kPi * random.next(), s = reach * std::sqrt(random.next());
          const Vec3 offset{s * std::cos(angle), s * std::sin(angle), 0};
          const Vec3 y = from.position + basis.to_world(offset);
          const Vec3 over = y + from.ng * (0.05f * placed.scale);
          const bool expected = scene.intersect(over, -from.ng, 0, placed.scale, false, to) &&
                                to.instance == instance &&
                                scene.meshes[placed.mesh].topology.patch[to.triangle] == patch;
          CHECK(outline.holds(offset.x, offset.y) == expected);
          ++(expected ? on : off);
        }
      }
      CHECK(on > 400);
      CHECK(off > 400);
    }
}

TEST_CASE("a patch without edges near the point holds all there is") {
  Scene scene(1);
  fill(scene, make_grid(3), {identity});
  const Vec3 x{0.5f, 0.5f, 0}, up{0, 0, 1};
  const Basis basis(up);
  PatchOutline outline(scene, 0, 0, x, basis, 0.2f);
  CHECK(outline.holds(0.19f, 0));
  PatchOutline wide(scene, 0, 0, x, basis, 0.8f);
  CHECK(wide.holds(0, 0.49f));
  CHECK_FALSE(wide.holds(0, 0.51f));
}
