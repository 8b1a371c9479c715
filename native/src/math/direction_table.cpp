#include "math/direction_table.h"

#include <algorithm>

namespace photon_splat {
namespace {

float before(const float* cdf, int i) { return i ? cdf[i - 1] : 0.0f; }

constexpr int kRowsAtOnce = 32;  // of the search for a row

}  // namespace

double DirectionTable::solid_angle(int row, int width, int height) {
  const double top = kPi * row / height, bottom = kPi * (row + 1) / height;
  return 2 * double(kPi) / width * (std::cos(top) - std::cos(bottom));
}

DirectionTable::DirectionTable(std::vector<float> density, int width, int height)
    : width_(width),
      height_(height),
      row_steps_((width + kStep - 1) / kStep),
      steps_(static_cast<size_t>(row_steps_) * height),
      row_cdf_(height) {
  double rows = 0;
  for (int row = 0; row < height_; ++row) {
    double running = 0;
    std::vector<double> sums;  // up to each cell
    for (int column = 0; column < width_; ++column) {
      uint16_t& kept = steps_[static_cast<size_t>(row) * row_steps_ + column / kStep]
                           .density[place_in_step(column % kStep)];
      kept = packed(density[static_cast<size_t>(row) * width_ + column]);
      sums.push_back(running);
      running += unpacked(kept);
    }
    for (int step = 1; step < row_steps_; ++step)
      step_cdf_.push_back(static_cast<float>(sums[step * kStep] / running));
    step_cdf_.push_back(1);
    for (int sector = 0; sector < kSectors; ++sector)
      sector_cdf_.push_back(static_cast<float>(sums[first_column(sector)] / running));
    sector_cdf_.push_back(1);
    row_cdf_[row] = static_cast<float>(rows += running * solid_angle(row, width_, height_));
    cosine_.push_back(std::cos(kPi * static_cast<float>(row) / static_cast<float>(height_)));
    band_of_.push_back(static_cast<uint8_t>(row * kBands / height_));
  }
  cosine_.push_back(-1);
  for (int column = 0; column < width_; ++column)
    sector_of_.push_back(static_cast<uint8_t>(column * kSectors / width_));
  scale_ = 1 / row_cdf_.back();
  for (float& r : row_cdf_) r *= scale_;
  for (int row = 0; row < height_; row += kRowsAtOnce)
    coarse_row_cdf_.push_back(row_cdf_[std::min(row + kRowsAtOnce, height_) - 1]);
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
          sum += omega * pdf({row, column});
        cdf[row] = static_cast<float>(sum);
      }
      for (int row = first_row(band); row < first_row(band + 1); ++row)
        cdf[row] = sum > 0 ? cdf[row] / static_cast<float>(sum) : 1;
      all += sum;
    }
  for (int i = 0; i < kPatches; ++i) {
    share_[i] = static_cast<float>(sums[i] / all);
    over_share_[i] = 1 / share_[i];
  }
}

// A direction in the cell, uniform in solid angle.
Vec3 DirectionTable::direction_in(const Cell& cell, float down, float along) const {
  const float top = cosine_[cell.row], bottom = cosine_[cell.row + 1];
  const float z = top + (bottom - top) * down;
  const float sine = std::sqrt(std::max(0.0f, 1 - z * z));
  const Vec2 around =
      cos_sin_of_turn((static_cast<float>(cell.column) + along) / static_cast<float>(width_));
  return {sine * around.x, sine * around.y, z};
}

// target: of the row's CDF. Columns from first to last, which rounding must not leave.
DirectionTable::Sample DirectionTable::sample_row(int row, float down, float target, int first,
                                                  int last) const {
  const float* const cdf = &step_cdf_[static_cast<size_t>(row) * row_steps_];
  const int number = pick(cdf, row_steps_, target);
  const Step& step = steps_[static_cast<size_t>(row) * row_steps_ + number];
  float density[4][kFours], up_to[kFours];  // up to the end of each four
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < kFours; ++k) density[i][k] = unpacked(step.density[i * kFours + k]);
  for (int k = 0; k < kFours; ++k)
    up_to[k] = (density[0][k] + density[1][k]) + (density[2][k] + density[3][k]);
  for (int k = 1; k < kFours; ++k) up_to[k] += up_to[k - 1];
  const float in_step = within(before(cdf, number), cdf[number], target) * up_to[kFours - 1];
  int four = 0;
  for (int k = 0; k + 1 < kFours; ++k) four += up_to[k] <= in_step;
  float rest = in_step - before(up_to, four);
  const float a = density[0][four], ab = a + density[1][four], abc = ab + density[2][four];
  const int which = (rest >= a) + (rest >= ab) + (rest >= abc);
  const float from[] = {0, a, ab, abc};
  const Cell cell{row, std::clamp(number * kStep + 4 * four + which, first, last)};
  rest -= from[which];
  return {direction_in(cell, down,
                       std::clamp(rest / std::max(density[which][four], 1e-30f), 0.0f, kBelowOne)),
          cell};
}

DirectionTable::Sample DirectionTable::sample(const Vec2& u) const {
  const int coarse =
      pick(coarse_row_cdf_.data(), static_cast<int>(coarse_row_cdf_.size()), u.x) * kRowsAtOnce;
  const int row =
      coarse + pick(row_cdf_.data() + coarse, std::min(kRowsAtOnce, height_ - coarse), u.x);
  return sample_row(row, within(before(row_cdf_.data(), row), row_cdf_[row], u.x), u.y, 0,
                    width_ - 1);
}

DirectionTable::Sample DirectionTable::sample_patch(int patch, const Vec2& u) const {
  const int band = patch / kSectors, sector = patch % kSectors;
  const int top = first_row(band), rows = first_row(band + 1) - top;
  const float* const row_cdf = &patch_cdf_[static_cast<size_t>(sector) * height_ + top];
  const int down = pick(row_cdf, rows, u.x), row = top + down;
  const float* const edge = &sector_cdf_[static_cast<size_t>(row) * (kSectors + 1) + sector];
  return sample_row(row, within(before(row_cdf, down), row_cdf[down], u.x),
                    edge[0] + (edge[1] - edge[0]) * u.y, first_column(sector),
                    first_column(sector + 1) - 1);
}

}  // namespace photon_splat
