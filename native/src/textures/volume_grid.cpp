#include "textures/volume_grid.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "math/sampling.h"

namespace photon_splat {
namespace {

constexpr int kShift = 3;
static_assert(1 << kShift == VolumeGrid::kSide);
constexpr float kFarthest = 1e9f;  // voxels: beyond it whole numbers are none

size_t local(int x, int y, int z) {
  constexpr int kLast = VolumeGrid::kSide - 1;
  return static_cast<size_t>(((x & kLast) << (2 * kShift)) | ((y & kLast) << kShift) | (z & kLast));
}

// Weights of the voxels at -1, 0, 1 and 2: a cubic B-spline.
std::array<float, 4> spline(float t) {
  const float s = 1 - t;
  return {s * s * s / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * s * s * s - 6 * s * s + 4) / 6,
          t * t * t / 6};
}

}  // namespace

VolumeGrid::VolumeGrid(uint32_t components, const Affine& to_index, const Index& lower,
                       const Index& bricks, std::vector<int32_t> table, std::vector<float> values,
                       const Value& background)
    : components_(components),
      to_index_(to_index),
      to_object_(inverse(to_index)),
      lower_(lower),
      bricks_(bricks),
      table_(std::move(table)),
      values_(std::move(values)),
      background_(background) {
  if (components != 1 && components != 3 && components != 4)
    throw std::invalid_argument("a volume grid has neither 1, 3 nor 4 components");
  size_t places = 1;
  for (const int count : bricks) {
    if (count < 1 || count > (1 << 20))
      throw std::invalid_argument("a volume grid has an impossible number of bricks");
    places *= static_cast<size_t>(count);
  }
  const size_t brick = size_t{kVoxels} * components;
  if (table_.size() != places || values_.size() % brick != 0)
    throw std::invalid_argument("a volume grid's values do not fit its bricks");
  for (const int32_t number : table_)
    if (number < -1 || (number >= 0 && static_cast<size_t>(number) >= values_.size() / brick))
      throw std::invalid_argument("a volume grid names a brick that does not exist");
  for (const float value : values_)
    if (!std::isfinite(value))
      throw std::invalid_argument("a volume grid has a value that is not finite");
}

VolumeGrid::Index VolumeGrid::upper() const {
  return {lower_[0] + bricks_[0] * kSide, lower_[1] + bricks_[1] * kSide,
          lower_[2] + bricks_[2] * kSide};
}

const float* VolumeGrid::voxel(const Index& index) const {
  const int x = index[0] - lower_[0], y = index[1] - lower_[1], z = index[2] - lower_[2];
  const int32_t number = brick_at(x >> kShift, y >> kShift, z >> kShift);
  return number < 0 ? background_.data() : brick(number) + local(x, y, z) * components_;
}

VolumeGrid::Value VolumeGrid::value_of(const float* voxel) const {
  Value out{};
  std::copy_n(voxel, components_, out.begin());
  return out;
}

VolumeGrid::Value VolumeGrid::linear(const Index& i, const Vec3& t) const {
  const float* corners[8];
  const int x = i[0] - lower_[0], y = i[1] - lower_[1], z = i[2] - lower_[2];
  constexpr int kLast = kSide - 1;
  if ((x & kLast) < kLast && (y & kLast) < kLast && (z & kLast) < kLast) {
    const int32_t number = brick_at(x >> kShift, y >> kShift, z >> kShift);
    if (number < 0) return background_;
    const float* const first = brick(number) + local(x, y, z) * components_;
    for (size_t k = 0; k < 8; ++k)
      corners[k] =
          first + ((k >> 2) * kSide * kSide + (k >> 1 & 1) * kSide + (k & 1)) * components_;
  } else {
    for (int k = 0; k < 8; ++k)
      corners[k] = voxel({i[0] + (k >> 2), i[1] + (k >> 1 & 1), i[2] + (k & 1)});
  }
  Value out{};
  for (uint32_t c = 0; c < components_; ++c) {
    float along_z[4];
    for (size_t k = 0; k < 4; ++k)
      along_z[k] = corners[2 * k][c] + (corners[2 * k + 1][c] - corners[2 * k][c]) * t.z;
    const float low = along_z[0] + (along_z[1] - along_z[0]) * t.y,
                high = along_z[2] + (along_z[3] - along_z[2]) * t.y;
    out[c] = low + (high - low) * t.x;
  }
  return out;
}

