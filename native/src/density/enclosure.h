// What is dark because something closed stands over it.
#pragma once

#include <optional>

#include "math/sampling.h"
#include "scene/scene.h"

namespace photon_splat {

// Whether a surface that lets no light through gives any; nothing where it lets some through.
std::optional<bool> shines(const Scene& scene, const Surface& hit, const Vec3& wo);
// Whether it lets no light through and gives none.
inline bool is_dark(const Scene& scene, const Surface& hit, const Vec3& wo) {
  return shines(scene, hit, wo) == false;
}

// Tells points of a surface inside of closed things from those under a sheet, an awning or a flag,
// which shows its back as well: inside there are backs wherever one looks. Found out once for each
// surface that is over the points; one of these for each kernel disc.
class Enclosures {
 public:
  // `kinds`: Scene::keeping_off() the surface that the points are on. `key`: of that; they are
  // looked at from `height` over it.
  Enclosures(const Scene& scene, RayMask kinds, uint32_t key, const Basis& basis, float height,
             uint32_t seed)
      : scene_(scene),
        kinds_(kinds),
        key_(key),
        basis_(basis),
        height_(height),
        random_(seed, 0xe7c1) {}

  // Tests `count` <= Scene::kPacket points, those whose bits are set in `which`; returns the bits
  // of those that are inside.
  unsigned hold(const Vec3* points, uint32_t count, unsigned which);

 private:
  static constexpr int kKnown = 4;

  bool holds_under(const Surface& above, const Vec3& origin);
  bool backs_all_around(const Vec3& origin);

  const Scene& scene_;
  RayMask kinds_;
  uint32_t key_;
  const Basis& basis_;
  float height_;
  Random random_;
  int known_ = 0;
  uint32_t keys_[kKnown] = {};
  bool closed_[kKnown] = {};
};

}  // namespace photon_splat
