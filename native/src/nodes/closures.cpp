#include "frame.h"

namespace photon_splat::nodes {
namespace {

Distribution distribution(uint32_t word) {
  switch (Frame::mode<Microfacets>(word)) {
    case Microfacets::GGX: return Distribution::kGgx;
    case Microfacets::MULTI_GGX: return Distribution::kMultiGgx;
    case Microfacets::BECKMANN: return Distribution::kBeckmann;
  }
  return Distribution::kGgx;
}

// Nodes have normals on the side that is looked at, closures on the surface's front. Without length: the shading normal.
Vec3 front_normal(const Frame& f, uint32_t word) {
  Vec3 n = f.vector(word);
  const float l = length(n);
  n = l > 0 && std::isfinite(l) ? n / l : f.normal();
  return f.point.back ? -n : n;
}

void principled(Frame& f, const uint32_t* w) {
  enum { kWeight, kBaseColor, kMetallic, kRoughness, kIor, kAlpha, kNormal, kDiffuseRoughness, kSubsurface, kSpecular,
         kSpecularTint, kAnisotropic, kRotation, kTangent, kTransmission, kCoat, kCoatRoughness, kCoatIor, kCoatTint, kCoatNormal,
         kSheen, kSheenRoughness, kSheenTint, kEmission, kEmissionStrength, kFilm, kFilmIor, kDistribution };
  const float weight = f.number(w[kWeight]);
  PrincipledInputs p;
  p.base_color = f.vector(w[kBaseColor]);
  p.metallic = f.number(w[kMetallic]);
  p.roughness = f.number(w[kRoughness]);
  p.ior = f.number(w[kIor]);
  p.alpha = f.number(w[kAlpha]);
  p.normal = front_normal(f, w[kNormal]);
  p.diffuse_roughness = f.number(w[kDiffuseRoughness]);
  p.subsurface_weight = f.number(w[kSubsurface]);
  p.specular_level = f.number(w[kSpecular]);
  p.specular_tint = f.vector(w[kSpecularTint]);
  p.anisotropic = f.number(w[kAnisotropic]);
  p.anisotropic_rotation = f.number(w[kRotation]);
  p.tangent = f.vector(w[kTangent]);
  p.transmission_weight = f.number(w[kTransmission]);
  p.coat_weight = f.number(w[kCoat]);
  p.coat_roughness = f.number(w[kCoatRoughness]);
  p.coat_ior = f.number(w[kCoatIor]);
  p.coat_tint = f.vector(w[kCoatTint]);
  p.coat_normal = front_normal(f, w[kCoatNormal]);
  p.sheen_weight = f.number(w[kSheen]);
  p.sheen_roughness = f.number(w[kSheenRoughness]);
  p.sheen_tint = f.vector(w[kSheenTint]);
  p.emission_color = f.vector(w[kEmission]);
  p.emission_strength = f.number(w[kEmissionStrength]);
  p.thin_film_thickness = f.number(w[kFilm]);
  p.thin_film_ior = f.number(w[kFilmIor]);
  p.distribution = distribution(w[kDistribution]);
  f.out.add_principled({weight, weight, weight}, p);
}

}  // namespace

void closure(Frame& f, Op op, const uint32_t* w) {
  const float weight = f.number(w[0]);
  if (weight == 0) return;
  const auto colored = [&] { return f.vector(w[1]) * weight; };
  switch (op) {
    case Op::Emission: f.out.add_emission(colored()); break;
    case Op::Transparent: f.out.add_transparent(colored()); break;
    case Op::Holdout: f.out.add_holdout(weight); break;
    case Op::Diffuse: f.out.add_diffuse(colored(), front_normal(f, w[2]), f.number(w[3])); break;
    case Op::Translucent: f.out.add_translucent(colored(), front_normal(f, w[2])); break;
    case Op::Glossy:
      f.out.add_glossy(colored(), front_normal(f, w[2]), distribution(w[7]), f.number(w[3]), f.number(w[4]), f.number(w[5]),
                       f.vector(w[6]));
      break;
    case Op::Glass:
      f.out.add_glass(colored(), front_normal(f, w[2]), distribution(w[7]), f.number(w[3]), f.number(w[4]), f.number(w[5]),
                      f.number(w[6]));
      break;
    case Op::Refraction:
      f.out.add_refraction(colored(), front_normal(f, w[2]), distribution(w[5]), f.number(w[3]), f.number(w[4]));
      break;
    case Op::Metallic:
      f.out.add_metallic({weight, weight, weight}, front_normal(f, w[1]), distribution(w[11]), f.number(w[2]), f.number(w[3]),
                         f.number(w[4]), f.vector(w[5]), f.mode<MetallicType>(w[10]) == MetallicType::PHYSICAL_CONDUCTOR,
                         f.vector(w[6]), f.vector(w[7]), f.number(w[8]), f.number(w[9]));
      break;
    case Op::Sheen:
      f.out.add_sheen(colored(), front_normal(f, w[2]), f.number(w[3]), f.mode<SheenType>(w[4]) == SheenType::ASHIKHMIN);
      break;
    case Op::Toon:
      f.out.add_toon(colored(), front_normal(f, w[2]), f.mode<ToonType>(w[5]) == ToonType::GLOSSY, f.number(w[3]), f.number(w[4]));
      break;
    case Op::Principled: principled(f, w); break;
    default: break;
  }
}

}  // namespace photon_splat::nodes
