#include "lights/emission/emission_discs.h"

namespace photon_splat {
namespace {

constexpr float kStep = 0.25f;  // of radii
// The smallest disc over what half of the view is in: its surroundings light it
constexpr float kRoom = 2;
constexpr float kWorthIt = 0.5f;  // of the scene's radius: discs beyond would bring little
float squared(float x) { return x * x; }
// Rounding must not put a line outside the disc that it was drawn from
constexpr float kSlack = 1 + 1e-4f;

}  // namespace

void EmissionDiscs::focus(const Vec3& center, float radius) {
  small_ = 0;
  share_[0] = 1;
  focus_ = center;
  const float least = kRoom * radius;
  if (!is_finite(center) || !(least > 1e-9f * radius_)) return;
  float width = kWorthIt * radius_;
  if (!(least < width)) return;
  for (width = least; width < kWorthIt * radius_ && small_ < kMost; width /= kStep)
    width_[small_++] = width;
  std::reverse(width_, width_ + small_);
  float sum = share_[0] = std::sqrt(radius_);
  for (int k = 0; k < small_; ++k) sum += share_[k + 1] = std::sqrt(width_[k]);
  for (int k = 0; k <= small_; ++k) share_[k] /= sum;
}

EmissionDiscs::Place EmissionDiscs::sample(const Vec3& direction, const Vec2& u) const {
  int disc = 0;
  float rest = u.x;
  for (; disc < small_ && rest >= share_[disc]; ++disc) rest -= share_[disc];
  const Vec2 p = sample_disk({std::min(rest / share_[disc], kBelowOne), u.y});
  const float width = disc ? width_[disc - 1] : radius_;
  const Basis basis(direction);
  if (!disc) {
    const Vec3 outside = center_ + basis.to_world({p.x * width, p.y * width, -width});
    return {outside + direction * width, outside, width};
  }
  const Vec3 through = focus_ + basis.to_world({p.x * width, p.y * width, 0});
  return {through, before_scene(direction, through), width};
}

float EmissionDiscs::area(const Vec3& direction, const Vec3& on_line) const {
  const auto squared_distance = [&](const Vec3& center) {
    const Vec3 from = on_line - center;
    return length2(from - direction * dot(from, direction));
  };
  const float whole = kPi * radius_ * radius_;
  if (!small_) return whole;
  double density =
      squared_distance(center_) <= squared(radius_) * kSlack ? share_[0] / double(whole) : 0;
  const float d2 = squared_distance(focus_);
  for (int k = 0; k < small_ && d2 <= squared(width_[k]) * kSlack; ++k)
    density += share_[k + 1] / (double(kPi) * squared(width_[k]));
  return density > 0 ? static_cast<float>(1 / density) : 0;
}

double EmissionDiscs::least_area() const {
  double density = share_[0] / scene_area();
  for (int k = 0; k < small_; ++k) density += share_[k + 1] / (double(kPi) * squared(width_[k]));
  return 1 / density;
}

}  // namespace photon_splat
