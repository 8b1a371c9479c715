// Where on a ray through a medium the light of near lights is scattered.
#include <array>

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

}  // namespace

// How a ray through a medium passes an emitter, for distances whose angles about that are even
// (equiangular sampling).
struct AlongWay {
  float nearest, height;  // distance along the ray where it comes nearest, and from it there
  float begin, angle;     // of the first one that may be drawn, from there; of all of them
  Stretch of;
  float weight = 0;

  float distance(float u) const {
    return std::clamp(nearest + height * std::tan(begin + angle * u), of.from, of.to);
  }
  float pdf(float distance) const {
    if (distance < of.from || distance > of.to) return 0;
    return height / (angle * (sqr(height) + sqr(distance - nearest)));
  }
};

namespace {

float angle_of(float y, float x) { return 2 * kPi * turn_of(y, x); }

AlongWay way_past(const Vec3& center, float radius, const Vec3& origin, const Vec3& direction,
                  Stretch s) {
  const Vec3 to = center - origin;
  const float nearest = dot(to, direction);
  const float height = std::max(
      {length(to - direction * nearest), 0.5f * radius, 1e-5f * std::abs(nearest), 1e-12f});
  const float begin = angle_of(s.from - nearest, height);
  // Exact however narrow
  const float y = (s.to - s.from) * height, x = sqr(height) + (s.from - nearest) * (s.to - nearest);
  const float angle = std::isfinite(y) && std::isfinite(x) ? angle_of(y, x) : 0.5f * kPi - begin;
  return {nearest, height, begin, angle, s};
}

float pdf_of(std::span<const AlongWay> ways, float distance) {
  float all = 0, sum = 0;
  for (const AlongWay& way : ways) {
    all += way.weight;
    sum += way.weight * way.pdf(distance);
  }
  return sum / all;
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

// Those whose light the ray meets.
std::span<const AlongWay> Lights::ways_to_emitters(const Vec3& origin, const Vec3& direction,
                                                   float near, float far,
                                                   std::span<AlongWay> room) const {
  size_t count = 0;
  for (const uint32_t i : along_) {
    const Emitter& e = emitters_[i];
    const Lamp* const lamp = e.lamp >= 0 ? &lamps_[e.lamp] : nullptr;
    Stretch lit{near, far};
    if (lamp && lamp->s.kind == LampKind::kSpot)
      lit = within_cone(*lamp, origin, direction, lit);
    else if (lamp && lamp->s.kind == LampKind::kArea)
      lit = in_front(*lamp, origin, direction, lit);
    if (!(lit.from < lit.to)) continue;
    AlongWay way = way_past(e.center, e.radius, origin, direction, lit);
    way.weight = e.importance * way.angle / way.height;
    if (way.weight > 0) room[count++] = way;
  }
  return room.first(count);
}

std::optional<Lights::AlongRay> Lights::sample_along(const Vec3& origin, const Vec3& direction,
                                                     float near, float far, float choice,
                                                     float u) const {
  std::array<AlongWay, kMostAlong> ways;
  const std::span<const AlongWay> met = ways_to_emitters(origin, direction, near, far, ways);
  float all = 0;
  for (const AlongWay& way : met) all += way.weight;
  if (!(all > 0)) return std::nullopt;
  float target = choice * all;
  const AlongWay* drawn = &met.front();
  for (const AlongWay& way : met) {
    if (target < 0) break;
    drawn = &way;
    target -= way.weight;
  }
  const float distance = drawn->distance(u);
  if (!std::isfinite(distance)) return std::nullopt;
  const float pdf = pdf_of(met, distance);
  if (!(pdf > 0)) return std::nullopt;
  return AlongRay{distance, pdf};
}

std::optional<float> Lights::pdf_along(const Vec3& origin, const Vec3& direction, float near,
                                       float far, float distance) const {
  std::array<AlongWay, kMostAlong> ways;
  const auto met = ways_to_emitters(origin, direction, near, far, ways);
  if (met.empty()) return std::nullopt;
  return pdf_of(met, distance);
}

}  // namespace photon_splat
