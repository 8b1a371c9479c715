// What the film shows where there are shadow catchers, as Cycles has it: the things in front over
// the world, which is as much darker as a catcher there is.
#pragma once

#include <algorithm>

#include "film/film.h"

namespace photon_splat {

struct Rgba {
  Rgb color;
  float alpha;
};

// A catcher's light over what it were without other things, which may be more; 1 where there is
// none.
inline Rgb caught_shadow(const Pixel& p) {
  const auto ratio = [](float all, float alone) { return alone != 0 ? all / alone : 1; };
  const float alpha = std::clamp((p.alpha + p.caught_alpha) * p.share(), 0.0f, 1.0f);
  const Rgb shadow{ratio(p.caught.x, p.caught_alone.x), ratio(p.caught.y, p.caught_alone.y),
                   ratio(p.caught.z, p.caught_alone.z)};
  return Rgb{1, 1, 1} * (1 - alpha) + shadow * alpha;
}

// The picture, catchers included. `transparent`: the camera does not see the world; else all of it
// is opaque.
inline Rgba with_shadow(const Pixel& p, const Rgb& light, bool transparent) {
  const float shown = std::clamp(average(caught_shadow(p)), 0.0f, 1.0f);
  if (!transparent) return {light + p.backdrop * (p.share() * shown), 1};
  const float alpha = std::clamp(p.alpha * p.share(), 0.0f, 1.0f);
  return {light, (1 - alpha) * (1 - shown) + alpha};
}

}  // namespace photon_splat
