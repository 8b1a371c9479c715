// Directions drawn in proportion to a table over the sphere.
#pragma once

#include <vector>

#include "math/sampling.h"

namespace photon_splat {

// The first of `count` ascending numbers above u, or the last one. Counted without branches: where
// u lies nobody can guess.
inline int pick(const float* cdf, int count, float u) {
  int below = 0;
  for (int i = 0; i < count; ++i) below += cdf[i] <= u;
  return std::min(below, count - 1);
}

// Where u lies between two entries.
inline float within(float low, float high, float u) {
  return std::clamp((u - low) / std::max(high - low, 1e-30f), 0.0f, kBelowOne);
}

// The table's cells are equal in longitude (from +X) and polar angle (from +Z). Directions can be
// drawn from all of it, or from one of the patches that it is divided into.
class DirectionTable {
 public:
  static constexpr int kBands = 16, kSectors = 16, kPatches = kBands * kSectors;
  struct Cell {
    int row, column;
  };
  struct Sample {
    Vec3 direction;
    Cell cell;
  };

  // All directions alike.
  DirectionTable() : DirectionTable(std::vector<float>(kPatches, 1.0f), kSectors, kBands) {
    even_ = true;
  }
  // density: per cell, row by row, positive; what factor it is short of a density per solid angle
  // does not matter. width >= kSectors, height >= kBands.
  DirectionTable(std::vector<float> density, int width, int height);

  bool even() const { return even_; }
  Sample sample(const Vec2& u) const;
  Sample sample_patch(int patch, const Vec2& u) const;

  // The cell of a unit vector. Between cells rounding decides; samples belong to the cell that they
  // were drawn from.
  Cell cell_of(const Vec3& d) const {
    const float turn = turn_of(d.y, d.x), column = turn < 0 ? turn + 1 : turn,
                row = 2 * turn_of(std::sqrt(d.x * d.x + d.y * d.y), d.z);
    return {std::clamp(static_cast<int>(row * static_cast<float>(height_)), 0, height_ - 1),
            std::clamp(static_cast<int>(column * static_cast<float>(width_)), 0, width_ - 1)};
  }
  float pdf(const Cell& c) const {  // of sample(), 1/sr
    const Step& step = steps_[static_cast<size_t>(c.row) * row_steps_ + c.column / kStep];
    return scale_ * unpacked(step.density[place_in_step(c.column % kStep)]);
  }
  int patch_of(const Cell& c) const { return band_of_[c.row] * kSectors + sector_of_[c.column]; }
  float share(int patch) const { return share_[patch]; }  // of the directions that sample() draws
  // Density of sample_patch(), 1/sr
  float pdf_in_patch(const Cell& c) const { return pdf(c) * over_share_[patch_of(c)]; }

  // Solid angle of one of `width` cells in a row of `height`, sr.
  static double solid_angle(int row, int width, int height);

 private:
  // Densities of cells next to each other in a row, in the upper halves of floats: what a draw
  // looks at last is one line of the cache.
  static constexpr int kStep = 32, kFours = kStep / 4;
  struct alignas(64) Step {
    uint16_t density[kStep] = {};  // of each four cells the first, then the second ones, ...
  };
  static int place_in_step(int i) { return i % 4 * kFours + i / 4; }
  static float unpacked(uint16_t half) {
    return std::bit_cast<float>(static_cast<uint32_t>(half) << 16);
  }
  static uint16_t packed(float f) {
    return static_cast<uint16_t>((std::bit_cast<uint32_t>(f) + 0x8000) >> 16);
  }

  void divide();
  Sample sample_row(int row, float down, float target, int first, int last) const;
  int first_row(int band) const { return (band * height_ + kBands - 1) / kBands; }
  int first_column(int sector) const { return (sector * width_ + kSectors - 1) / kSectors; }
  Vec3 direction_in(const Cell& cell, float down, float along) const;

  int width_, height_, row_steps_;
  bool even_ = false;
  float scale_ = 1;                              // of the densities kept
  std::vector<Step> steps_;                      // row by row
  std::vector<float> step_cdf_;                  // per row over its steps, normalised
  std::vector<float> sector_cdf_;                // the same where sectors begin, and 1
  std::vector<float> row_cdf_, coarse_row_cdf_;  // all rows; the last of every so many
  // Per sector, over the rows of each band, normalised within the patch
  std::vector<float> patch_cdf_;
  std::vector<float> cosine_;                 // of the polar angle, where rows begin
  std::vector<uint8_t> band_of_, sector_of_;  // rows and columns
  float share_[kPatches], over_share_[kPatches];
};

}  // namespace photon_splat
