// How long edges are, in units of the wanted length.
#pragma once

#include <optional>

#include "dicing/eye.h"

namespace photon_splat {

// Edges of `length` pixels of `eye` of a mesh that stands by `to_world`; without an eye of so many
// units of the mesh's own.
struct WantedEdges {
  double length = 1;
  std::optional<Eye> eye;
  std::array<double, 12> to_world{};

  // m in the world, or the mesh's own units.
  double size_at(const Place& place) const {
    return eye ? std::max(length * eye->pixel_size(in_world(place)), kLeast)
               : std::max(length, kLeast);
  }

  // Of an edge whose ends have these sizes; 1: as wanted.
  double length_of(const Place& from, const Place& to, double from_size, double to_size) const {
    double size = 0.5 * (from_size + to_size);
    if (!eye) return photon_splat::length(to - from) / size;
    const Place a = in_world(from), way = in_world(to) - a;
    const double metres = photon_splat::length(way);
    // Where a pixel is not the same all along the smallest one counts.
    if (metres > kUneven * size) {
      double least = eye->pixel_size(a);
      for (const double along : {0.25, 0.5, 0.75, 1.0})
        least = std::min(least, eye->pixel_size(a + way * along));
      size = std::max(length * least, kLeast);
    }
    return metres / size;
  }

 private:
  static constexpr double kLeast = 1e-30;
  // An edge of more times its wanted length is looked at in several places.
  static constexpr double kUneven = 30;

  Place in_world(const Place& p) const {
    const auto& m = to_world;
    return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
            m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
            m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
  }
};

}  // namespace photon_splat
