#include "density/splat_parts.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/vec.h"

namespace photon_splat {
namespace {

constexpr float kRounded = 1.000001f;  // no photon within a disc is outside its bounds
// Radians, far more than rounding: where a normal's weight is taken to be full it is
constexpr float kSafeAngle = 0.005f;

// Bit i: point i of a block, of the kPartSize from `first` on, catches something.
uint64_t used_places(const PointBlock& block, uint32_t first) {
  uint64_t used = 0;
  for (uint32_t i = first; i < first + kPartSize; ++i)
    used |= uint64_t{std::isfinite(block.inverse_h2[i])} << i;
  return used;
}

uint64_t places_with_key(const PointBlock& block, uint64_t of, uint32_t key) {
  uint64_t same = 0;
  for (uint32_t i = 0; i < kBlockSize; ++i) same |= (of & uint64_t{block.key[i] == key} << i);
  return same;
}

// The part of the points `places`.
SplatPart make_part(const PointBlock& block, uint32_t first, uint64_t places) {
  const auto normal = [&](uint32_t i) { return Vec3{block.nx[i], block.ny[i], block.nz[i]}; };
  Bounds bounds;
  Vec3 sum{};
  for (uint64_t left = places; left; left &= left - 1) {
    const auto i = static_cast<uint32_t>(std::countr_zero(left));
    const float h = kRounded / std::sqrt(block.inverse_h2[i]);
    const Vec3 x{block.x[i], block.y[i], block.z[i]};
    bounds.add(x - Vec3{h, h, h});
    bounds.add(x + Vec3{h, h, h});
    sum = sum + normal(i);
  }
  // Points whose normals are a from the axis at most: photons have the full weight whose normals
  // are 60 degrees - a from it.
  const float size = length(sum);
  const Vec3 axis = size > 0 ? sum / size : Vec3{};
  float least = 1;
  for (uint64_t left = places; left; left &= left - 1)
    least = std::min(least, dot(normal(static_cast<uint32_t>(std::countr_zero(left))), axis));
  const float wide =
      std::acos(1 / kNormalWeightSlope) - std::acos(std::clamp(least, -1.0f, 1.0f)) - kSafeAngle;
  return {bounds.lower.x,
          bounds.lower.y,
          bounds.lower.z,
          bounds.upper.x,
          bounds.upper.y,
          bounds.upper.z,
          block.key[std::countr_zero(places)],
          first,
          axis.x,
          axis.y,
          axis.z,
          wide > 0 ? std::cos(wide) : INFINITY};
}

}  // namespace

std::vector<SplatPart> parts_of(const PointBlock& block) {
  std::vector<SplatPart> parts;
  for (uint32_t first = 0; first < kBlockSize; first += kPartSize)
    for (uint64_t left = used_places(block, first); left;) {
      const uint64_t same = places_with_key(block, left, block.key[std::countr_zero(left)]);
      parts.push_back(make_part(block, first, same));
      left &= ~same;
    }
  return parts;
}

}  // namespace photon_splat
