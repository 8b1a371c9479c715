// One scattering lobe of a surface as seen from one direction, and the list of them that a Bsdf's
// closures expand to.
#pragma once

#include <cstddef>
#include <new>

#include "bsdf/hair/facet_hair.h"
#include "bsdf/microfacet.h"
#include "bsdf/subsurface.h"

namespace photon_splat {

enum class LobeKind : uint8_t {
  kLambert,
  kOrenNayar,
  kTranslucent,
  // Of no weight: where light comes to the surface from below a bump's horizon, on the side of wo
  // and on the other
  kBelowBump,
  kBelowBumpThrough,
  kFacets,
  kThinFacets,  // what facets reflect, on the other side: light through two boundaries close by
  kAshikhminShirley,
  kSheen,
  kVelvet,
  kToonDiffuse,
  kToonGlossy,
  kHairReflection,
  kHairTransmission,
  kPrincipledHair,
  kFacetHair
};

// Where a surface is looked at. `ng`, `ns` on the side of wo; back: that side is the geometric
// back.
struct View {
  Vec3 wo, ng, ns;
  bool back;
  Vec3 bent = ns;            // what all closures start from, where a displacement bends it; else ns
  bool towards_end = false;  // from where the light goes to, of what it met from elsewhere
  bool lit = false;          // of light samples: more of facets, less of translucent surfaces

  // The same point seen from the direction w, which may be on either side.
  View towards(const Vec3& w) const {
    return dot(w, ng) < 0 ? View{w, -ng, -ns, !back, -bent, true}
                          : View{w, ng, ns, back, bent, true};
  }
  // a closure's normal, given on the front side; `ns` if it is of no use
  Vec3 turned(const Vec3& normal) const;
};

struct Lobe {
  LobeKind kind;
  Rgb weight;      // factor of everything below
  float albedo;    // share of light it is thought to scatter, for the choice among lobes
  float pick = 0;  // probability of that choice
  Vec3 n, t, b;    // frame; n on the side of wo (translucent: too)
  Vec3 given;      // of facets: the normal before it was turned towards wo
  Facets facets;   // of_facets()
  FresnelTerms fresnel;
  // Facet lobes: weight without energy compensation; about what a lobe of weight 1 reflects and
  // refracts
  Rgb scale, layer;
  Vec3 from;         // of facets: wo in the lobe's frame
  float masked = 0;  // of facets: lambda of it
  // kOrenNayar: a, b, 1 - E(wo); kSheen: LTC a and b; kVelvet: 1/sigma^2; toon: size, smooth, pdf;
  // kAshikhminShirley: exponents along t and b, roughness; hair: roughness along and around,
  // offset; below a bump: the integral of its cosine there
  float p[3] = {};
  Rgb multiple;    // kOrenNayar: factor of the energy-preserving term
  Rgb gather;      // diffuse-like lobes: Lambertian albedo that photons estimate
  HairShape hair;  // kPrincipledHair
  FacetHairShape facet_hair;

  bool diffuse() const {
    return !of_facets() && kind != LobeKind::kToonGlossy && kind != LobeKind::kAshikhminShirley &&
           !of_hair();
  }
  // Scatters about a strand (its tangent is t), not off a surface
  bool of_hair() const { return kind >= LobeKind::kHairReflection; }
  bool of_facets() const { return kind == LobeKind::kFacets || kind == LobeKind::kThinFacets; }
  bool transmits() const {
    return kind == LobeKind::kTranslucent || kind == LobeKind::kBelowBumpThrough ||
           kind == LobeKind::kThinFacets || of_hair() ||
           (kind == LobeKind::kFacets && max_component(fresnel.transmit_tint) > 0);
  }
  bool delta() const { return kind == LobeKind::kFacets && facets.delta(); }
  // Mirrors about the horizon, as its normal has turned towards wo: hardly any photon finds its way
  // to such a viewer.
  bool turned() const {
    return kind == LobeKind::kFacets && roughness() <= kTurned && dot(n, given) < 1 - 1e-6f;
  }
  static constexpr float kTurned = 0.3f;  // greatest roughness
  float roughness() const;
  // On the wrong side of the surface proper it scatters nothing.
  bool on_right_side(const View& view, const Vec3& wi) const {
    return of_hair() || (dot(wi, view.ng) > 0) == (dot(wi, n) > 0);
  }
  Vec3 to_local(const Vec3& v) const { return {dot(v, t), dot(v, b), dot(v, n)}; }
  Vec3 to_world(const Vec3& v) const { return t * v.x + b * v.y + n * v.z; }

  // f |cos wi| and the density of sample(). Deltas: 0. sampled: wi is from there. Hair BSDF then
  // scatters to whatever side, as in Cycles.
  FacetValue evaluate(const View& view, const Vec3& wi, bool sampled = false) const;
  // False: no direction. The result may be on the wrong side of ng.
  bool sample(const View& view, float choice, const Vec2& u, Vec3* wi) const;
};

// Fixed room, filled from the front; what does not fit is dropped.
class LobeList {
 public:
  static constexpr int kMax = 48, kMostBelow = 4;

