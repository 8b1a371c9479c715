// The hash functions behind Blender's procedural textures: lookup3 on the bits of floats or
// integers, and PCG on integers (Jarzynski & Olano 2020, "Hash functions for GPU rendering").
#pragma once

#include <bit>
#include <cstdint>

#include "math/vec.h"
#include "textures/lookup3.h"

namespace photon_splat::nodes {

// In [0, 1], of the bits of the floats.
template <class... Floats>
float random_of(Floats... k) {
  return static_cast<float>(lookup3(std::bit_cast<uint32_t>(static_cast<float>(k))...)) *
         (1.0f / 4294967295.0f);
}

inline Vec3 random_color(float x) { return {random_of(x), random_of(x, 1.0f), random_of(x, 2.0f)}; }
inline Vec3 random_color(float x, float y) {
  return {random_of(x, y), random_of(x, y, 1.0f), random_of(x, y, 2.0f)};
}
inline Vec3 random_color(float x, float y, float z) {
  return {random_of(x, y, z), random_of(x, y, z, 1.0f), random_of(x, y, z, 2.0f)};
}
inline Vec3 random_color(float x, float y, float z, float w) {
  return {random_of(x, y, z, w), random_of(z, x, w, y), random_of(w, z, y, x)};
}

}  // namespace photon_splat::nodes
