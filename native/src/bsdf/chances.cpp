// How often each lobe is drawn.
#include "bsdf/bsdf.h"

namespace photon_splat {
namespace {

constexpr float kOrenNayarRest = 0.3f;  // about the share of it that no Lambertian has
constexpr float kStraight = 1 - 1e-6f;  // cosine from which on a normal is taken for not bent
// Cosine below which a bent normal's light has less to do with what photons bring to the surface
// than what is then taken off: |n - ns|^2 is 1, the norm of a Lambertian, at 60 degrees.
constexpr float kMostBent = 0.5f;
constexpr float kLeastCover = 0.05f;  // of a bent glossy lobe's samples

}  // namespace

void Bsdf::finish() {
  if (loses_below_) lobes_.drop_below();
  gather_ = gather_through_ = {};
  for (Lobe& lobe : lobes_)
    if (dot(lobe.n, view_.ns) < kMostBent) lobe.gather = {};
  if (gathers_) lobes_.sum_gather(&gather_, &gather_through_);
  rest_ = false;
  float total = 0, largest = 0;
  for (Lobe& lobe : lobes_) {
    const bool plain = lobe.kind == LobeKind::kLambert || lobe.kind == LobeKind::kTranslucent;
    if (!is_black(lobe.weight) && !(gathers_ && plain && dot(lobe.n, view_.ns) > 1 - 1e-6f))
      rest_ = true;
    largest = std::max(largest, lobe.albedo);
  }
  // A photon's lobes are weighed anew for the direction it leaves in: none that may count there is
  // left out.
  const float least =
      transport_ == Transport::kFlux ? 0.01f * std::max(largest, 1e-6f) : 1e-4f * largest;
  for (Lobe& lobe : lobes_) {
    // Towards which side of the cone a photon may leave a toon surface does not depend on where it
    // came from.
    if (transport_ == Transport::kFlux && lobe.kind == LobeKind::kToonDiffuse)
      lobe.kind = LobeKind::kLambert;
    lobe.pick = is_black(lobe.weight) && transport_ == Transport::kRadiance
                    ? 0
                    : std::max(lobe.albedo, least);
    total += lobe.pick;
  }
  for (Lobe& lobe : lobes_) lobe.pick = total > 0 ? lobe.pick / total : 0;
  if (transport_ == Transport::kFlux) cover_hemispheres();
}

void Bsdf::prefer_rest(float kept) {
  if (!gathers_) return;
  float total = 0;
  for (Lobe& lobe : lobes_) {
    if (lobe.kind == LobeKind::kLambert || lobe.kind == LobeKind::kTranslucent)
      lobe.pick *= std::clamp(length(lobe.n - view_.ns), kept, 1.0f);
    else if (lobe.kind == LobeKind::kOrenNayar)
      lobe.pick *= std::max(kept, kOrenNayarRest);
    total += lobe.pick;
  }
  for (Lobe& lobe : lobes_) lobe.pick = total > 0 ? lobe.pick / total : 0;
  cover_gathered();
}

// What photons estimate is taken off wherever the surface's shading normal sees light, below a bent
// normal's horizon too: there a lobe of no weight finds the directions.
void Bsdf::cover_gathered() {
  float same = 0, through = 0;
  for (Lobe& lobe : lobes_) {
    if (lobe.pick <= 0 || is_black(lobe.gather) || dot(lobe.n, view_.ns) > kStraight) continue;
    lobe.pick *= 0.5f;
    (lobe.kind == LobeKind::kTranslucent ? through : same) += lobe.pick;
  }
  add_cover(view_.ns, same, through);
}

// A photon may leave in every direction from which a camera path would see the bent surface lit:
// with the surface proper as its horizon, not the bent normal. A Lambertian sends it there in exact
// proportion to the surface's own cosine.
void Bsdf::cover_hemispheres() {
  float same = 0, through = 0;
  for (Lobe& lobe : lobes_) {
    const float cosine = dot(lobe.n, view_.ng);
    if (lobe.pick <= 0 || lobe.delta() || lobe.of_hair() || cosine > kStraight) continue;
    if (lobe.diffuse()) {
      const Basis basis(view_.ng);
      lobe.n = view_.ng, lobe.t = basis.tangent, lobe.b = basis.bitangent;
      continue;
    }
    const float moved = lobe.pick * std::clamp(1 - cosine, kLeastCover, 0.5f);
    const bool transmits = lobe.transmits();
    lobe.pick -= moved;
    same += transmits ? 0.5f * moved : moved;
    through += transmits ? 0.5f * moved : 0;
  }
  add_cover(view_.ng, same, through);
}

// Lobes of no weight about n, of these chances.
void Bsdf::add_cover(const Vec3& n, float same, float through) {
  const auto add = [&](LobeKind kind, float pick) {
    if (!(pick > 0)) return;
    lobes_.add([&] {
      Lobe lobe = lambert_lobe({}, n);
      lobe.kind = kind;
      lobe.pick = pick;
      return lobe;
    });
  };
  add(LobeKind::kLambert, same);
  add(LobeKind::kTranslucent, through);
}

bool Bsdf::has_wide_turned() const {
  return std::ranges::any_of(lobes_,
                             [](const Lobe& lobe) { return lobe.turned() && !lobe.delta(); });
}

template <typename Kept>
bool Bsdf::keep_lobes(const Kept& kept) {
  float total = 0;
  for (Lobe& lobe : lobes_) {
    if (!kept(lobe)) lobe.weight = {}, lobe.pick = 0;
    total += lobe.pick;
  }
  lobes_.drop_below();
  gather_ = gather_through_ = {};
  rest_ = total > 0;
  for (Lobe& lobe : lobes_) lobe.pick = total > 0 ? lobe.pick / total : 0;
  return total > 0;
}

bool Bsdf::keep_turned() {
  return keep_lobes([](const Lobe& lobe) { return lobe.turned(); });
}

bool Bsdf::keep_smooth() {
  return keep_lobes([](const Lobe& lobe) {
    return lobe.kind == LobeKind::kFacets && lobe.roughness() <= Lobe::kTurned;
  });
}

}  // namespace photon_splat
