#include "film/pixel_blur.h"

#include <algorithm>

namespace photon_splat {
namespace {

constexpr float kMost = 1e30f;
constexpr size_t kRows = 32, kColumns = 64;  // that a thread takes at once

}  // namespace

void blur(const std::vector<float>& in, int width, int height, int r, std::vector<float>& out,
          ThreadPool& pool) {
  std::vector<float> rows(in.size());
  out.resize(in.size());
  const CancelFlag never;
  pool.for_parts(static_cast<size_t>(height), kRows, never, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) {
      const float* from = &in[y * width];
      float* to = &rows[y * width];
      double sum = 0;
      // a sum that slides never gets rid of infinity
      const auto value = [from](int x) { return from[x] < kMost ? from[x] : kMost; };
      for (int x = 0; x < std::min(r, width); ++x) sum += value(x);
      for (int x = 0; x < width; ++x) {
        if (x + r < width) sum += value(x + r);
        if (x - r > 0) sum -= value(x - r - 1);
        to[x] = static_cast<float>(sum / (std::min(width - 1, x + r) - std::max(0, x - r) + 1));
      }
    }
  });
  pool.for_parts(static_cast<size_t>(width), kColumns, never, [&](size_t begin, size_t end) {
    double sums[kColumns] = {};
    const auto add_row = [&](int y, double sign) {
      const float* row = &rows[static_cast<size_t>(y) * width];
      for (size_t x = begin; x < end; ++x) sums[x - begin] += sign * row[x];
    };
    for (int y = 0; y < std::min(r, height); ++y) add_row(y, 1);
    for (int y = 0; y < height; ++y) {
      if (y + r < height) add_row(y + r, 1);
      if (y - r > 0) add_row(y - r - 1, -1);
      const double weight = 1.0 / (std::min(height - 1, y + r) - std::max(0, y - r) + 1);
      float* to = &out[static_cast<size_t>(y) * width];
      for (size_t x = begin; x < end; ++x)
        to[x] = static_cast<float>(std::max(0.0, sums[x - begin] * weight));
    }
  });
}

}  // namespace photon_splat
