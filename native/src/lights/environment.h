// What lies beyond the scene: radiance by direction, drawn from in proportion to it.
#pragma once

#include "math/direction_table.h"
#include "scene/scene.h"

namespace photon_splat {

class Environment {
 public:
  // Bakes the table that directions are drawn from. Uses the scene's threads.
  explicit Environment(Scene& scene);

  bool black() const { return is_black(mean_); }
  // Radiance is the same in all directions: importance sampling gains nothing.
  bool constant() const { return table_.even() && discs_.empty(); }
  // Whether the camera, and whether rays of different kinds, see something else than radiance(),
  // which then is the most that any of these sees but the camera: a world with a Light Path node.
  bool asks_camera() const { return asks_camera_; }
  bool asks_ray() const { return kinds_.size() > 1 || asks_depth_; }
  // Whether it matters how often the ray has bounced, which nobody knows of a photon.
  bool asks_depth() const { return asks_depth_; }
  Rgb radiance(const Vec3& d, const RayInfo& ray) const;
  // What rays of that kind see, of radiance().
  Rgb share(const Vec3& d, const RayInfo& ray) const;
  // The ray that meets the world from where a photon of it is scattered first, which the camera is
  // thought to see by diffuse light.
  static RayInfo photon_ray(bool diffuse, bool transmitted, bool delta);
  // W/m^2/sr out of the direction `d` (unit, away from the scene).
  Rgb radiance(const Vec3& d) const { return hidden_ ? Rgb{} : map_radiance(d) + disc_radiance(d); }
  Rgb mean() const { return mean_; }  // over all directions

  // How densely a direction is drawn, 1/sr: by the table, within the table's patch, and as part of
  // the discs.
  struct Density {
    float table, in_patch, discs;
    int patch;
  };
  struct Sample {
    Vec3 direction;
    Density density;
    float pdf;  // solid angle
  };
  Sample sample(const Vec2& u) const;
  Density density(const Vec3& d) const { return density_in(table_.cell_of(d), d); }
  float pdf(const Density& density) const {
    return (1 - disc_share_) * density.table + density.discs;
  }
  float pdf(const Vec3& d) const { return pdf(density(d)); }

  // Directions in parts: the patches of the table, and in the last one all of the suns' discs.
  static constexpr int kDiscs = DirectionTable::kPatches, kParts = kDiscs + 1;
  int part_of(const Vec3& d) const {
    return disc_density(d) > 0 ? kDiscs : table_.patch_of(table_.cell_of(d));
  }
  // Probability with which sample() chooses this part
  float part_share(int part) const {
    return part == kDiscs ? disc_share_ : (1 - disc_share_) * table_.share(part);
  }
  Sample sample_part(int part, const Vec2& u) const;
  // Density of a direction among those from parts that are drawn with these chances, 1/sr; chance:
  // of each part.
  template <class Chance>
  float pdf_by_parts(const Chance& chance, const Density& density) const {
    return chance(density.patch) * density.in_patch +
           (density.discs > 0 ? chance(kDiscs) * density.discs / disc_share_ : 0);
  }

  // About the irradiance of an unshadowed surface, mean over RGB; n = 0: of both sides of any.
  float irradiance(const Vec3& n) const;
  // 0 for the same light from everywhere .. 1 for light from one direction: how much a drawn
  // direction is worth.
  float contrast() const { return contrast_; }

 private:
  struct Disc : SunCone {
    explicit Disc(const SunDisc& of) : SunCone(of) {}
    Rgb mean{};       // radiance
    double flux = 0;  // through a surface that faces it, mean over RGB, W/m^2
  };
  Rgb map_radiance(const Vec3& d) const;
  Rgb run(const Vec3& d, RayInfo ray, bool suns) const;
  Rgb most_of_program(const Vec3& d, bool suns) const;
  Rgb suns_of_program(const Vec3& d) const;
  void find_kinds();
  Rgb disc_radiance(const Vec3& d) const;
  void add_discs();
  void bake();
  void measure(const std::vector<Rgb>& cells, int width, int height);
  Vec3 sample_discs(const Vec2& u) const;  // u.x: below disc_share_
  Density density_in(const DirectionTable::Cell& cell, const Vec3& d) const {
    return {table_.pdf(cell), table_.pdf_in_patch(cell), discs_.empty() ? 0 : disc_density(d),
            table_.patch_of(cell)};
  }
  Sample known(const Vec3& direction, const Density& density) const {
    return {direction, density, pdf(density)};
  }
  float disc_density(const Vec3& d) const;  // of the share that the discs have of sample()'s

  Scene& scene_;
  bool hidden_;            // by a medium that fills the world
  bool straight_ = false;  // the image is looked up as directions come
  bool asks_camera_ = false, asks_depth_ = false;
  std::vector<RayInfo> kinds_;  // of a program: rays that may see something of their own
  std::vector<Disc> discs_;
  std::vector<float> disc_cdf_;  // up to the discs' share of the samples
  float disc_share_ = 0;
  DirectionTable table_;
  Rgb mean_{};
  float contrast_ = 0;
  float harmonics_[9] = {};  // of the mean over RGB
};

// Where an equirectangular image shows the direction d, as Blender maps it: u runs against the
// longitude, v from -Z up. Longitude and latitude from -Y on, of a point around the origin.
inline Vec2 sphere_uv(const Vec3& p) {
  const float l = length(p);
  if (!(l > 0)) return {};
  const float u = p.x == 0 && p.y == 0 ? 0 : 0.5f - std::atan2(p.x, p.y) / (2 * kPi);
  return {u, 1 - std::acos(std::clamp(p.z / l, -1.0f, 1.0f)) / kPi};
}

inline Vec2 equirectangular_uv(const Vec3& d) {
  return {0.5f - turn_of(d.y, d.x), 0.5f + 2 * turn_of(d.z, std::sqrt(d.x * d.x + d.y * d.y))};
}
// Image coordinates of a direction in a photographed mirror ball.
inline Vec2 mirror_ball_uv(Vec3 d) {
  d.y -= 1;
  const float scale = 2 * std::sqrt(std::max(-0.5f * d.y, 0.0f));
  return {0.5f * (1 + (scale > 0 ? d.x / scale : d.x)),
          0.5f * (1 + (scale > 0 ? d.z / scale : d.z))};
}

}  // namespace photon_splat
