// How large a pixel is at places of the world, as Cycles counts it when it dices.
#pragma once

#include <array>

#include "dicing/place.h"

namespace photon_splat {

enum class EyeLens { kPerspective, kOrthographic, kPanorama };

struct EyeSettings {
  EyeLens lens = EyeLens::kPerspective;
  std::array<double, 12> to_world{};  // rows of the camera's matrix; it looks along -Z, Y up
  double left = -1, right = 1, bottom = -1, top = 1;  // on z = -1, or m of an orthographic one
  double width = 1, height = 1;                       // of the whole frame, pixels
  double angle = 0;                                   // rad, of a pixel of a panorama
  double offscreen = 1;
};

// A camera. Out of its view pixels grow with the distance from it, `offscreen` - 1 times as fast as
// they do with the distance from the camera.
class Eye {
 public:
  explicit Eye(const EyeSettings& settings);

  // m, the width of a pixel there.
  double pixel_size(const Place& world) const;

 private:
  double orthographic(const Place& seen) const;
  double out_of_view(const Place& seen) const;

  struct Side {
    Place normal, along;  // outwards; the direction in it away from the camera
  };
  EyeSettings s_;
  double pixel_ = 0;  // rad, or m of an orthographic one
  std::array<Side, 4> sides_;
};

}  // namespace photon_splat