  Rgb emission{}, transparency{};
  Rgb straight{};  // the part of transparency that is glass which bends nothing
  float holdout = 0;

  int size() const { return size_; }
  Lobe* begin() { return std::launder(reinterpret_cast<Lobe*>(storage_)); }
  Lobe* end() { return begin() + size_; }
  const Lobe* begin() const { return std::launder(reinterpret_cast<const Lobe*>(storage_)); }
  const Lobe* end() const { return begin() + size_; }
  const Lobe& operator[](int i) const { return begin()[i]; }
  // What goes below the surface: no lobes
  int below_count() const { return below_count_; }
  void drop_below() { below_count_ = 0; }
  const Subsurface& below(int i) const {
    return std::launder(reinterpret_cast<const Subsurface*>(below_))[i];
  }
  void add_below(const Subsurface& closure) {
    if (below_count_ == kMostBelow) return;
    new (below_ + sizeof(Subsurface) * static_cast<size_t>(below_count_++)) Subsurface(closure);
  }
  // Adds what photons estimate, on the side seen and through the surface.
  void sum_gather(Rgb* same, Rgb* through) const {
    for (const Lobe& lobe : *this)
      (lobe.kind == LobeKind::kTranslucent ? *through : *same) += lobe.gather;
  }
  void go_straight(const Rgb& weight) {
    transparency += weight;
    straight += weight;
  }
  // make() yields a lobe, which is made in its place: a copy of what has just been written in parts
  // is slow.
  template <class Make>
  const Lobe& add(Make&& make) {
    Lobe* lobe = new (storage_ + sizeof(Lobe) * static_cast<size_t>(size_)) Lobe(make());
    if (size_ < kMax) ++size_;
    return *lobe;
  }

 private:
  int size_ = 0, below_count_ = 0;
  // Not a Lobe[]: the constructors would cost more than a hit
  alignas(Lobe) std::byte storage_[sizeof(Lobe) * (kMax + 1)];
  alignas(Subsurface) std::byte below_[sizeof(Subsurface) * kMostBelow];
};

// n turned towards ng until the mirror direction of wo stands a little above the surface; n where
// it already does.
Vec3 valid_reflection(const View& view, const Vec3& n);

// What makes a lobe out of a closure's inputs. All inputs finite and in range.
Lobe lambert_lobe(const Rgb& weight, const Vec3& n);
Lobe oren_nayar_lobe(const View& view, const Rgb& weight, const Vec3& n, float roughness,
                     const Rgb& color);
// n as valid_reflection() makes it, as in Cycles
Lobe translucent_lobe(const View& view, const Rgb& weight, const Vec3& n);
// Below the horizon of the unit normal `bump`, which the surface has instead of n; through: both
// are of the side away from wo.
Lobe below_bump_lobe(const Vec3& n, const Vec3& bump, bool through);
Lobe sheen_lobe(const View& view, const Rgb& weight, const Vec3& n, float roughness);
Lobe velvet_lobe(const View& view, const Rgb& weight, const Vec3& n, float sigma);
Lobe toon_lobe(const Rgb& weight, const Vec3& n, bool glossy, float size, float smooth);

struct FacetShape {
  bool beckmann = false, preserve_energy = false;
  // Alpha = roughness^2, times the two stretches along the tangent and across
  float roughness = 0;
  float along = 1, across = 1;
  float rotation = 0;    // of the tangent about the normal, in turns
  Rgb between{1, 1, 1};  // tint of what is reflected again between facets, where energy is kept
  Vec3 tangent{};
};
Lobe facet_lobe(const View& view, const Rgb& weight, const Vec3& n, const FacetShape& shape,
                const FresnelTerms& fresnel);
// Glass that bends nothing: no lobe, unless a film on it reflects.
void add_straight_glass(const View& view, const Rgb& weight, const Vec3& n, const FacetShape& shape,
                        FresnelTerms fresnel, LobeList& out);
// Of what a facet lobe scatters, about.
Rgb reflected_share(const Lobe& lobe);
// Under a roughness of 0.01 or so it is the mirror that facet_lobe() makes.
Lobe ashikhmin_shirley_lobe(const View& view, const Rgb& weight, const Vec3& n,
                            const FacetShape& shape);
FacetValue evaluate_hair(const Lobe& lobe, const Vec3& wo, const Vec3& wi, bool sampled);
bool sample_hair(const Lobe& lobe, const Vec3& wo, float choice, const Vec2& u, Vec3* wi);
FacetValue evaluate_facet_hair(const Lobe& lobe, const Vec3& wi, bool sampled);
bool sample_facet_hair(const Lobe& lobe, float choice, const Vec2& u, Vec3* wi);
// Whether what sample_hair() finds goes into the strand.
bool hair_transmits(const Lobe& lobe, float choice);
// In the lobe's frame, both above
FacetValue evaluate_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, const Vec3& wi);
// May lie below
Vec3 sample_ashikhmin_shirley(const Lobe& lobe, const Vec3& wo, const Vec2& u);

}  // namespace photon_splat
