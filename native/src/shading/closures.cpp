#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

Distribution distribution(uint32_t word) {
  switch (Frame::mode<Microfacets>(word)) {
    case Microfacets::GGX: return Distribution::kGgx;
    case Microfacets::MULTI_GGX: return Distribution::kMultiGgx;
    case Microfacets::BECKMANN: return Distribution::kBeckmann;
    case Microfacets::ASHIKHMIN_SHIRLEY: return Distribution::kAshikhminShirley;
  }
  return Distribution::kGgx;
}

constexpr float kMostEmitted = 1e16f;

SubsurfaceMethod method(uint32_t word) {
  switch (Frame::mode<SubsurfaceFalloff>(word)) {
    case SubsurfaceFalloff::BURLEY: return SubsurfaceMethod::kBurley;
    case SubsurfaceFalloff::RANDOM_WALK: return SubsurfaceMethod::kRandomWalk;
    case SubsurfaceFalloff::RANDOM_WALK_LEGACY: return SubsurfaceMethod::kRandomWalkLegacy;
    case SubsurfaceFalloff::RANDOM_WALK_SKIN: return SubsurfaceMethod::kRandomWalkSkin;
  }
  return SubsurfaceMethod::kRandomWalk;
}

void principled(Frame& f, const uint32_t* w) {
  enum {
    kWeight,
    kBaseColor,
    kMetallic,
    kRoughness,
    kIor,
    kAlpha,
    kNormal,
    kDiffuseRoughness,
    kSubsurface,
    kSpecular,
    kSpecularTint,
    kAnisotropic,
    kRotation,
    kTangent,
    kTransmission,
    kCoat,
    kCoatRoughness,
    kCoatIor,
    kCoatTint,
    kCoatNormal,
    kSheen,
    kSheenRoughness,
    kSheenTint,
    kEmission,
    kEmissionStrength,
    kFilm,
    kFilmIor,
    kDistribution,
    kSubsurfaceRadius,
    kSubsurfaceScale,
    kSubsurfaceIor,
    kSubsurfaceAnisotropy,
    kSubsurfaceMethod,
    kThinWall
  };
  const float weight = bounded(f.number(w[kWeight]), kMostScattered);
  PrincipledInputs p;
  p.base_color = bounded(f.vector(w[kBaseColor]), kMostScattered);
  p.metallic = f.number(w[kMetallic]);
  p.roughness = f.number(w[kRoughness]);
  p.ior = f.number(w[kIor]);
  p.alpha = f.number(w[kAlpha]);
  p.normal = front_normal(f, w[kNormal]);
  p.diffuse_roughness = f.number(w[kDiffuseRoughness]);
  p.subsurface_weight = f.number(w[kSubsurface]);
  if (p.subsurface_weight > 0) {
    p.subsurface.method = method(w[kSubsurfaceMethod]);
    p.subsurface.radius = f.vector(w[kSubsurfaceRadius]) * f.number(w[kSubsurfaceScale]);
    p.subsurface.ior = f.number(w[kSubsurfaceIor]);
    p.subsurface.anisotropy = f.number(w[kSubsurfaceAnisotropy]);
  }
  p.thin_wall = f.number(w[kThinWall]) != 0;
  p.specular_level = f.number(w[kSpecular]);
  p.specular_tint = bounded(f.vector(w[kSpecularTint]), kMostScattered);
  p.anisotropic = f.number(w[kAnisotropic]);
  p.anisotropic_rotation = f.number(w[kRotation]);
  p.tangent = f.vector(w[kTangent]);
  p.transmission_weight = f.number(w[kTransmission]);
  p.coat_weight = f.number(w[kCoat]);
  if (p.coat_weight > 0) {
    p.coat_roughness = f.number(w[kCoatRoughness]);
    p.coat_ior = f.number(w[kCoatIor]);
    p.coat_tint = bounded(f.vector(w[kCoatTint]), 100);  // it is raised to powers
    p.coat_normal = front_normal(f, w[kCoatNormal]);
  }
  p.sheen_weight = f.number(w[kSheen]);
  if (p.sheen_weight > 0) {
    p.sheen_roughness = f.number(w[kSheenRoughness]);
    p.sheen_tint = bounded(f.vector(w[kSheenTint]), kMostScattered);
  }
  p.emission_color = bounded(f.vector(w[kEmission]), 1e5f);
  p.emission_strength = bounded(f.number(w[kEmissionStrength]), 1e10f);
  p.thin_film_thickness = f.number(w[kFilm]);
  p.thin_film_ior = f.number(w[kFilmIor]);
  p.distribution = distribution(w[kDistribution]);
  f.out.add_principled({weight, weight, weight}, std::move(p));
}

}  // namespace

