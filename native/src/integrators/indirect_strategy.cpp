#include "integrators/indirect_strategy.h"

#include "density/bent_occlusion.h"
#include "density/kernel_mass.h"

namespace photon_splat {
namespace {

constexpr float kFewest = 2;    // photons in such a disc, while a whole one is to hold a hundred
constexpr uint32_t kLooks = 6;  // for things that stand in discs, in a region
// Mass of a disc of radius 1 that a strip of width w crosses: 8/(3 pi) w, and the width is 2
// area/perimeter
constexpr float kAcross = 1.7f;

}  // namespace

bool IndirectStrategy::bent(uint32_t instance, uint32_t triangle) const {
  return !scene_.is_planar(instance, triangle);
}

float IndirectStrategy::disc_radius(uint32_t key, const Vec3& x, uint32_t instance,
                                    uint32_t triangle, float radius_factor,
                                    RadiusMap::Memory& memory) const {
  return std::min(radius_factor * radii_->radius(key, x, photons_, paths_, memory),
                  curvature_radius_limit(scene_, instance, triangle));
}

IndirectStrategy::Look IndirectStrategy::look_at(const Place& place,
                                                 RadiusMap::Memory& memory) const {
  Look look{place, 0};
  if (!bent(place.instance, place.triangle)) return look;
  look.h = disc_radius(place.key, place.position, place.instance, place.triangle, 1, memory);
  look.region = ClearRegions::region(place.key, place.position, look.h);
  return look;
}

void IndirectStrategy::see_crowds(std::vector<Look>& looks, ThreadPool& pool,
                                  const CancelFlag& cancel) {
  std::erase_if(looks, [&](const Look& look) {
    return !(look.h > 0) || crowded_.count(look.region) || looked_.count(look.region) >= kLooks ||
           looked_.add(look.region) > kLooks;
  });
  pool.for_parts(looks.size(), 64, cancel, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Look& look = looks[i];
      look.crowded =
          stands_in_bent_disc(scene_, look.place.instance, look.place.triangle, look.place.key,
                              look.place.position, look.place.normal, look.h);
    }
  });
  for (const Look& look : looks)
    if (look.crowded) crowded_.add(look.region);
}

bool IndirectStrategy::too_close(float way, uint32_t key, const Vec3& x, uint32_t instance,
                                 uint32_t triangle, float radius_factor,
                                 RadiusMap::Memory& memory) const {
  return radii_ && way < disc_radius(key, x, instance, triangle, radius_factor, memory);
}

bool IndirectStrategy::at(uint32_t key, const Vec3& x, uint32_t instance, uint32_t triangle,
                          float radius_factor, RadiusMap::Memory& memory) const {
  if (kind_ == Kind::kPathTraced) return true;
  if (!radii_) return false;
  if (!crowded_.empty() && bent(instance, triangle) &&
      crowded_.count(
          ClearRegions::region(key, x, disc_radius(key, x, instance, triangle, 1, memory))))
    return true;
  const Instance& placed = scene_.instances[instance];
  const Topology& topology = scene_.meshes[placed.mesh].topology;
  const uint32_t patch = topology.patch[triangle];
  const float area = topology.patch_area[patch] * placed.scale * placed.scale,
              rim = topology.patch_rim[patch] * placed.scale;
  const float h = disc_radius(key, x, instance, triangle, radius_factor, memory);
  // Photons per square metre: all that the pilot saw on the patch, spread over it; or more, as it
  // saw them near by.
  const double density =
      std::max(radii_->photons_on_surface(memory, paths_) / std::max(double(area), 1e-30),
               radii_->density(memory, paths_));
  double reached = std::min(kPi * double(h) * h, double(area));
  if (rim > 0) reached = std::min(reached, kPi * double(h) * kAcross * area / rim);
  // Discs of later passes are to hold fewer
  return density * reached < kFewest * radius_factor * radius_factor;
}

}  // namespace photon_splat
