// Places on a bent patch, spread as a kernel is.
#pragma once

#include "density/kernel_mass.h"
#include "math/sampling.h"

namespace photon_splat {

// Draws places y on the patch of `triangle` about x, with the density w(n_x.n_y) K_h(|x - y|) (see
// kernel_mass.h) but for a factor that they carry as their weight. It is 1 where the transform
// stretches all of the patch alike.
class BentPlaces {
 public:
  BentPlaces(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x,
             const Vec3& normal, float h);

  struct Place {
    Vec3 position, normal;  // on the side of the patch that `normal` at x is on
    float distance2;        // from x, in h^2
    float weight;
  };
  // One draw; false: it fell through.
  bool draw(Random& random, Place& place) const;

 private:
  // A branch of the mesh's tree that is small, or a leaf; or a triangle of a leaf that is wide,
  // from the part of whose plane places are drawn that the ball about x cuts out, where that is
  // smaller. What is drawn in it has `most` of the kernel of x, at most.
  struct Piece {
    const SurfaceNode* node;  // null: a triangle
    uint32_t triangle;
    float cut;            // radius of the part of a triangle's plane; 0: all of the triangle
    float most, stretch;  // of areas by the transform
    float sum;            // of the masses up to here
  };
  struct Corners {
    Vec3 a, b, c;
  };
  Corners corners_of(uint32_t triangle) const;
  void add_triangle(uint32_t triangle, float h);
  bool place_on(const Piece& piece, Random& random, Place& place) const;
  bool place_in_cut(const Piece& piece, Random& random, Place& place) const;

  const Instance& placed_;
  const Mesh& mesh_;
  Vec3 x_, normal_;
  float inverse_h2_, side_;
  float total_ = 0;
  std::vector<Piece> pieces_;
};

}  // namespace photon_splat
