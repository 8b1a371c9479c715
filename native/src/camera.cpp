#include "camera.h"

#include <stdexcept>

namespace photon_splat {
namespace {

constexpr int kFilterTable = 4096;

// What Blender calls a filter's width is less than its support; these are Cycles' factors.
float support(FilterKind kind, float width) {
  switch (kind) {
    case FilterKind::kBox: return 1;
    case FilterKind::kGaussian: return 3 * width;
    case FilterKind::kBlackmanHarris: return 2 * width;
  }
  return width;
}

// Filter value at t in -1/2 .. 1/2 of its support; the shapes are those of Cycles' pixel filters.
float filter_value(FilterKind kind, float t) {
  switch (kind) {
    case FilterKind::kBox: return 1;
    case FilterKind::kGaussian: return std::exp(-2 * 36 * t * t);  // exp(-2 (6 t)^2)
    case FilterKind::kBlackmanHarris: {
      const float v = 2 * kPi * (t + 0.5f);
      return 0.35875f - 0.48829f * std::cos(v) + 0.14128f * std::cos(2 * v) - 0.01168f * std::cos(3 * v);
    }
  }
  return 0;
}

}  // namespace

Camera::Camera(const CameraSettings& settings) : s_(settings) {
  if (s_.width < 1 || s_.height < 1 || s_.region_width < 1 || s_.region_height < 1)
    throw std::invalid_argument("the picture has no pixels");
  if (s_.x0 < 0 || s_.y0 < 0 || s_.x0 + s_.region_width > s_.width || s_.y0 + s_.region_height > s_.height)
    throw std::invalid_argument("the render border lies outside the picture");
  const Affine& m = s_.to_world;
  right_ = m.column(0);
  up_ = m.column(1);
  back_ = m.column(2);
  position_ = {m.m[3], m.m[7], m.m[11]};
  const float width = support(s_.filter, s_.filter_width);
  std::vector<double> cdf(kFilterTable);
  double sum = 0;
  for (int i = 0; i < kFilterTable; ++i)
    cdf[i] = sum += std::max(0.0f, filter_value(s_.filter, (static_cast<float>(i) + 0.5f) / kFilterTable - 0.5f));
  filter_quantiles_.resize(kFilterTable + 1);
  int bin = 0;
  for (int i = 0; i <= kFilterTable; ++i) {
    const double target = sum * i / kFilterTable;
    while (bin + 1 < kFilterTable && cdf[bin] < target) ++bin;
    const double before = bin ? cdf[bin - 1] : 0, inside = (target - before) / (cdf[bin] - before);
    filter_quantiles_[i] = static_cast<float>(((bin + std::clamp(inside, 0.0, 1.0)) / kFilterTable - 0.5) * width);
  }
}

float Camera::filter_offset(float u) const {
  const float at = u * kFilterTable;
  const int i = std::min(static_cast<int>(at), kFilterTable - 1);
  return filter_quantiles_[i] + (filter_quantiles_[i + 1] - filter_quantiles_[i]) * (at - static_cast<float>(i));
}

CameraRay Camera::ray(int x, int y, const Vec2& u) const {
  const float px = static_cast<float>(s_.x0 + x) + 0.5f + filter_offset(u.x);
  const float py = static_cast<float>(s_.y0 + y) + 0.5f + filter_offset(u.y);
  const float sx = s_.left + (s_.right - s_.left) * px / static_cast<float>(s_.width);
  const float sy = s_.bottom + (s_.top - s_.bottom) * py / static_cast<float>(s_.height);
  CameraRay ray;
  ray.footprint = std::max((s_.right - s_.left) / static_cast<float>(s_.width),
                           (s_.top - s_.bottom) / static_cast<float>(s_.height));
  if (s_.orthographic) {
    ray.origin = position_ + right_ * sx + up_ * sy;
    ray.direction = -back_;
    ray.cosine = 1;
  } else {
    const Vec3 toward = right_ * sx + up_ * sy - back_;
    const float len = length(toward);
    ray.origin = position_;
    ray.direction = toward / len;
    ray.cosine = 1 / len;
  }
  ray.near = s_.clip_start / ray.cosine;
  ray.far = s_.clip_end / ray.cosine;
  return ray;
}

}  // namespace photon_splat
