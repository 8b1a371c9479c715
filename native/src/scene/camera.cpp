#include "scene/camera.h"

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
      return 0.35875f - 0.48829f * std::cos(v) + 0.14128f * std::cos(2 * v) -
             0.01168f * std::cos(3 * v);
    }
  }
  return 0;
}

}  // namespace

Camera::Camera(const CameraSettings& settings) : s_(settings), axes_(settings.to_world) {
  if (s_.width < 1 || s_.height < 1 || s_.region_width < 1 || s_.region_height < 1)
    throw std::invalid_argument("the picture has no pixels");
  if (s_.x0 < 0 || s_.y0 < 0 || s_.x0 + s_.region_width > s_.width ||
      s_.y0 + s_.region_height > s_.height)
    throw std::invalid_argument("the render border lies outside the picture");
  if (s_.aperture.radius > 0 && (!(s_.aperture.focus > 0) || !(s_.aperture.ratio > 0)))
    throw std::invalid_argument("the camera's distance of focus or aperture ratio is not positive");
  if (s_.motion.size() > 1) motion_.emplace(s_.motion);
  const float width = support(s_.filter, s_.filter_width);
  std::vector<double> cdf(kFilterTable);
  double sum = 0;
  for (int i = 0; i < kFilterTable; ++i)
    cdf[i] = sum += std::max(
        0.0f, filter_value(s_.filter, (static_cast<float>(i) + 0.5f) / kFilterTable - 0.5f));
  filter_quantiles_.resize(kFilterTable + 1);
  int bin = 0;
  for (int i = 0; i <= kFilterTable; ++i) {
    const double target = sum * i / kFilterTable;
    while (bin + 1 < kFilterTable && cdf[bin] < target) ++bin;
    const double before = bin ? cdf[bin - 1] : 0, inside = (target - before) / (cdf[bin] - before);
    filter_quantiles_[i] =
        static_cast<float>(((bin + std::clamp(inside, 0.0, 1.0)) / kFilterTable - 0.5) * width);
  }
  if (const auto middle =
          ray(s_.region_width / 2, s_.region_height / 2, {0.5f, 0.5f}, {0.5f, 0.5f}))
    step_ = middle->footprint;
}

float Camera::filter_offset(float u) const {
  const float at = u * kFilterTable;
  const int i = std::min(static_cast<int>(at), kFilterTable - 1);
  return filter_quantiles_[i] +
         (filter_quantiles_[i + 1] - filter_quantiles_[i]) * (at - static_cast<float>(i));
}

// Uniform on the aperture, m: a disc, or a polygon with the middle of an edge at the angle
// `rotation`.
Vec2 Camera::on_aperture(const Vec2& u) const {
  const ApertureSettings& a = s_.aperture;
  Vec2 p;
  if (a.blades < 3) {
    p = sample_disk(u);
  } else {
    const float blades = static_cast<float>(a.blades), scaled = u.x * blades;
    const float corner = std::min(std::floor(scaled), blades - 1);
    // The triangle of the centre and an edge, uniform in area.
    const float outward = std::sqrt(std::clamp(scaled - corner, 0.0f, 1.0f)),
                across = outward * (2 * u.y - 1);
    const float half = kPi / blades, angle = a.rotation + 2 * half * corner;
    const float x = outward * std::cos(half), y = across * std::sin(half);
    p = {x * std::cos(angle) - y * std::sin(angle), x * std::sin(angle) + y * std::cos(angle)};
  }
  return {p.x * a.radius / a.ratio, p.y * a.radius};
}

// Moves a ray to the eye that stereo asks for. Straight up and down there is no side.
void Camera::to_eye(const Vec3& up, Vec3& origin, Vec3& direction) const {
  const StereoSettings& stereo = s_.stereo;
  const Vec3 across = cross(direction, up);
  const float cosine = length(across);
  if (stereo.offset == 0 || !(cosine > 1e-6f)) return;
  float apart = stereo.offset;
  if (stereo.merge_ends > 0) {
    const float angle = std::atan2(std::abs(dot(direction, up)), cosine),
                merged = (angle - stereo.merge_begins) /
                         std::max(stereo.merge_ends - stereo.merge_begins, 1e-6f);
    apart *= std::cos(0.5f * kPi * std::clamp(merged, 0.0f, 1.0f));
  }
  const Vec3 to_side = across * (apart / cosine);
  origin += to_side;
  if (std::isfinite(stereo.convergence))
    direction = normalize(direction * stereo.convergence - to_side);
}

