#include "direction_table.h"

#include <algorithm>

namespace photon_splat {
namespace {

// The first entry above u, or the last one. Halves without branches: which way they go nobody can guess.
size_t pick(const float* cdf, size_t count, float u) {
  const float* first = cdf;
  for (size_t left = count; left > 1;) {
    const size_t half = left / 2;
    first += first[half - 1] <= u ? half : 0;
    left -= half;
  }
  return first - cdf;
}

// Where u lies between two entries.
float within(float low, float high, float u) { return std::clamp((u - low) / std::max(high - low, 1e-30f), 0.0f, kBelowOne); }

float before(const float* cdf, size_t i) { return i ? cdf[i - 1] : 0.0f; }

}  // namespace

double DirectionTable::solid_angle(int row, int width, int height) {
  const double top = kPi * row / height, bottom = kPi * (row + 1) / height;
  return 2 * double(kPi) / width * (std::cos(top) - std::cos(bottom));
}

DirectionTable::DirectionTable(std::vector<float> density, int width, int height)
    : width_(width), height_(height), density_(std::move(density)), cdf_(density_.size()), row_cdf_(height) {
  double rows = 0;
  for (int row = 0; row < height_; ++row) {
    double running = 0;
    float* const cdf = &cdf_[static_cast<size_t>(row) * width_];
    for (int column = 0; column < width_; ++column)
      cdf[column] = static_cast<float>(running += density_[static_cast<size_t>(row) * width_ + column]);
    for (int column = 0; column < width_; ++column) cdf[column] /= static_cast<float>(running);
    row_cdf_[row] = static_cast<float>(rows += running * solid_angle(row, width_, height_));
  }
  for (float& d : density_) d /= row_cdf_.back();
  divide();
}

void DirectionTable::divide() {
  if (!even()) patch_cdf_.resize(static_cast<size_t>(kSectors) * height_);
  double all = 0, sums[kPatches] = {};
  for (int band = 0; band < kBands; ++band)
    for (int sector = 0; sector < kSectors; ++sector) {
      double& sum = sums[band * kSectors + sector];
      float* const cdf = even() ? nullptr : &patch_cdf_[static_cast<size_t>(sector) * height_];
      for (int row = first_row(band); row < first_row(band + 1); ++row) {
        const double omega = solid_angle(row, width_, height_);
        for (int column = first_column(sector); column < first_column(sector + 1); ++column)
          sum += omega * (even() ? 1 : density_[static_cast<size_t>(row) * width_ + column]);
        if (cdf) cdf[row] = static_cast<float>(sum);
      }
      if (cdf)
        for (int row = first_row(band); row < first_row(band + 1); ++row) cdf[row] = sum > 0 ? cdf[row] / static_cast<float>(sum) : 1;
      all += sum;
    }
  for (int i = 0; i < kPatches; ++i) share_[i] = static_cast<float>(sums[i] / all);
}

int DirectionTable::row_of(const Vec3& d) const {
  const float polar = std::atan2(std::hypot(d.x, d.y), d.z);
  return std::clamp(static_cast<int>(polar / kPi * static_cast<float>(height_)), 0, height_ - 1);
}

int DirectionTable::column_of(const Vec3& d) const {
  const float longitude = std::atan2(d.y, d.x);
  const float turns = (longitude < 0 ? longitude + 2 * kPi : longitude) / (2 * kPi);
  return std::clamp(static_cast<int>(turns * static_cast<float>(width_)), 0, width_ - 1);
}

// Uniform in solid angle within the cell.
Vec3 DirectionTable::direction_in(int row, int column, float down, float along) const {
  const float top = std::cos(kPi * static_cast<float>(row) / static_cast<float>(height_));
  const float bottom = std::cos(kPi * static_cast<float>(row + 1) / static_cast<float>(height_));
  const float z = top + (bottom - top) * down;
  const float longitude = (static_cast<float>(column) + along) * 2 * kPi / static_cast<float>(width_);
  const float sine = std::sqrt(std::max(0.0f, 1 - z * z));
  return {sine * std::cos(longitude), sine * std::sin(longitude), z};
}

Vec3 DirectionTable::sample(const Vec2& u) const {
  if (even()) return sample_sphere(u);
  const float target = u.x * row_cdf_.back();
  const size_t row = pick(row_cdf_.data(), row_cdf_.size(), target);
  const float* const cdf = &cdf_[row * width_];
  const size_t column = pick(cdf, width_, u.y);
  return direction_in(static_cast<int>(row), static_cast<int>(column), within(before(row_cdf_.data(), row), row_cdf_[row], target),
                      within(before(cdf, column), cdf[column], u.y));
}

float DirectionTable::pdf(const Vec3& d) const {
  if (even()) return 1 / (4 * kPi);
  return density_[static_cast<size_t>(row_of(d)) * width_ + column_of(d)];
}

Vec3 DirectionTable::sample_patch(int patch, const Vec2& u) const {
  const int band = patch / kSectors, sector = patch % kSectors;
  if (even()) return direction_in(band, sector, u.x, u.y);
  const int top = first_row(band), rows = first_row(band + 1) - top;
  const float* const row_cdf = &patch_cdf_[static_cast<size_t>(sector) * height_ + top];
  const size_t row = pick(row_cdf, rows, u.x);
  const int left = first_column(sector), columns = first_column(sector + 1) - left;
  const float* const cdf = &cdf_[(top + row) * width_];
  const float low = before(cdf, left), high = cdf[left + columns - 1], target = low + (high - low) * u.y;
  const size_t column = pick(cdf + left, columns, target);
  return direction_in(top + static_cast<int>(row), left + static_cast<int>(column), within(before(row_cdf, row), row_cdf[row], u.x),
                      within(before(cdf, left + column), cdf[left + column], target));
}

float DirectionTable::pdf_in_patch(const Vec3& d) const {
  const int row = row_of(d), column = column_of(d);
  const float density = even() ? 1 / (4 * kPi) : density_[static_cast<size_t>(row) * width_ + column];
  return density / share_[patch_at(row, column)];
}

}  // namespace photon_splat
