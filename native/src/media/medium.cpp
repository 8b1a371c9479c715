#include "media/medium.h"

#include <algorithm>

namespace photon_splat {

void MediumPoint::add_scattering(const Rgb& coefficient, const Phase& phase) {
  if (is_black(coefficient)) return;
  scattering += coefficient;
  if (count_ == kMostPhases)
    parts_[kMostPhases - 1].coefficient += coefficient;
  else
    parts_[count_++] = {coefficient, phase};
}

void MediumPoint::add(const MediumPoint& other) {
  absorption += other.absorption;
  emission += other.emission;
  for (int i = 0; i < other.count_; ++i)
    add_scattering(other.parts_[i].coefficient, other.parts_[i].phase);
}

void MediumPoint::scale(float factor) {
  absorption *= factor;
  scattering *= factor;
  emission *= factor;
  for (int i = 0; i < count_; ++i) parts_[i].coefficient *= factor;
}

Rgb MediumPoint::evaluate(const Vec3& before, const Vec3& after, float* pdf) const {
  const float cosine = std::clamp(dot(before, after), -1.0f, 1.0f), all = average(scattering);
  Rgb sum{};
  *pdf = 0;
  for (int i = 0; i < count_; ++i) {
    sum += parts_[i].coefficient * parts_[i].phase.evaluate(cosine);
    *pdf += average(parts_[i].coefficient) / all * parts_[i].phase.pdf(cosine);
  }
  return sum;
}

Vec3 MediumPoint::sample(const Vec3& before, float choice, const Vec2& u) const {
  float target = choice * average(scattering);
  int i = 0;
  for (; i + 1 < count_; ++i) {
    const float own = average(parts_[i].coefficient);
    if (target < own) break;
    target -= own;
  }
  const float cosine = count_ ? parts_[i].phase.sample_cosine(u.x) : 1 - 2 * u.x;
  return turned(before, cosine, u.y);
}

bool MediumStack::holds(uint16_t region) const {
  return std::find(begin(), end(), region) != end();
}

void MediumStack::enter(uint16_t region) {
  if (count_ < kMost && !holds(region)) at_[count_++] = region;
}

void MediumStack::leave(uint16_t region) {
  for (uint16_t i = 0; i < count_; ++i) {
    if (at_[i] != region) continue;
    for (; i + 1 < count_; ++i) at_[i] = at_[i + 1];
    --count_;
    return;
  }
}

}  // namespace photon_splat
