// The kernel's mass on bent patches.
#pragma once

#include "density/edge_mass.h"
#include "scene/scene.h"

namespace photon_splat {

// As a sum over the patch's triangles about x: branches of the mesh's tree that lie wholly within a
// ball in one piece, since the kernel is a polynomial there; small ones on its rim in one piece
// too, the others triangle by triangle.
Masses bent_mass(const Scene& scene, uint32_t instance, uint32_t triangle, const Vec3& x,
                 const Vec3& normal, float h);

// A patch has one side towards the viewer: 1 where `normal`, at a place of `triangle`, is on the
// front of its triangles in world space, -1 on their back.
float side_of_patch(const Instance& placed, const Mesh& mesh, uint32_t triangle,
                    const Vec3& normal);

}  // namespace photon_splat
