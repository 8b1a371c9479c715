// Triangles halved at their edges until these are short: every edge is judged by itself, so that
// neighbours agree and no crack opens.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "dicing/measure.h"
#include "geometry/topology.h"
#include "math/sampling.h"
#include "util/large_pages.h"
#include "util/parallel.h"

namespace photon_splat {

using PlacesOfCorners = std::array<Vec2, 3>;

// Parts of the triangles, or quads, of a mesh.
struct Pieces {
  // Edges that are longer than this times the wanted length: the half is then nearer to it.
  static constexpr double kHalvedAbove = 1.4142135623730951;

  LargeArray<Place> positions;
  LargeArray<Triangle> triangles;
  LargeArray<uint32_t> source;         // which each is part of
  LargeArray<PlacesOfCorners> places;  // where in it the corners are

  // Halves edges at most `rounds` times, until they are about as long as wanted, and tells whether
  // they are or the rounds are used up: no more than `limit` triangles are made, where the longest
  // edges are halved first. `go_on` is called now and then, and may throw.
  bool halve(const WantedEdges& wanted, unsigned rounds, size_t limit, ThreadPool& pool,
             const std::function<void()>& go_on);

  // Gives vertices the order in which triangles name them, so that what is near in space is so in
  // memory, and drops those that no triangle has. Returns the first corner (of 3 T) at each.
  LargeArray<uint32_t> sort_by_use();
};

// Of each corner, or of those of `corners` (none: all of them), what lies between the values
// (K each) at the 3 corners of the triangles, or 4 of the quads, that the pieces are parts of;
// `out`: K for each.
void mix(const Pieces& pieces, std::span<const float> known, bool quads, size_t components,
         const LargeArray<uint32_t>* corners, float* out, ThreadPool& pool);

// Makes them unit directions; +Z where they are none.
void make_unit(std::span<Vec3> directions, ThreadPool& pool);

// Unit normals of the vertices, means of the triangles' by their areas; +Z where there is none.
LargeArray<Vec3> normals_by_area(std::span<const Vec3> positions,
                                 std::span<const Triangle> triangles);

}  // namespace photon_splat
