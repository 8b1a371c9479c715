// Where on a ray through a medium the light of near lights is scattered.
#include "lights/lights.h"

namespace photon_splat {
namespace {

constexpr size_t kMostAlong = 32;  // emitters that a ray asks

struct Stretch {
  float from, to;
};

// Where a ray is within the cone of a spot, from wherever in the lamp that is seen.
Stretch within_cone(const Lamp& lamp, const Vec3& origin, const Vec3& direction, Stretch s) {
  const float c = lamp.cos_half;
  if (!(c > 0.01f && c < 1)) return s;  // half of the world, or more of it
  const auto local = [&](const Vec3& v) {
    return Vec3{dot(v, lamp.axis_x) / lamp.scale_x, dot(v, lamp.axis_y) / lamp.scale_y,
                dot(v, lamp.forward) / lamp.scale_z};
  };
  const float radius = lamp.s.radius / std::min({lamp.scale_x, lamp.scale_y, lamp.scale_z});
  const Vec3 d = local(direction);
  Vec3 q = local(origin - lamp.center);
  q.z += radius / std::sqrt(1 - c * c);
  const auto z = [&](float t) { return q.z + t * d.z; };
  const auto inside = [&](float t) {
    const Vec3 p = q + d * t;
    return p.z > 0 && p.z * p.z >= c * c * length2(p);
  };
  const double a = double(d.z) * d.z - double(c) * c * length2(d),
               b = double(d.z) * q.z - double(c) * c * dot(d, q),
               e = double(q.z) * q.z - double(c) * c * length2(q), root = b * b - a * e;
  const bool starts_inside = inside(s.from);
  float ends[2];
  int count = 0;
  if (root > 0 && a != 0)
    for (const double t : {(-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a})
      if (t > s.from && t < s.to && z(static_cast<float>(t)) > 0)
        ends[count++] = static_cast<float>(t);
  if (count == 2 && ends[1] < ends[0]) std::swap(ends[0], ends[1]);
  if (starts_inside) return {s.from, count > 0 ? ends[0] : s.to};
  if (count == 0) return {s.from, s.from};
  return {ends[0], count > 1 ? ends[1] : s.to};
}

// The part of the stretch that lies before an area lamp.
Stretch in_front(const Lamp& lamp, const Vec3& origin, const Vec3& direction, Stretch s) {
  const float height = dot(origin - lamp.center, lamp.forward), rise = dot(direction, lamp.forward);
  if (rise == 0) return height > 0 ? s : Stretch{s.from, s.from};
  const float crossing = -height / rise;
  return rise > 0 ? Stretch{std::clamp(crossing, s.from, s.to), s.to}
                  : Stretch{s.from, std::clamp(crossing, s.from, s.to)};
}

// Samples distances along a ray so that the angle about a centre is uniform (equiangular sampling).
struct Equiangular {
  float nearest, height, begin, end;  // distance along the ray and from it; angles
  Stretch of;
};

Equiangular equiangular(const Vec3& center, float radius, const Vec3& origin, const Vec3& direction,
                        Stretch s) {
  const Vec3 to = center - origin;
  const float nearest = dot(to, direction);
  const float height = std::max(
      {length(to - direction * nearest), 0.5f * radius, 1e-5f * std::abs(nearest), 1e-12f});
  const auto angle = [&](float t) {
    return std::isfinite(t) ? std::atan2(t - nearest, height) : 0.5f * kPi;
  };
  return {nearest, height, angle(s.from), angle(s.to), s};
}

}  // namespace

// The strongest of those that light comes from at a distance.
void Lights::choose_along() {
  along_.clear();
  for (uint32_t i = 0; i < emitters_.size(); ++i) {
    const Emitter& e = emitters_[i];
    if (e.lamp < 0 || lamps_[e.lamp].s.kind != LampKind::kSun) along_.push_back(i);
  }
  if (along_.size() <= kMostAlong) return;
  std::stable_sort(along_.begin(), along_.end(), [&](uint32_t a, uint32_t b) {
    return emitters_[a].importance > emitters_[b].importance;
  });
  along_.resize(kMostAlong);
}

// Calls see(how, weight) for those whose light a ray meets.
template <class See>
void Lights::near_emitters(const Vec3& origin, const Vec3& direction, float near, float far,
                           See&& see) const {
  for (const uint32_t i : along_) {
    const Emitter& e = emitters_[i];
    const Lamp* const lamp = e.lamp >= 0 ? &lamps_[e.lamp] : nullptr;
    Stretch lit{near, far};
    if (lamp && lamp->s.kind == LampKind::kSpot)
      lit = within_cone(*lamp, origin, direction, lit);
    else if (lamp && lamp->s.kind == LampKind::kArea)
      lit = in_front(*lamp, origin, direction, lit);
    if (!(lit.from < lit.to)) continue;
    const Equiangular q = equiangular(e.center, e.radius, origin, direction, lit);
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
    found = std::clamp(q.nearest + q.height * std::tan(q.begin + (q.end - q.begin) * u), q.of.from,
                       q.of.to);
    target -= w;
  });
  const float distance = *found;
  const auto pdf = pdf_along(origin, direction, near, far, distance);
  if (!std::isfinite(distance) || !pdf || !(*pdf > 0)) return std::nullopt;
  return AlongRay{distance, *pdf};
}

std::optional<float> Lights::pdf_along(const Vec3& origin, const Vec3& direction, float near,
                                       float far, float distance) const {
  float all = 0, sum = 0;
  near_emitters(origin, direction, near, far, [&](const Equiangular& q, float w) {
    const float away = distance - q.nearest;
    all += w;
    if (distance < q.of.from || distance > q.of.to) return;
    sum += w * q.height / ((q.end - q.begin) * (q.height * q.height + away * away));
  });
  if (!(all > 0)) return std::nullopt;
  return sum / all;
}

}  // namespace photon_splat
