// Where parallel light enters the scene: the discs across it that photons of suns and of the world
// start on.
#pragma once

#include "math/sampling.h"

namespace photon_splat {

// One disc shows all of the scene. Where what is seen is small against that, as a house on an
// endless ground is, there are smaller discs about it, each a fourth as wide as the one before. A
// disc of radius r gets photons in proportion to sqrt(r), so that their density falls as r^-3/2:
// the chance that a photon scattered at this distance comes to what is seen falls as r^-2 to r^-3,
// and variance is least where density goes as its root. The mixture's density weighs every photon,
// so that no light is lost or added.
class EmissionDiscs {
 public:
  // One disc about the bounding sphere of everything.
  EmissionDiscs(const Vec3& center, float radius) : center_(center), radius_(radius) {}

  // What is seen lies about `center`, half of it within `radius`.
  void focus(const Vec3& center, float radius);
  bool focused() const { return small_ > 0; }

  struct Place {
    Vec3 through;  // a point of the line, on the disc
    Vec3 outside;  // a point of the line before everything
    float width;   // of the disc that it was drawn from
  };
  Place sample(const Vec3& direction, const Vec2& u) const;
  // The area that a photon on this line stands for, m^2: one over the density; 0 where no photon
  // starts.
  float area(const Vec3& direction, const Vec3& on_line) const;
  // That of a photon through the middle of the smallest disc.
  double least_area() const;
  double scene_area() const { return double(kPi) * radius_ * radius_; }

  // The smallest disc's: about what is seen.
  const Vec3& seen_center() const { return small_ ? focus_ : center_; }
  float seen_radius() const { return small_ ? width_[small_ - 1] : radius_; }

  const Vec3& center() const { return center_; }
  float radius() const { return radius_; }
  // The point of a line before everything.
  Vec3 before_scene(const Vec3& direction, const Vec3& on_line) const {
    return on_line - direction * (dot(on_line - center_, direction) + radius_);
  }

 private:
  static constexpr int kMost = 16;

  Vec3 center_, focus_;
  float radius_;
  int small_ = 0;              // number of small discs
  float width_[kMost]{};       // their radii, the largest first
  float share_[kMost + 1]{1};  // of photons: of the scene's disc, then of those
};

}  // namespace photon_splat
