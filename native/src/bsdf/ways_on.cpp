// Light of photons that goes on where viewers see other closures than it does.
#include "bsdf/bsdf.h"
#include "bsdf/turned_glass.h"

namespace photon_splat {
namespace {

// Of the samples at a surface whose sides may differ: by rough boundaries as the other side has
// them, or anywhere on that side; the latter beside the former.
constexpr float kSentThrough = 0.25f, kSentAnywhere = 0.1f;

}  // namespace

void Bsdf::send_through(const Bsdf& other) {
  const auto refracts = [](const Lobe& lobe) {
    return lobe.of_facets() && lobe.transmits() && !lobe.delta() && lobe.pick > 0;
  };
  float all = 0;
  for (const Lobe& lobe : other.lobes_) all += refracts(lobe) ? lobe.pick : 0;
  const bool only_smooth = std::ranges::none_of(
      other.lobes_, [](const Lobe& lobe) { return lobe.transmits() && !lobe.delta(); });
  if (only_smooth) return;
  const float cover = all > 0 ? kSentAnywhere : kSentThrough,
              by_facets = all > 0 ? kSentThrough : 0;
  for (Lobe& lobe : lobes_) lobe.pick *= 1 - cover - by_facets;
  add_cover(view_.ng, 0, cover);
  for (const Lobe& lobe : other.lobes_)
    if (refracts(lobe))
      lobes_.add([&] {
        Lobe copy = lobe;
        copy.weight = copy.scale = {};
        copy.albedo = 0;
        copy.pick = by_facets * lobe.pick / all;
        return copy;
      });
}

void Bsdf::send_back() {
  for (Lobe& lobe : lobes_) lobe.pick *= 1 - kSentAnywhere;
  add_cover(view_.ng, kSentAnywhere, 0);
}

Bsdf::SmoothWays Bsdf::smooth_ways(const Vec3& light) const {
  SmoothWays out;
  for (int i = 0; i < lobes_.size(); ++i) {
    const Lobe& lobe = lobes_[i];
    if (!lobe.delta() || !lobe.transmits()) continue;
    if (out.count == std::ssize(out.ways)) break;
    if (const auto way = way_through(view_, lobe.given, light, lobe.fresnel.ior))
      out.ways[out.count++] = {i, way->to, way->spread};
  }
  return out;
}

std::optional<Vec3> Bsdf::way_on() const {
  for (const Lobe& lobe : lobes_) {
    Vec3 way;
    if (lobe.of_facets() && lobe.transmits() && refract(view_.wo, lobe.n, lobe.fresnel.ior, &way) &&
        lobe.on_right_side(view_, way))
      return way;
  }
  return {};
}

bool Bsdf::has_smooth_glass() const {
  return std::ranges::any_of(lobes_,
                             [](const Lobe& lobe) { return lobe.delta() && lobe.transmits(); });
}

Rgb Bsdf::smooth_share(int lobe) const {
  if (lobe >= lobes_.size()) return {};
  const Lobe& l = lobes_[lobe];
  if (!l.delta() || !l.transmits()) return {};
  return l.weight * evaluate_fresnel(l.fresnel, dot(l.n, view_.wo)).transmit;
}

Rgb Bsdf::mirror_share(int lobe) const {
  if (lobe >= lobes_.size()) return {};
  const Lobe& l = lobes_[lobe];
  if (!l.delta()) return {};
  return l.weight * evaluate_fresnel(l.fresnel, dot(l.n, view_.wo)).reflect;
}

float Bsdf::smooth_chance(bool sharp) const {
  float all = 0, through = 0;
  for (const Lobe& lobe : lobes_) {
    all += sharp ? sharp_pick(lobe) : lobe.pick;
    Vec3 way;
    if (!lobe.delta() || !lobe.transmits() || !refract(view_.wo, lobe.n, lobe.fresnel.ior, &way) ||
        !lobe.on_right_side(view_, way))
      continue;
    const float cosine = dot(lobe.n, view_.wo);
    through += lobe.pick * (1 - reflect_probability(evaluate_fresnel(lobe.fresnel, cosine)));
  }
  return all > 0 ? through / all : 0;
}

}  // namespace photon_splat
