// Closures of strands.
#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

enum Operand {
  kWeight,
  kColor,
  kMelanin,
  kRedness,
  kTint,
  kAbsorption,
  kRoughness,
  kRadialRoughness,
  kCoat,
  kIor,
  kOffset,
  kRandomColor,
  kRandomRoughness,
  kRandom,
  kAspectRatio,
  kMajorAxis,
  kReflection,
  kTransmission,
  kSecondaryReflection,
  kParametrization,
  kModel
};

// The random number of the strand, from -1 to 1.
float random_of(const Frame& f, const uint32_t* w) {
  return bounded(2 * f.number(w[kRandom]) - 1, 1);
}

Vec3 absorption(const Frame& f, const uint32_t* w, float around) {
  switch (Frame::mode<HairColoring>(w[kParametrization])) {
    case HairColoring::ABSORPTION: return bounded(f.vector(w[kAbsorption]), kMostScattered);
    case HairColoring::MELANIN: {
      const float random = 1 + random_of(f, w) * clamp_unit(f.number(w[kRandomColor]));
      return absorption_of_melanin(f.number(w[kMelanin]) * random,
                                   clamp_unit(f.number(w[kRedness]))) +
             absorption_of_color(f.vector(w[kTint]), around);
    }
    case HairColoring::COLOR: return absorption_of_color(f.vector(w[kColor]), around);
  }
  return {};
}

void chiang(Frame& f, const uint32_t* w, const Rgb& weight, const Vec3& normal, float random) {
  PrincipledHairInputs in;
  in.frame = hair_frame(f, {});
  in.along = f.number(w[kRoughness]) * random;
  in.around = f.number(w[kRadialRoughness]) * random;
  in.coat = f.number(w[kCoat]);
  in.ior = f.number(w[kIor]);
  in.offset = f.number(w[kOffset]);
  in.absorption = absorption(f, w, in.around);
  f.out.add_principled_hair(weight, normal, std::move(in));
}

void huang(Frame& f, const uint32_t* w, const Rgb& weight, const Vec3& normal, float random) {
  FacetHairInputs in;
  in.reflection = f.number(w[kReflection]);
  in.transmission = f.number(w[kTransmission]);
  in.secondary = f.number(w[kSecondaryReflection]);
  if (!(in.reflection > 0 || in.transmission > 0 || in.secondary > 0)) return;
  in.frame = hair_frame(f, {});
  in.roughness = f.number(w[kRoughness]) * random;
  in.ior = f.number(w[kIor]);
  in.offset = f.number(w[kOffset]);
  in.absorption = absorption(f, w, in.roughness);
  in.aspect = std::max(bounded(f.number(w[kAspectRatio]), 100), 0.01f);
  if (in.aspect != 1) in.major = strand_axis(f, f.vector(w[kMajorAxis]), in.frame.tangent);
  in.coverage = strand_coverage(f);
  in.seed = hash_of(f.point.position);
  // Curves are hit as if they were round. As in Cycles shadows are as wide, which looks at the
  // middle of a curve alone.
  if (!(std::abs(in.frame.across) < facet_hair_width(in, f.point.wo))) {
    if (f.point.ray.kind != RayInfo::kShadow) f.out.add_transparent(weight);
    return;
  }
  f.out.add_facet_hair(weight, normal, std::move(in));
}

}  // namespace

void hair(Frame& f, const Rgb& weight, const uint32_t* w) {
  const Vec3 tangent = f.vector(w[3]);
  HairInputs in;
  in.frame = hair_frame(f, tangent);
  in.frame.rounded &= w[2] & kConstant || length2(f.vector(w[2]) - f.normal()) < 1e-8f;
  in.transmits = f.mode<HairComponent>(w[7]) == HairComponent::Transmission;
  in.offset = f.strands() || length2(tangent) > 0 ? -f.number(w[4]) : 0;
  in.along = f.number(w[5]);
  in.around = f.number(w[6]);
  f.out.add_hair(weight, front_normal(f, w[2]), std::move(in));
}

void principled_hair(Frame& f, const uint32_t* w) {
  const float weight = bounded(f.number(w[kWeight]), kMostScattered);
  const float random = 1 + random_of(f, w) * clamp_unit(f.number(w[kRandomRoughness]));
  const Vec3 normal = f.point.back ? -f.normal() : f.normal();
  const auto add = f.mode<HairModel>(w[kModel]) == HairModel::HUANG ? huang : chiang;
  add(f, w, {weight, weight, weight}, normal, random);
}

}  // namespace photon_splat::nodes