std::optional<CameraRay> Camera::ray(int x, int y, const Vec2& u, const Vec2& lens,
                                     float time) const {
  const float px = static_cast<float>(s_.x0 + x) + 0.5f + filter_offset(u.x);
  const float py = static_cast<float>(s_.y0 + y) + 0.5f + filter_offset(u.y);
  const float step_x = (s_.right - s_.left) / static_cast<float>(s_.width);
  const float step_y = (s_.top - s_.bottom) / static_cast<float>(s_.height);
  float sx = s_.left + step_x * px, sy = s_.bottom + step_y * py;
  const Axes axes = axes_at(time);
  if (s_.panorama.kind != PanoramaKind::kNone)
    return panoramic(sx, sy, {step_x, step_y}, lens, axes);
  if (s_.zoom_before != 1 || s_.zoom_after != 1) {
    const float end = time < kShutterCentre ? s_.zoom_before : s_.zoom_after,
                zoom = 1 + (end - 1) * 2 * std::abs(time - kShutterCentre);
    sx *= zoom;
    sy *= zoom;
  }
  CameraRay ray;
  ray.footprint = 0.5f * (step_x + step_y);
  if (!s_.orthographic) {  // what a direction turns by from pixel to pixel
    const float wide = 1 + sx * sx + sy * sy;
    ray.footprint =
        0.5f * (step_x * std::sqrt(wide - sx * sx) + step_y * std::sqrt(wide - sy * sy)) / wide;
  }
  // Camera space: from a point of the lens to where the ray through the lens' centre meets the
  // plane of focus.
  Vec3 from{}, toward{sx, sy, -1};
  if (s_.orthographic) {
    from = {sx, sy, 0};
    toward = {0, 0, -1};
  }
  if (s_.aperture.radius > 0) {
    const Vec2 p = on_aperture(lens);
    from += {p.x, p.y, 0};
    toward = toward * s_.aperture.focus - Vec3{p.x, p.y, 0};
  }
  const float len = length(toward);
  ray.origin = axes.position + axes.to_world(from);
  ray.direction = axes.to_world(toward) / len;
  ray.cosine = -toward.z / len;
  if (!s_.orthographic) to_eye({0, 0, 1}, ray.origin, ray.direction);
  // As Cycles clips what an open lens sees: by the ray through its centre, or an orthographic
  // camera's at a depth in front, and so far along the ray behind.
  if (s_.orthographic) {
    ray.near = s_.clip_start / ray.cosine;
    ray.far = ray.near + (s_.clip_end - s_.clip_start);
  } else {
    const float along = length(Vec3{sx, sy, -1});
    ray.near = s_.clip_start * along;
    ray.far = s_.clip_end * along;
  }
  return ray;
}

std::optional<CameraRay> Camera::panoramic(float u, float v, const Vec2& step, const Vec2& lens,
                                           const Axes& axes) const {
  const std::optional<Vec3> seen = panorama_direction(s_.panorama, u, v);
  if (!seen) return std::nullopt;
  CameraRay ray;
  ray.footprint = 0;
  for (const auto& next : {panorama_direction(s_.panorama, u + step.x, v),
                           panorama_direction(s_.panorama, u, v + step.y)})
    ray.footprint += next ? 0.5f * length(*next - *seen) : 0;
  Vec3 from{}, toward = *seen;
  if (s_.aperture.radius > 0) {
    const Vec2 p = on_aperture(lens);
    // The lens faces the ray; its width lies in the plane of the ray and the viewing axis (Cycles'
    // choice; a mirror ball's: the camera's own X axis, mirrored).
    const bool mirror = s_.panorama.kind == PanoramaKind::kMirrorBall;
    const Vec3 axis = mirror ? Vec3{1, 0, 0} : Vec3{0, 0, -1},
               across = axis - *seen * dot(axis, *seen);
    const float sine = length(across);
    const Vec3 x = sine > 1e-6f ? across / sine : Basis(*seen).tangent;
    from = x * p.x + cross(*seen, x) * (mirror ? -p.y : p.y);
    toward = normalize(*seen * s_.aperture.focus - from);
  }
  to_eye({0, 1, 0}, from, toward);
  ray.origin = axes.position + axes.to_world(from);
  ray.direction = axes.to_world(toward);
  ray.cosine = 1;
  ray.near = s_.clip_start;
  ray.far = s_.clip_end;
  return ray;
}

}  // namespace photon_splat
