// Where on a ray through a medium the light of near lights is scattered.
#include "lights/lights.h"

namespace photon_splat {
namespace {

// Of the distances from a centre along a ray: the angles they are seen under grow evenly.
struct Equiangular {
  float nearest, height, begin, end;  // distance along the ray and from it; angles
};

Equiangular equiangular(const Vec3& center, float radius, const Vec3& origin, const Vec3& direction,
                        float near, float far) {
  const Vec3 to = center - origin;
  const float nearest = dot(to, direction);
  const float height = std::max(
      {length(to - direction * nearest), 0.5f * radius, 1e-5f * std::abs(nearest), 1e-12f});
  const auto angle = [&](float t) {
    return std::isfinite(t) ? std::atan2(t - nearest, height) : 0.5f * kPi;
  };
  return {nearest, height, angle(near), angle(far)};
}

}  // namespace

// Calls see(emitter, weight) for those that light comes from at a distance.
template <class See>
void Lights::near_emitters(const Vec3& origin, const Vec3& direction, float near, float far,
                           See&& see) const {
  if (emitters_.size() > kFewEmitters) return;
  for (const Emitter& e : emitters_) {
    if (e.lamp >= 0 && lamps_[e.lamp].s.kind == LampKind::kSun) continue;
    const Equiangular q = equiangular(e.center, e.radius, origin, direction, near, far);
    const float weight = e.importance * (q.end - q.begin) / q.height;
    if (weight > 0) see(q, weight);
  }
}

std::optional<Lights::AlongRay> Lights::sample_along(const Vec3& origin, const Vec3& direction,
                                                     float near, float far, float choice,
                                                     float u) const {
  float all = 0;
  near_emitters(origin, direction, near, far, [&](const Equiangular&, float w) { all += w; });
  if (!(all > 0)) return std::nullopt;
  float target = choice * all;
  std::optional<float> found;
  near_emitters(origin, direction, near, far, [&](const Equiangular& q, float w) {
    if (target < 0) return;
    found = q.nearest + q.height * std::tan(q.begin + (q.end - q.begin) * u);
    target -= w;
  });
  const float distance = std::clamp(*found, near, far);
  const float pdf = pdf_along(origin, direction, near, far, distance);
  if (!std::isfinite(distance) || !(pdf > 0)) return std::nullopt;
  return AlongRay{distance, pdf};
}

float Lights::pdf_along(const Vec3& origin, const Vec3& direction, float near, float far,
                        float distance) const {
  float all = 0, sum = 0;
  near_emitters(origin, direction, near, far, [&](const Equiangular& q, float w) {
    const float away = distance - q.nearest;
    all += w;
    sum += w * q.height / ((q.end - q.begin) * (q.height * q.height + away * away));
  });
  return all > 0 ? sum / all : 0;
}

}  // namespace photon_splat