VolumeGrid::Value VolumeGrid::cubic(const Index& i, const Vec3& t) const {
  const std::array<float, 4> wx = spline(t.x), wy = spline(t.y), wz = spline(t.z);
  Value out{};
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) {
        const float* const from = voxel({i[0] + x - 1, i[1] + y - 1, i[2] + z - 1});
        const float w =
            wx[static_cast<size_t>(x)] * wy[static_cast<size_t>(y)] * wz[static_cast<size_t>(z)];
        for (uint32_t c = 0; c < components_; ++c) out[c] += w * from[c];
      }
  return out;
}

VolumeGrid::Value VolumeGrid::at(const Vec3& position, GridInterpolation interpolation) const {
  const Vec3 p = to_index_.point(position);
  if (!(max_abs(p) < kFarthest)) return background_;
  const Vec3 whole{std::floor(p.x), std::floor(p.y), std::floor(p.z)}, t = p - whole;
  Index i{static_cast<int>(whole.x), static_cast<int>(whole.y), static_cast<int>(whole.z)};
  if (interpolation == GridInterpolation::kLinear) return linear(i, t);
  if (interpolation == GridInterpolation::kCubic) return cubic(i, t);
  uint32_t drawn = 0x766f7865u;
  for (int a = 0; a < 3; ++a) drawn = hash32(drawn ^ std::bit_cast<uint32_t>(position[a]));
  for (int a = 0; a < 3; ++a) {
    drawn = hash32(drawn);
    if (static_cast<float>(drawn >> 8) * 0x1p-24f < t[a]) ++i[static_cast<size_t>(a)];
  }
  return value_of(voxel(i));
}

float VolumeGrid::sum(const float* value) const {
  float all = 0;
  for (uint32_t c = 0; c < components_; ++c) all += value[c];
  return all;
}

std::optional<VolumeGrid::Extremes> VolumeGrid::extremes(const Index& from, const Index& to) const {
  std::optional<Extremes> out;
  float most = 0, least = 0;
  Index first, last;  // of bricks
  for (size_t a = 0; a < 3; ++a) {
    first[a] = std::max((from[a] - lower_[a]) >> kShift, 0);
    last[a] = std::min((to[a] - lower_[a]) >> kShift, bricks_[a] - 1);
  }
  for (int bx = first[0]; bx <= last[0]; ++bx)
    for (int by = first[1]; by <= last[1]; ++by)
      for (int bz = first[2]; bz <= last[2]; ++bz) {
        const int32_t number = brick_at(bx, by, bz);
        if (number < 0) continue;
        const float* const values = brick(number);
        const Index corner{lower_[0] + bx * kSide, lower_[1] + by * kSide, lower_[2] + bz * kSide};
        Index low, high;
        for (size_t a = 0; a < 3; ++a) {
          low[a] = std::max(from[a], corner[a]);
          high[a] = std::min(to[a], corner[a] + kSide - 1);
        }
        for (int x = low[0]; x <= high[0]; ++x)
          for (int y = low[1]; y <= high[1]; ++y)
            for (int z = low[2]; z <= high[2]; ++z) {
              const float own =
                  sum(values + local(x - corner[0], y - corner[1], z - corner[2]) * components_);
              if (!out || own > most) {
                if (!out) out.emplace(Extremes{{x, y, z}, {x, y, z}}), least = own;
                out->most = {x, y, z};
                most = own;
              }
              if (own < least) {
                out->least = {x, y, z};
                least = own;
              }
            }
      }
  return out;
}

}  // namespace photon_splat
