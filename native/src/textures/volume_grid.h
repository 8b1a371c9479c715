// A grid of values in space, as OpenVDB has them: voxels at whole coordinates of an index space. It
// is kept in bricks of 8 x 8 x 8 voxels; those that hold nothing but the background are not there.
#pragma once

#include <optional>
#include <vector>

#include "math/vec.h"

namespace photon_splat {

// How a value is found between voxels: kCubic by B-splines, which smooth; kVoxel: that of one of
// the eight around, by a chance that is its share of kLinear and that the place alone decides. So
// is a function of the value interpolated, not the value before it.
enum class GridInterpolation : uint8_t { kLinear, kCubic, kVoxel };

class VolumeGrid {
 public:
  static constexpr int kSide = 8, kVoxels = kSide * kSide * kSide;
  using Index = std::array<int, 3>;
  using Value = std::array<float, 4>;

  // lower: voxel where the first brick begins; bricks: how many along each axis; table: the number
  // of the brick at each place (z fastest), -1: none; values: brick by brick, voxel by voxel (z
  // fastest), all components of each. Throws std::invalid_argument for what does not fit.
  VolumeGrid(uint32_t components, const Affine& to_index, const Index& lower, const Index& bricks,
             std::vector<int32_t> table, std::vector<float> values, const Value& background);

  uint32_t components() const { return components_; }   // 1, 3 or 4
  const Affine& to_index() const { return to_index_; }  // from the object's coordinates
  const Affine& to_object() const { return to_object_; }
  Index lower() const { return lower_; }
  Index upper() const;  // beyond the last voxel

  // At a place in the object's coordinates; absent components are 0.
  Value at(const Vec3& position, GridInterpolation interpolation) const;
  // The values of a voxel.
  const float* voxel(const Index& index) const;

  // The voxels of the largest and of the smallest value (by the sum of components) of those between
  // two corners that bricks hold; none where they hold none.
  struct Extremes {
    Index most, least;
  };
  std::optional<Extremes> extremes(const Index& from, const Index& to) const;

  size_t memory() const { return values_.size() * sizeof(float) + table_.size() * sizeof(int32_t); }

 private:
  int32_t brick_at(int x, int y, int z) const {
    const auto inside = [](int i, int count) {
      return static_cast<unsigned>(i) < static_cast<unsigned>(count);
    };
    if (!inside(x, bricks_[0]) || !inside(y, bricks_[1]) || !inside(z, bricks_[2])) return -1;
    return table_[(static_cast<size_t>(x) * static_cast<size_t>(bricks_[1]) +
                   static_cast<size_t>(y)) *
                      static_cast<size_t>(bricks_[2]) +
                  static_cast<size_t>(z)];
  }
  const float* brick(int32_t number) const {
    return &values_[static_cast<size_t>(number) * kVoxels * components_];
  }
  float sum(const float* value) const;
  Value value_of(const float* voxel) const;
  Value linear(const Index& i, const Vec3& t) const;
  Value cubic(const Index& i, const Vec3& t) const;

  uint32_t components_;
  Affine to_index_, to_object_;
  Index lower_, bricks_;
  std::vector<int32_t> table_;
  std::vector<float> values_;
  Value background_;
};

}  // namespace photon_splat
