// Irradiance on the normals of bumps, from light that is known by the ways it comes. n is the
// smooth normal of a surface and n + d that of a bump. Photons come from the unit directions w and
// bring phi to n; then
//   E(n) = sum of phi,  U = sum of phi w / (w . n),  E(n + d) = E(n) + d . U
// is linear in d and shared by all bumps around. It counts light from below a bump's own horizon as
// negative, and none fully that grazes: max(w . n, kLeastCosine) bounds what one photon may add.
#pragma once

#include "math/vec.h"

namespace photon_splat {

inline constexpr float kLeastCosine = 0.05f;

// A photon tells the normal m of the surface proper, not n. w is turned to what has the same part
// along the surface over its cosine with m as w has over that with n: U is then as smooth as n is.
inline Vec3 way_for_smooth(const Vec3& way, const Vec3& m, const Vec3& n) {
  const Vec3 over = way * (1 / std::max(dot(way, n), 1e-3f));
  return normalize(over + m * (1 - dot(over, m)));
}

// What U is the sum of, but for phi, of such a way.
inline Vec3 way_over_cosine(const Vec3& way, const Vec3& m) {
  return way * (1 / std::max(dot(way, m), kLeastCosine));
}

// An offset d of a normal, of components between -1 and 1, in steps of 1/511. 0: none.
inline uint32_t encode_offset(const Vec3& d) {
  const auto step = [](float x) {
    return static_cast<uint32_t>(
        static_cast<int32_t>(std::lround(std::clamp(x, -1.0f, 1.0f) * 511.0f)) & 0x3ff);
  };
  return step(d.x) | step(d.y) << 10 | step(d.z) << 20;
}

inline Vec3 decode_offset(uint32_t code) {
  const auto value = [code](int shift) {
    const int32_t bits = static_cast<int32_t>(code << (22 - shift)) >> 22;
    return static_cast<float>(bits) / 511.0f;
  };
  return {value(0), value(10), value(20)};
}

}  // namespace photon_splat
