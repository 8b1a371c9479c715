// How often each lobe is drawn.
#include "bsdf/bsdf.h"
#include "math/bumps.h"

namespace photon_splat {
namespace {

constexpr float kOrenNayarRest = 0.3f;  // about the share of it that no Lambertian has
constexpr float kStraight = 1 - 1e-6f;  // cosine from which on a normal is taken for not bent
// Cosine below which a bent normal's light has less to do with what photons bring to the surface
// than what is then taken off: |n - ns|^2 is 1, the norm of a Lambertian, at 60 degrees.
constexpr float kMostBent = 0.5f;
// Cosine of the smooth normal and the surface proper from which on bumps are followed. Where they
// differ more, bumps that lean as the surface does would have light from below it.
constexpr float kEven = 0.99f;
// Of the samples of what follows bumps: for light that grazes, which photons count less than fully
constexpr float kGrazing = 0.1f;
constexpr float kStep = 1.1f / 511;   // between offsets that are the same as they are kept
constexpr float kLeastCover = 0.05f;  // of a bent glossy lobe's samples

// Of what photons estimate by a normal that is off by that: how much comes from below its own
// horizon, from where it is lit by nothing. (1 - cosine of the angle) / 2.
float share_below(const Vec3& offset) { return 0.25f * length2(offset); }

}  // namespace

void Bsdf::finish() {
  if (loses_below_) lobes_.drop_below();
  gather_ = gather_through_ = {};
  for (Lobe& lobe : lobes_)
    if (dot(lobe.n, view_.ns) < kMostBent) lobe.gather = {};
  if (gathers_) lobes_.sum_gather(&gather_, &gather_through_);
  if (gathers_ && follows_bumps_ && dot(view_.ng, view_.ns) > kEven &&
      dot(view_.bent, view_.ns) > kStraight)
    find_parts();
  rest_ = narrow_ = false;
  float total = 0, largest = 0;
  for (Lobe& lobe : lobes_) {
    const bool wide =
        gathers_ && (lobe.kind == LobeKind::kLambert || lobe.kind == LobeKind::kTranslucent);
    if (!is_black(lobe.weight)) {
      narrow_ |= !wide;
      rest_ |= !wide || !(dot(lobe.n, view_.ns) > kStraight);
    }
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

// By the normals of the lobes that photons estimate; where there are too many of them the others
// count as not off.
void Bsdf::find_parts() {
  part_count_ = 0;
  const auto place = [this](const Part& part) {
    return std::find_if(parts_, parts_ + part_count_, [&](const Part& other) {
      return other.through == part.through && length2(other.offset - part.offset) == 0;
    });
  };
  bool off = false;
  for (const Lobe& lobe : lobes_) {
    if (is_black(lobe.gather)) continue;
    Part part{lobe.gather, {}, lobe.kind == LobeKind::kTranslucent};
    if (!(dot(lobe.n, view_.ns) > kStraight))
      part.offset = decode_offset(encode_offset(offset_of(lobe)));
    if (part_count_ >= kMostBumps && place(part) == parts_ + part_count_) part.offset = {};
    off |= length2(part.offset) > 0;
    Part* const known = place(part);
    if (known < parts_ + part_count_)
      known->albedo += part.albedo;
    else
      parts_[part_count_++] = part;
  }
  if (!off) part_count_ = 0;
}

// From the shading normal of the side that its light comes from.
Vec3 Bsdf::offset_of(const Lobe& lobe) const {
  return lobe.kind == LobeKind::kTranslucent ? view_.ns - lobe.n : lobe.n - view_.ns;
}

const Bsdf::Part* Bsdf::part_of(const Lobe& lobe) const {
  if (is_black(lobe.gather)) return nullptr;
  const bool through = lobe.kind == LobeKind::kTranslucent;
  const Vec3 offset = offset_of(lobe);
  for (const Part& part : gather_parts())
    if (part.through == through && max_abs(part.offset - offset) < kStep) return &part;
  return nullptr;
}

void Bsdf::prefer_rest(float kept) {
  if (!gathers_) return;
  float total = 0, below[kMostParts] = {};
  for (Lobe& lobe : lobes_) {
    const Part* const part = part_of(lobe);
    const float missed = part ? share_below(part->offset) : 0;
    if (part) below[part - parts_] += lobe.pick * missed;
    if (lobe.kind == LobeKind::kLambert || lobe.kind == LobeKind::kTranslucent)
      lobe.pick *= std::clamp(part ? missed : length(lobe.n - view_.ns), kept, 1.0f);
    else if (lobe.kind == LobeKind::kOrenNayar)
      lobe.pick *= std::max(kept, kOrenNayarRest);
    total += lobe.pick;
  }
  for (float missed : below) total += missed;
  for (Lobe& lobe : lobes_) lobe.pick = total > 0 ? lobe.pick / total : 0;
  for (float& missed : below) missed = total > 0 ? missed / total : 0;
  cover_gathered(below);
}

// What photons estimate is taken off wherever the surface's shading normal sees light, below a bent
// normal's horizon too: there lobes of no weight find the directions. `below`: chances of those
// that know where it lies, of each part.
void Bsdf::cover_gathered(const float* below) {
  float same = 0, through = 0;
  for (Lobe& lobe : lobes_) {
    if (lobe.pick <= 0 || is_black(lobe.gather) || dot(lobe.n, view_.ns) > kStraight) continue;
    const float moved = lobe.pick * (part_of(lobe) ? kGrazing : 0.5f);
    lobe.pick -= moved;
    (lobe.kind == LobeKind::kTranslucent ? through : same) += moved;
  }
  for (int i = 0; i < part_count_; ++i) {
    if (!(below[i] > 0)) continue;
    const Part& part = parts_[i];
    const Vec3 n = part.through ? -view_.ns : view_.ns;
    lobes_.add([&] {
      Lobe lobe = below_bump_lobe(n, normalize(n + part.offset), part.through);
      lobe.pick = below[i];
      return lobe;
    });
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
  part_count_ = 0;
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
