// How strands scatter: light that is reflected by them or goes through them, as a closure sees it
// from one direction.
#pragma once

#include "math/vec.h"

namespace photon_splat {

struct Lobe;
struct View;

// The frame of a strand at a closure. Seen from the direction that light leaves in, the strand is
// met as far to the other side: as a mirror would have it, and as likely as any other place.
struct HairFrame {
  Vec3 tangent;      // unit, towards the tip
  float across = 0;  // from -1 to 1 over its width: sine of the angle to the middle that faces wo
  bool rounded = false;  // normals follow from it; else the closure's own
};

// Hair BSDF: one of its two components.
struct HairInputs {
  HairFrame frame;
  bool transmits = false;
  float offset = 0;                // rad
  float along = 0.1f, around = 1;  // roughness
};

// Chiang et al. 2016, "A practical and controllable hair and fur model for production path
// tracing": light that is reflected, that goes through, that is reflected inside once, and more
// often.
struct PrincipledHairInputs {
  HairFrame frame;
  Vec3 absorption;  // per radius of the strand
  float along = 0.3f, around = 0.3f, coat = 0;
  float offset = 0;  // of the cuticle's scales, rad
  float ior = 1.55f;
};

// What a lobe keeps of one of them, seen from wo. In its frame X runs along the strand, Y stands
// across it and wo, Z completes both.
struct HairShape {
  static constexpr int kModes = 4;
  Vec3 x, y, z;
  // Of the angle along of wo, as each mode sees it: the first three with the scales' tilt added
  float sin_o[kModes], cos_o[kModes];
  float variance[kModes];  // of the logistic lobes along
  float scale;             // of that around
  float turn[3];           // of the way around, by each mode but the last
  Vec3 attenuation[kModes];
  float pick[kModes];
};

// Absorption that gives a strand this colour; and that of its pigments.
Vec3 absorption_of_color(const Vec3& color, float around);
Vec3 absorption_of_melanin(float melanin, float redness);

// All inputs finite and in range.
Lobe hair_lobe(const View& view, const Vec3& weight, const Vec3& n, const HairInputs& in);
Lobe principled_hair_lobe(const View& view, const Vec3& weight, const Vec3& n,
                          const PrincipledHairInputs& in);

}  // namespace photon_splat
