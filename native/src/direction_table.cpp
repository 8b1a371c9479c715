#include "direction_table.h"

#include <algorithm>

namespace photon_splat {
namespace {

float before(const float* cdf, int i) { return i ? cdf[i - 1] : 0.0f; }

// pick() in two steps: `coarse` holds every so many-th number and the last one.
int pick_in_steps(const float* coarse, int steps, const float* cdf, int count, int step, float u) {
  const int first = pick(coarse, steps, u) * step;
  return first + pick(cdf + first, std::min(step, count - first), u);
}

}  // namespace

double DirectionTable::solid_angle(int row, int width, int height) {
  const double top = kPi * row / height, bottom = kPi * (row + 1) / height;
  return 2 * double(kPi) / width * (std::cos(top) - std::cos(bottom));
}

DirectionTable::DirectionTable(std::vector<float> density, int width, int height)
    : width_(width), height_(height), steps_((width + kStep - 1) / kStep), density_(std::move(density)), cdf_(density_.size()),
      row_cdf_(height) {
  double rows = 0;
  for (int row = 0; row < height_; ++row) {
    double running = 0;
    float* const cdf = &cdf_[static_cast<size_t>(row) * width_];
    for (int column = 0; column < width_; ++column)
      cdf[column] = static_cast<float>(running += density_[static_cast<size_t>(row) * width_ + column]);
    for (int column = 0; column < width_; ++column) cdf[column] /= static_cast<float>(running);
    for (int step = 0; step < steps_; ++step) coarse_cdf_.push_back(cdf[std::min((step + 1) * kStep, width_) - 1]);
    row_cdf_[row] = static_cast<float>(rows += running * solid_angle(row, width_, height_));
    cosine_.push_back(std::cos(kPi * static_cast<float>(row) / static_cast<float>(height_)));
    band_of_.push_back(static_cast<uint8_t>(row * kBands / height_));
  }
  cosine_.push_back(-1);
  for (int column = 0; column < width_; ++column) sector_of_.push_back(static_cast<uint8_t>(column * kSectors / width_));
  for (float& d : density_) d /= row_cdf_.back();
  const float all = row_cdf_.back();
  for (float& r : row_cdf_) r /= all;
  for (int row = 0; row < height_; row += kStep) coarse_row_cdf_.push_back(row_cdf_[std::min(row + kStep, height_) - 1]);
  divide();
}

void DirectionTable::divide() {
  patch_cdf_.resize(static_cast<size_t>(kSectors) * height_);
  double all = 0, sums[kPatches] = {};
  for (int band = 0; band < kBands; ++band)
    for (int sector = 0; sector < kSectors; ++sector) {
      double& sum = sums[band * kSectors + sector];
      float* const cdf = &patch_cdf_[static_cast<size_t>(sector) * height_];
      for (int row = first_row(band); row < first_row(band + 1); ++row) {
        const double omega = solid_angle(row, width_, height_);
        for (int column = first_column(sector); column < first_column(sector + 1); ++column)
          sum += omega * density_[static_cast<size_t>(row) * width_ + column];
        cdf[row] = static_cast<float>(sum);
      }
      for (int row = first_row(band); row < first_row(band + 1); ++row) cdf[row] = sum > 0 ? cdf[row] / static_cast<float>(sum) : 1;
      all += sum;
    }
  for (int i = 0; i < kPatches; ++i) {
    share_[i] = static_cast<float>(sums[i] / all);
    over_share_[i] = 1 / share_[i];
  }
}

int DirectionTable::pick_column(int row, float u) const {
  return pick_in_steps(&coarse_cdf_[static_cast<size_t>(row) * steps_], steps_, &cdf_[static_cast<size_t>(row) * width_], width_, kStep, u);
}

// Uniform in solid angle within the cell.
Vec3 DirectionTable::direction_in(const Cell& cell, float down, float along) const {
  const float top = cosine_[cell.row], bottom = cosine_[cell.row + 1];
  const float z = top + (bottom - top) * down;
  const float sine = std::sqrt(std::max(0.0f, 1 - z * z));
  const Vec2 around = cos_sin_of_turn((static_cast<float>(cell.column) + along) / static_cast<float>(width_));
  return {sine * around.x, sine * around.y, z};
}

DirectionTable::Sample DirectionTable::sample(const Vec2& u) const {
  const int row = pick_in_steps(coarse_row_cdf_.data(), static_cast<int>(coarse_row_cdf_.size()), row_cdf_.data(), height_, kStep, u.x);
  const int column = pick_column(row, u.y);
  const float* const cdf = &cdf_[static_cast<size_t>(row) * width_];
  const Cell cell{row, column};
  return {direction_in(cell, within(before(row_cdf_.data(), row), row_cdf_[row], u.x), within(before(cdf, column), cdf[column], u.y)), cell};
}

DirectionTable::Sample DirectionTable::sample_patch(int patch, const Vec2& u) const {
  const int band = patch / kSectors, sector = patch % kSectors;
  const int top = first_row(band), rows = first_row(band + 1) - top;
  const float* const row_cdf = &patch_cdf_[static_cast<size_t>(sector) * height_ + top];
  const int down = pick(row_cdf, rows, u.x), row = top + down;
  const int left = first_column(sector), last = first_column(sector + 1) - 1;
  const float* const cdf = &cdf_[static_cast<size_t>(row) * width_];
  const float low = before(cdf, left), target = low + (cdf[last] - low) * u.y;
  const int column = std::clamp(pick_column(row, target), left, last);
  const Cell cell{row, column};
  return {direction_in(cell, within(before(row_cdf, down), row_cdf[down], u.x), within(before(cdf, column), cdf[column], target)), cell};
}

}  // namespace photon_splat
