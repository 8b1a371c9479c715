// What the lobes of a surface are together, for passes, the denoiser and chances.
#include "bsdf/bsdf.h"

namespace photon_splat {
namespace {

Vec3 unit_or(const Vec3& sum, const Vec3& otherwise) {
  const float len = length(sum);
  return len > 0 && std::isfinite(len) ? sum / len : otherwise;
}

// Directional, about.
Rgb albedo_of(const Lobe& lobe) {
  return lobe.of_facets() || lobe.kind >= LobeKind::kPrincipledHair ? lobe.scale * lobe.layer
                                                                    : lobe.weight;
}

}  // namespace

bool Bsdf::transmits() const {
  for (const Lobe& lobe : lobes_) {
    if (lobe.pick <= 0) continue;
    if (lobe.transmits()) return true;
  }
  return false;
}

bool Bsdf::scatters() const {
  if (lobes_.below_count() > 0) return true;
  for (const Lobe& lobe : lobes_)
    if (lobe.pick > 0) return true;
  return false;
}

bool Bsdf::only_delta() const {
  for (const Lobe& lobe : lobes_)
    if (lobe.pick > 0 && !lobe.delta()) return false;
  return scatters();
}

Rgb Bsdf::below_weight() const {
  Rgb sum{};
  for (int i = 0; i < below_count(); ++i) sum += below(i).weight;
  return sum;
}

bool Bsdf::has_rest() const { return rest_; }

Rgb Bsdf::albedo() const { return below_weight() + sharp_albedo(1); }

Rgb Bsdf::sharp_albedo(float roughness) const {
  Rgb sum{};
  for (const Lobe& lobe : lobes_)
    if (roughness >= 1 || lobe.roughness() <= roughness) sum += albedo_of(lobe);
  return sum;
}

Bsdf::Colors Bsdf::colors() const {
  Colors sum;
  for (const Lobe& lobe : lobes_) {
    if (lobe.diffuse()) continue;
    const Rgb albedo = albedo_of(lobe);
    if (lobe.kind >= LobeKind::kPrincipledHair) {
      sum.glossy += albedo;
      sum.transmission += albedo;
      continue;
    }
    const bool passes =
        lobe.kind == LobeKind::kThinFacets || lobe.kind == LobeKind::kHairTransmission;
    const Rgb reflected = passes                           ? Rgb{}
                          : lobe.kind == LobeKind::kFacets ? albedo * reflected_share(lobe)
                                                           : albedo;
    sum.glossy += reflected;
    sum.transmission += albedo - reflected;
  }
  return sum;
}

Vec3 Bsdf::mean_normal() const {
  Vec3 sum{};
  for (const Lobe& lobe : lobes_) sum += lobe.n * lobe.albedo;
  for (int i = 0; i < below_count(); ++i) sum += below(i).n * average(below(i).weight);
  return unit_or(sum, view_.ns);
}

Vec3 Bsdf::mean_diffuse_normal() const {
  Vec3 sum{};
  for (const Lobe& lobe : lobes_)
    if (lobe.diffuse()) sum += lobe.n * average(lobe.weight);
  return unit_or(sum, view_.ns);
}

Rgb Bsdf::diffuse_albedo() const {
  Rgb sum = below_weight();
  for (const Lobe& lobe : lobes_)
    if (lobe.diffuse()) sum += albedo_of(lobe);
  return sum;
}

}  // namespace photon_splat