void bent_normal(Frame& f, const uint32_t* w) {
  const Vec3 n = f.vector(w[1]);
  const float l = length(n);
  if (!(l > 0 && std::isfinite(l))) return;
  f.ns = n / l;
  f.knows_object_normal = false;
  f.out.set_bent_normal(f.ns);
}

void closure(Frame& f, Op op, const uint32_t* w) {
  const float weight = f.number(w[0]);
  if (weight == 0) return;
  const auto colored = [&] { return bounded(f.vector(w[1]) * weight, kMostScattered); };
  // Tints light scattered more than once
  const auto color = [&] { return bounded(f.vector(w[1]), kMostScattered); };
  switch (op) {
    case Op::Emission: f.out.add_emission(bounded(f.vector(w[1]) * weight, kMostEmitted)); break;
    case Op::Transparent: f.out.add_transparent(colored()); break;
    case Op::Holdout: f.out.add_holdout(bounded(weight, 1)); break;
    case Op::Diffuse: {
      const Rgb tint = color();
      f.out.add_diffuse(colored(), front_normal(f, w[2]), f.number(w[3]), &tint);
      break;
    }
    case Op::Translucent: f.out.add_translucent(colored(), front_normal(f, w[2])); break;
    case Op::Glossy: {
      const Rgb tint = color();
      f.out.add_glossy(colored(), front_normal(f, w[2]), distribution(w[7]), f.number(w[3]),
                       f.number(w[4]), f.number(w[5]), f.vector(w[6]), &tint);
      break;
    }
    case Op::Glass: {
      const Rgb tint = color();
      f.out.add_glass(colored(), front_normal(f, w[2]), distribution(w[7]), f.number(w[3]),
                      f.number(w[4]), f.number(w[5]), f.number(w[6]), &tint);
      break;
    }
    case Op::Refraction:
      f.out.add_refraction(colored(), front_normal(f, w[2]), distribution(w[5]), f.number(w[3]),
                           f.number(w[4]));
      break;
    case Op::Metallic:
      f.out.add_metallic(bounded({weight, weight, weight}, kMostScattered), front_normal(f, w[1]),
                         distribution(w[11]), f.number(w[2]), f.number(w[3]), f.number(w[4]),
                         f.vector(w[5]),
                         f.mode<MetallicType>(w[10]) == MetallicType::PHYSICAL_CONDUCTOR,
                         bounded(f.vector(w[6]), kMostScattered),
                         bounded(f.vector(w[7]), kMostScattered), f.number(w[8]), f.number(w[9]));
      break;
    case Op::Sheen:
      f.out.add_sheen(colored(), front_normal(f, w[2]), f.number(w[3]),
                      f.mode<SheenType>(w[4]) == SheenType::ASHIKHMIN);
      break;
    case Op::Toon:
      f.out.add_toon(colored(), front_normal(f, w[2]), f.mode<ToonType>(w[5]) == ToonType::GLOSSY,
                     f.number(w[3]), f.number(w[4]));
      break;
    case Op::Subsurface: {
      SubsurfaceInputs in;
      in.method = method(w[8]);
      in.color = color();
      in.normal = front_normal(f, w[2]);
      in.radius = f.vector(w[3]) * f.number(w[4]);
      in.ior = f.number(w[5]);
      in.alpha = f.number(w[6]);
      in.anisotropy = f.number(w[7]);
      f.out.add_subsurface(colored(), std::move(in));
      break;
    }
    case Op::Hair: hair(f, colored(), w); break;
    case Op::PrincipledHair: principled_hair(f, w); break;
    case Op::Principled: principled(f, w); break;
    default: break;
  }
}

}  // namespace photon_splat::nodes
