#include "fallback.h"

#include "kernel_mass.h"

namespace photon_splat {
namespace {

constexpr float kFewest = 3;    // photons in such a disc, while a whole one is to hold a hundred
constexpr float kAcross = 1.7f; // mass of a disc of radius 1 that a strip of width w crosses: 8/(3 pi) w, and the width is 2 area/perimeter

}  // namespace

bool Fallback::at(uint32_t key, const Vec3& x, uint32_t instance, uint32_t triangle, float radius_factor, RadiusMap::Memory& memory) const {
  if (!radii_) return false;
  const Instance& placed = scene_.instances[instance];
  const Topology& topology = scene_.meshes[placed.mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  const float area = topology.patch_area[patch] * placed.scale * placed.scale, rim = topology.patch_rim[patch] * placed.scale;
  const float wished = radius_factor * radii_->radius(key, x, photons_, paths_, memory);
  const float h = std::min(wished, curvature_radius_limit(scene_, instance, triangle));
  // Photons per square metre: all that the pilot saw on the patch, spread over it; or more, as the disc's radius was chosen.
  double density = radii_->photons_on_surface(memory, paths_) / std::max(double(area), 1e-30);
  if (wished < radius_factor * radii_->largest())
    density = std::max(density, photons_ * radius_factor * radius_factor / (kPi * double(wished) * wished));
  double reached = std::min(kPi * double(h) * h, double(area));
  if (rim > 0) reached = std::min(reached, kPi * double(h) * kAcross * area / rim);
  return density * reached < kFewest * radius_factor * radius_factor;  // discs of later passes are to hold fewer
}

}  // namespace photon_splat
