// Strands as rough dielectric cylinders of elliptical cross-section: Huang, Hullin and Hanika 2022,
// "A Microfacet-based Hair Scattering Model".
#pragma once

#include "bsdf/hair/hair.h"

namespace photon_splat {

struct FacetHairInputs {
  HairFrame frame;
  Vec3 absorption;         // per half the major axis, which is the strand's radius
  Vec3 major;              // along the major axis, of any length; 0: any direction
  float roughness = 0.3f;  // alpha of GGX
  float aspect = 1;        // minor over major axis; more than 1: `major` is along the minor one
  float offset = 0;        // of the cuticle's scales, rad
  float ior = 1.55f;
  // Factors of light that is reflected, that goes through, and that is reflected inside once
  float reflection = 1, transmission = 1, secondary = 1;
  // Half the width of what is looked at at once, over the strand's radius. From 1 on the strand is
  // seen as a whole, wherever it is met.
  float coverage = 1;
  uint32_t seed = 0;  // another for each hit
};

// What a lobe keeps of it, seen from wo. Coordinates: X along the major axis (of circles: across
// the strand and wo), Y along the strand.
//
// No closed form is known of light that facets scatter more than once. The lobe draws some paths
// of light through the strand, from `seed`, up to the facet that each leaves by. Over that facet it
// is integrated: the lobe has an exact density. In the mean over seeds it is the model.
struct FacetHairShape {
  static constexpr int kMostPaths = 16;
  Vec3 x, y, z;
  Vec3 wo;
  Vec3 absorption;
  float alpha, aspect, ior, tilt;
  float factor[3];
  float width;           // seen from wo, over that of the major axis
  float h_begin, h_end;  // where it is met, -1 to 1 over that width
  int paths;
  uint32_t seed;
};

// The width of an ellipse seen from wo, over that of its major axis. `aspect`, `major` as above.
float facet_hair_width(const FacetHairInputs& in, const Vec3& wo);

// All inputs finite and in range.
Lobe facet_hair_lobe(const View& view, const Vec3& weight, const Vec3& n,
                     const FacetHairInputs& in);

}  // namespace photon_splat
