// What a medium does at a point, and which media a path is in.
#pragma once

#include <array>
#include <cstdint>

#include "media/phase.h"

namespace photon_splat {

// Coefficients, 1/m; emission: radiance per metre, W/m^3/sr.
class MediumPoint {
 public:
  static constexpr int kMostPhases = 8;

  Rgb absorption{}, scattering{}, emission{};

  Rgb extinction() const { return absorption + scattering; }
  // What is beyond kMostPhases goes where the last one sends it.
  void add_scattering(const Rgb& coefficient, const Phase& phase);
  void add(const MediumPoint& other);
  void scale(float factor);  // all of it

  // Scattering coefficient times phase, 1/m/sr, from `before` to `after` (ways of light or of
  // paths); *pdf: density with which sample() draws that way.
  Rgb evaluate(const Vec3& before, const Vec3& after, float* pdf) const;
  Vec3 sample(const Vec3& before, float choice, const Vec2& u) const;

 private:
  struct Part {
    Rgb coefficient;
    Phase phase;
  };
  std::array<Part, kMostPhases> parts_;
  int count_ = 0;
};

// The media around a point on a path, as places in Media::regions(). Those of surfaces that it has
// entered and not left.
class MediumStack {
 public:
  static constexpr int kMost = 7;  // nested deeper: not entered

  bool empty() const { return count_ == 0; }
  const uint16_t* begin() const { return at_.data(); }
  const uint16_t* end() const { return at_.data() + count_; }
  bool holds(uint16_t region) const;
  void enter(uint16_t region);
  void leave(uint16_t region);
  // A path goes through a surface of a region, that it met from the back or from the front.
  void cross(int region, bool back) {
    if (region < 0) return;
    back ? leave(static_cast<uint16_t>(region)) : enter(static_cast<uint16_t>(region));
  }

 private:
  std::array<uint16_t, kMost> at_{};
  uint16_t count_ = 0;
};

}  // namespace photon_splat
