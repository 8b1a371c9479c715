// Directions drawn in proportion to a table over the sphere.
#pragma once

#include <vector>

#include "sampling.h"

namespace photon_splat {

// The table's cells are equal in longitude (from +X) and polar angle (from +Z). Directions can be drawn from all of it, or from one of
// the patches that it is divided into. Without cells: all directions alike.
class DirectionTable {
 public:
  static constexpr int kBands = 16, kSectors = 16, kPatches = kBands * kSectors;

  DirectionTable() { divide(); }
  // density: per cell, row by row, positive; what factor it is short of a density per solid angle does not matter. width >= kSectors,
  // height >= kBands.
  DirectionTable(std::vector<float> density, int width, int height);

  bool even() const { return density_.empty(); }
  Vec3 sample(const Vec2& u) const;
  float pdf(const Vec3& d) const;  // of the unit vector d, 1/sr

  int patch_of(const Vec3& d) const { return patch_at(row_of(d), column_of(d)); }
  float share(int patch) const { return share_[patch]; }    // of the directions that sample() draws
  Vec3 sample_patch(int patch, const Vec2& u) const;
  float pdf_in_patch(const Vec3& d) const;                   // of d, drawn from its patch

  // Solid angle of one of `width` cells in a row of `height`, sr.
  static double solid_angle(int row, int width, int height);

 private:
  void divide();
  int row_of(const Vec3& d) const;
  int column_of(const Vec3& d) const;
  int patch_at(int row, int column) const { return row * kBands / height_ * kSectors + column * kSectors / width_; }
  int first_row(int band) const { return (band * height_ + kBands - 1) / kBands; }
  int first_column(int sector) const { return (sector * width_ + kSectors - 1) / kSectors; }
  Vec3 direction_in(int row, int column, float down, float along) const;

  int width_ = kSectors, height_ = kBands;
  std::vector<float> density_;      // per cell, 1/sr
  std::vector<float> cdf_;          // per row over longitude, normalised
  std::vector<float> row_cdf_;
  std::vector<float> patch_cdf_;    // per sector, over the rows of each band, normalised within the patch
  float share_[kPatches];
};

}  // namespace photon_splat
