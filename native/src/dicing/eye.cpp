#include "dicing/eye.h"

#include <algorithm>

namespace photon_splat {
namespace {

Place unit(const Place& a) {
  const double l = length(a);
  return {a.x / l, a.y / l, a.z / l};
}

}  // namespace

Eye::Eye(const EyeSettings& settings) : s_(settings) {
  const double across = (s_.right - s_.left) / s_.width, up = (s_.top - s_.bottom) / s_.height;
  switch (s_.lens) {
    case EyeLens::kPanorama: pixel_ = s_.angle; break;
    case EyeLens::kOrthographic: pixel_ = std::min(across, up); break;
    case EyeLens::kPerspective: {
      const Place ahead{0.5 * (s_.left + s_.right), 0.5 * (s_.bottom + s_.top), -1.0};
      const Place step = across < up ? Place{across, 0, 0} : Place{0, up, 0};
      const Place axis = unit(ahead), turned = unit(ahead + step) - axis;
      pixel_ = length(turned - axis * dot(turned, axis));
    }
  }
  sides_ = {{{unit({1, 0, s_.right}), {s_.right, 0, -1}},
             {unit({-1, 0, -s_.left}), {s_.left, 0, -1}},
             {unit({0, 1, s_.top}), {0, s_.top, -1}},
             {unit({0, -1, -s_.bottom}), {0, s_.bottom, -1}}}};
}

double Eye::pixel_size(const Place& world) const {
  const auto& m = s_.to_world;
  const Place d = world - Place{m[3], m[7], m[11]};
  const Place seen{d.x * m[0] + d.y * m[4] + d.z * m[8], d.x * m[1] + d.y * m[5] + d.z * m[9],
                   d.x * m[2] + d.y * m[6] + d.z * m[10]};
  if (s_.lens == EyeLens::kOrthographic) return orthographic(seen);
  // As if each place were straight ahead
  const double size = pixel_ * length(seen);
  if (s_.lens == EyeLens::kPanorama || s_.offscreen <= 1) return size;
  return size + pixel_ * (s_.offscreen - 1) * out_of_view(seen);
}

double Eye::orthographic(const Place& seen) const {
  if (s_.offscreen <= 1) return pixel_;
  const auto within = [](double v, double low, double high) {
    return std::min(std::max(v, low), high);
  };
  const Place nearest{within(seen.x, s_.left, s_.right), within(seen.y, s_.bottom, s_.top),
                      std::min(seen.z, 0.0)};
  const double half = 0.5 * std::sqrt((s_.right - s_.left) * (s_.top - s_.bottom));
  return pixel_ * (1 + (s_.offscreen - 1) * length(seen - nearest) / half);
}

// m, from the pyramid that is seen.
double Eye::out_of_view(const Place& seen) const {
  const double distance = length(seen);
  double away = 0;
  for (const Side& side : sides_) {
    const double beyond = dot(seen, side.normal);
    if (beyond > 0) away = std::max(away, dot(seen, side.along) >= 0 ? beyond : distance);
  }
  return away;
}

}  // namespace photon_splat
