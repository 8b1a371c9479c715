#include "bsdf/subsurface.h"

#include "bsdf/principled.h"

namespace photon_splat {
namespace {

constexpr float kLeastRadius = 1e-8f;  // m: below it a channel is diffuse
constexpr float kMostRadius = 1e12f;

// What a surface with facets of this index reflects diffusely, by its reduced albedo (Jensen et
// al., A Practical Model for Subsurface Light Transport, 2001); `a`: 4/3 A there.
float dipole_reflectance(float albedo, float a) {
  const float s = std::sqrt(3 * (1 - albedo));
  return 0.5f * albedo * (1 + std::exp(-a * s)) * std::exp(-s);
}

float dipole_albedo(float reflectance, float ior) {
  const float inverse = 1 / ior;
  const float fresnel = -1.44f * sqr(inverse) + 0.71f * inverse + 0.668f + 0.0636f * ior;
  const float a = 4 * (1 + fresnel) / (3 * (1 - fresnel));
  if (reflectance < 1e-4f) return 0;
  if (reflectance >= 0.995f) return 0.999999f;
  float low = 0, high = 1;
  for (int i = 0; i < 12; ++i) {
    const float middle = 0.5f * (low + high);
    (dipole_reflectance(middle, a) < reflectance ? low : high) = middle;
  }
  return 0.5f * (low + high);
}

// From the radius that artists set to what the method goes by.
Rgb scaled_radius(const SubsurfaceInputs& in) {
  switch (in.method) {
    case SubsurfaceMethod::kRandomWalk: return in.radius;
    case SubsurfaceMethod::kRandomWalkSkin: {
      const auto scale = [&](float color) {
        return std::sqrt(3 * (1 - dipole_albedo(color, in.ior)));
      };
      return in.radius * Rgb{scale(in.color.x), scale(in.color.y), scale(in.color.z)};
    }
    case SubsurfaceMethod::kBurley:
    case SubsurfaceMethod::kRandomWalkLegacy: break;
  }
  return in.radius * (1 / (4 * kPi));
}

}  // namespace

void make_clean(SubsurfaceInputs& in) {
  in.color = min(clean_color(in.color), kWhite);
  in.radius = {clean(in.radius.x, 0, kMostRadius, 0), clean(in.radius.y, 0, kMostRadius, 0),
               clean(in.radius.z, 0, kMostRadius, 0)};
  in.ior = clean(in.ior, 1.01f, 3.8f, 1.4f);
  in.alpha = in.method == SubsurfaceMethod::kRandomWalkSkin ? 1 : clean(in.alpha, 0, 1, 1);
  const float forward = in.method == SubsurfaceMethod::kRandomWalk ? 0.99f : 0.9f;
  in.anisotropy = clean(in.anisotropy, -0.99f, forward, 0);
}

// Channels of no radius are diffuse, and all where the closure is not kept.
void expand_subsurface(const Rgb& weight, const SubsurfaceInputs& in, const View& view,
                       SubsurfaceUse use, LobeList& out) {
  const bool kept = use == SubsurfaceUse::kAll ||
                    (use == SubsurfaceUse::kWalks && in.method != SubsurfaceMethod::kBurley);
  const auto below = [&](float radius) { return kept && radius >= kLeastRadius ? 1.0f : 0.0f; };
  const Rgb share{below(in.radius.x), below(in.radius.y), below(in.radius.z)};
  const Vec3 n = view.turned(in.normal);
  if (share.x + share.y + share.z < 3)
    out.add([&] { return lambert_lobe(weight * (kWhite - share), n); });
  const Rgb kept_weight = weight * share;
  if (is_black(kept_weight)) return;
  out.add_below({kept_weight, in.color, scaled_radius(in), valid_reflection(view, n), in.ior,
                 in.alpha, in.anisotropy, in.method});
}

}  // namespace photon_splat
