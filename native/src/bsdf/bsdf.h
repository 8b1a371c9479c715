// What a surface does with light at one hit: a list of closures, as Cycles has them, with
// evaluation, sampling and pdf.
#pragma once

#include <optional>
#include <span>

#include "bsdf/lobe.h"

namespace photon_splat {

// Which quantity travels along the path. Radiance: from the camera, in the convention of basic
// radiance (L/n^2), so that refraction does not scale it. Flux: photons; the adjoint of the same
// scattering (Veach 1997, section 5).
enum class Transport : uint8_t { kRadiance, kFlux };

// The last: glossy only
enum class Distribution : uint8_t { kGgx, kMultiGgx, kBeckmann, kAshikhminShirley };

struct PrincipledInputs {
  Rgb base_color{0.8f, 0.8f, 0.8f};
  float metallic = 0, roughness = 0.5f, ior = 1.5f;
  float diffuse_roughness = 0;
  float subsurface_weight = 0;
  SubsurfaceInputs subsurface;  // method, radius, ior of skin, anisotropy; else not read
  // Light that goes in comes out of either side at the same place
  bool thin_wall = false;
  float specular_level = 0.5f;
  Rgb specular_tint{1, 1, 1};
  float anisotropic = 0, anisotropic_rotation = 0;
  float transmission_weight = 0;
  float coat_weight = 0, coat_roughness = 0.03f, coat_ior = 1.5f;
  Rgb coat_tint{1, 1, 1};
  float sheen_weight = 0, sheen_roughness = 0.5f;
  Rgb sheen_tint{1, 1, 1};
  Rgb emission_color{1, 1, 1};
  float emission_strength = 0;
  float thin_film_thickness = 0, thin_film_ior = 1.33f;  // nm
  float alpha = 1;
  // World space; normals on the side of the geometric front, tangent may be 0 (none)
  Vec3 normal, coat_normal, tangent;
  Distribution distribution = Distribution::kMultiGgx;
};

// Share of a lobe in what can focus light, by its roughness: no threshold shows along a sweep.
inline float sharpness(float roughness) {
  const float t = std::clamp((roughness - 0.1f) / 0.4f, 0.0f, 1.0f);
  return 1 - t * t * (3 - 2 * t);
}

struct BsdfSample {
  Vec3 direction;  // unit, away from the surface
  Rgb weight;      // f |cos| / pdf of the whole BSDF (of the chosen lobe where it is a delta)
  Rgb rest;        // the same without what photons estimate at this vertex (see Bsdf::gather)
  float pdf = 0;   // solid angle, of the mixture over lobes; 0: delta
  // Flux: weight over the radiance BSDF's value for a path in the other direction, cosines
  // included. Deltas that reflect: over mirror_share(lobe); others: 0
  float per_value = 0;
  int lobe = -1;
  float roughness = 0;  // of the chosen lobe: 0 delta .. 1; diffuse lobes, strands: 1
  bool transmitted = false;
  // By a lobe whose normal was turned towards wo: all such viewers see what lies along the surface,
  // and photons that come from there do not go to them
  bool by_turned_normal = false;
  bool diffuse = false;  // a diffuse-like lobe (diffuse, translucent, sheen) was chosen
  float favour = 1;      // the pdf without what is drawn towards a cone, over all of it
};

// To the samples of a Bsdf come others, so many for each, of which diffuse-like lobes draw their
// directions from a cone: all weigh by the density of both together.
struct Towards {
  Cone cone;
  float chance = 0;
  bool drawn = false;  // this one is of the others

  // Of the others, of lobes that draw them. Rounding must not put one of them outside.
  float pdf(const Vec3& way) const {
    return chance * (drawn ? 1 / cone.solid_angle() : cone.pdf(way));
  }
};

// The closures at a hit. Filled by add_*() in any order, then finish(), then used.
// Normals come in on the front side of the surface (as the mesh has them); the constructor's `ng`
// and `ns` are on the side of `wo`. `back` tells that wo is behind the surface: refraction then
// leaves the medium (ior inverted), closures' normals are turned to wo's side.
class Bsdf {
 public:
  static constexpr int kMaxClosures = 24;

  // `wo`: towards where the path came from (the camera, or the light for photons). `ng`, `ns` unit,
  // on the side of wo.
  Bsdf(Transport transport, const Vec3& wo, const Vec3& ng, const Vec3& ns, bool back);

  // The normal, on the side of wo, that bumps of single closures are told from; else `ns`.
  void set_bent_normal(const Vec3& normal) { view_.bent = normal; }
  // ns, unless a displacement has bent it.
  const Vec3& bent_normal() const { return view_.bent; }

  // Which closures that scatter below the surface are kept as such, in below(); the others are
  // diffuse. Before any is added.
  void keep_subsurface(SubsurfaceUse use) { use_ = use; }
  // What goes below the surface is lost, as Cycles loses it on strands.
  void lose_subsurface() {
    if (use_ == SubsurfaceUse::kNone) use_ = SubsurfaceUse::kAll;
    loses_below_ = true;
  }

  // Photons estimate nothing here, all is left to `rest`; and no lobe counts as one that focuses
  // light, which caustic photons would have to be aimed at. Before finish().
  void gather_nothing() { gathers_ = false; }
  // Who collects what photons bring knows the ways they come: it follows bumps (math/bumps.h),
  // except where a displacement or coarse smooth normals bend the surface itself. Radiance; before
  // finish().
  void gather_bumps() { follows_bumps_ = true; }
  // Lobes whose normals turn towards who sees them are looked for from the surfaces that they
  // light: photons leave them out. After finish(): there is nothing but them, or nothing but lobes
  // as smooth; false if there is none.
  void leave_out_turned() { turned_apart_ = true; }
  bool keep_turned();
  bool keep_smooth();
  bool has_wide_turned() const;  // that light samples find

  // weight: the closure's colour times the mix factors above it (what Cycles calls the closure's
  // weight). Negative or non-finite weights and parameters are made harmless here: never a NaN out.
  // `color` (optional, here and below): the closure's colour without the mix factors, which tints
  // light scattered more than once; without it `weight` is taken.
  void add_diffuse(const Rgb& weight, const Vec3& normal, float roughness,
                   const Rgb* color = nullptr);
  void add_translucent(const Rgb& weight, const Vec3& normal);
  void add_glossy(const Rgb& weight, const Vec3& normal, Distribution d, float roughness,
                  float anisotropy, float rotation, const Vec3& tangent,
                  const Rgb* color = nullptr);
  void add_glass(const Rgb& weight, const Vec3& normal, Distribution d, float roughness, float ior,
                 float film_thickness, float film_ior, const Rgb* color = nullptr);
  void add_refraction(const Rgb& weight, const Vec3& normal, Distribution d, float roughness,
                      float ior);
  // Metallic BSDF: F82 (base, edge tint) or, with `physical`, complex index (ior, extinction per
  // channel).
  void add_metallic(const Rgb& weight, const Vec3& normal, Distribution d, float roughness,
                    float anisotropy, float rotation, const Vec3& tangent, bool physical,
                    const Rgb& base_or_ior, const Rgb& edge_or_extinction, float film_thickness,
                    float film_ior);
  void add_sheen(const Rgb& weight, const Vec3& normal, float roughness, bool ashikhmin);
  void add_toon(const Rgb& weight, const Vec3& normal, bool glossy, float size, float smooth);
  void add_subsurface(const Rgb& weight, SubsurfaceInputs&& inputs);  // which are changed
  void add_hair(const Rgb& weight, const Vec3& normal, HairInputs&& inputs);
  void add_principled_hair(const Rgb& weight, const Vec3& normal, PrincipledHairInputs&& inputs);
  void add_facet_hair(const Rgb& weight, const Vec3& normal, FacetHairInputs&& inputs);
  void add_transparent(const Rgb& weight);
  void add_emission(const Rgb& weight);
  void add_holdout(float weight);
  void add_principled(const Rgb& weight, PrincipledInputs&& inputs);  // which are changed

  // Makes the lobes' weights, and splits them into what photons estimate and the rest. After it
  // nothing may be added.
  void finish();

  // Radiance towards wo, W/m^2/sr; below 0 where nodes say so
  const Rgb& emission() const { return lobes_.emission; }
  // The part of transparency() through glass that bends nothing: a camera ray is a transmission ray
  // then
  const Rgb& straight() const { return lobes_.straight; }
  // Share of light that goes straight on: a null vertex, no lobe
  const Rgb& transparency() const { return lobes_.transparency; }
  float holdout() const { return lobes_.holdout; }
  bool scatters() const;    // has any closure that scatters, below the surface too
  bool transmits() const;   // some lobe sends light to the other side
  bool only_delta() const;  // scatters, and evaluate() is 0 everywhere

  // Closures that scatter below the surface. evaluate() and sample() know nothing of them.
  int below_count() const { return lobes_.below_count(); }
  int lobe_count() const { return lobes_.size(); }
  const Subsurface& below(int i) const { return lobes_.below(i); }
  Rgb below_weight() const;  // of all

  // What photons estimate here: Lambertian albedos. L_D = gather/pi E(wo's side) +
  // gather_through/pi E(the other side).
  const Rgb& gather() const { return gather_; }
  const Rgb& gather_through() const { return gather_through_; }
  // Of these what has a normal of its own, by its offset from the shading normal of the side that
  // the light comes from. After gather_bumps(); none where no normal is off.
  struct Part {
    Rgb albedo;
    Vec3 offset;  // as encode_offset() keeps it
    bool through;
  };
  std::span<const Part> gather_parts() const { return {parts_, static_cast<size_t>(part_count_)}; }
  // What photons estimate of the light that comes from wi, f |cos|.
  Rgb gathered(const Vec3& wi) const;
  // Lets sample() choose lobes for the sake of `rest`: those that photons estimate keep `kept` of
  // their chance, or what they differ from a Lambertian of the surface's shading normal. After
  // finish(); evaluate()'s pdf follows. Before it `rest` must not be used: only then sample() finds
  // every direction that has some.
  void prefer_rest(float kept);
  // Flux: lets a share of the samples leave on the other side, whatever the lobes say: who sees the
  // surface from there may see others. `other`: those, of a Bsdf for this side. After finish().
  void send_through(const Bsdf& other);
  // Flux: lets a share of them leave anywhere on this side, for viewers who see other closures.
  void send_back();
  // Where smooth glass sends light that comes from beyond the surface to, on this side: each way by
  // a lobe and as a viewer there sees its normal. Depends on wo by which closures there are alone.
  struct SmoothWay {
    int lobe;
    Vec3 to;       // unit
    float spread;  // of the light's flux, but for the lobe's share
  };
  struct SmoothWays {
    SmoothWay ways[8];
    int count = 0;
  };
  SmoothWays smooth_ways(const Vec3& light) const;
  // Flux: where a lobe of facets sends the light to through the surface, none if none does.
  std::optional<Vec3> way_on() const;
  bool has_smooth_glass() const;
  // Radiance: what such a lobe lets through of what is seen from wo, or a delta one mirrors.
  Rgb smooth_share(int lobe) const;
  Rgb mirror_share(int lobe) const;
  // Flux: probability of sample(), or sample_sharp(), to go through by such a lobe.
  float smooth_chance(bool sharp) const;
  bool has_rest() const;  // scatters beyond what is gathered: camera paths go on
  bool has_narrow() const { return narrow_; }  // scatters otherwise than in proportion to a cosine
  // Directional albedo towards wo, about; for the denoiser and Russian roulette
  Rgb albedo() const;
  // Of its lobes of at most that roughness.
  Rgb sharp_albedo(float roughness) const;
  // Unit, of the lobes by what they scatter, on wo's side; ns where nothing scatters. Blender's
  // Normal pass
  Vec3 mean_normal() const;
  // The mean normal of diffuse-like lobes alone, by their weights
  Vec3 mean_diffuse_normal() const;
  Rgb diffuse_albedo() const;  // of diffuse-like lobes: Blender's Diffuse Color pass
  // The same of other lobes that reflect and transmit: the passes Glossy Color and Transmission
  // Color. What strands scatter may count as either, and is in both.
  struct Colors {
    Rgb glossy, transmission;
  };
  Colors colors() const;

  // f |cos(wi)| of everything but deltas; `pdf` of sample() for wi; `rest` (optional) without what
  // is gathered; `diffuse` (optional): the part of diffuse-like lobes (passes). `sharp` (optional):
  // the mean sharpness of the lobes that sample() would find wi by, 0 for diffuse-like ones. wi on
  // the wrong side of ng for its lobe: 0. Flux: cosines and adjoint factors for shading normals
  // included, so that power * evaluate / pdf is the new power.
  Rgb evaluate(const Vec3& wi, float* pdf, Rgb* rest = nullptr, Rgb* diffuse = nullptr,
               float* sharp = nullptr) const;
  // What is special to a light sample. `bent`: light from above the smooth normal ns and below the
  // geometric normal ng counts as from above both; where normals are smooth such light may pass the
  // surface that they promise. `lit`: counts what Cycles' light samples do and its rays do not, see
  // evaluate_facets().
  struct OfLight {
    bool bent, lit;
  };
  Rgb evaluate_light(const Vec3& wi, OfLight how, float* pdf, Rgb* diffuse, float* sharp) const;

  // Draws a direction in proportion to the lobes: u chooses the lobe, and the side of a delta, and
  // places; `choice` chooses the side of others. Transparency and emission are not lobes. nullopt:
  // absorbed.
  std::optional<BsdfSample> sample(float choice, const Vec2& u, const Towards& towards = {}) const;
  // For who has no use for samples of lobes that are not sharp: draws others only, whose weights
  // are as much smaller as they are more.
  std::optional<BsdfSample> sample_sharp(float choice, const Vec2& u) const;
  // The part that counts as diffuse of what all lobes scatter towards wi, for light that diffuse
  // rays see otherwise than others do, as Cycles counts it: samples of the light, of the density
  // `light_pdf`, by the lobes' values, and rays by the lobe that they would be drawn by. The two
  // share by the power heuristic. INFINITY: all by samples.
  Rgb diffuse_share(const Vec3& wi, float light_pdf) const;
  Rgb diffuse_share(const BsdfSample& s, float light_pdf) const;
  // Density over solid angle of the rays that Cycles would draw towards wi; for photons, of those
  // that look along them the other way.
  float ray_pdf(const Vec3& wi) const;

 private:
  template <typename Kept>
  bool keep_lobes(const Kept& kept);
  // A closure kept to be expanded again for another direction: `size` bytes of it follow.
  struct Entry {
    void (*expand)(const void* closure, const View& view, LobeList& out);
    size_t size;
  };
  static constexpr size_t kTapeBytes = 16384;

  template <class Closure>
  void add(const Closure& closure);
  template <class Closure>
  void keep(const Closure& closure);
  void expand(const View& view, LobeList& out) const;
  void find_parts();
  Vec3 offset_of(const Lobe& lobe) const;
  const Part* part_of(const Lobe& lobe) const;  // nullptr: none
  void cover_gathered(const float* below);
  void cover_hemispheres();
  void add_cover(const Vec3& n, float same, float through);
  // sampled: the lobe that wi was drawn by, or -1
  Rgb evaluate_as(const View& view, const Vec3& wi, float* pdf, Rgb* rest, Rgb* diffuse,
                  float* sharp, int sampled) const;
  // Of rays that Cycles would draw towards wi: over solid angle, and the part of diffuse-like lobes
  struct Drawn {
    float pdf, diffuse;
  };
  Drawn drawn(const Vec3& wi) const;
  float scale_of_flux(const Vec3& wi) const;  // of light that comes from wo and leaves along wi
  Rgb adjoint(const Vec3& wi, Rgb* rest, Rgb* diffuse) const;
  float sharp_pick(const Lobe& lobe) const;  // its chance among sharp ones, but for a factor
  std::optional<BsdfSample> sample_lobe(int index, float choice, const Vec2& u,
                                        const Towards& towards = {}) const;
  float more_towards(const Towards& towards, const Vec3& wi) const;
  std::optional<BsdfSample> finish_delta(int index, BsdfSample out) const;

  Transport transport_;
  SubsurfaceUse use_ = SubsurfaceUse::kNone;
  View view_;
  LobeList lobes_;
  Rgb gather_{}, gather_through_{};
  static constexpr int kMostBumps = 4, kMostParts = kMostBumps + 2;
  Part parts_[kMostParts];
  int part_count_ = 0;
  bool rest_ = false, narrow_ = false, gathers_ = true, follows_bumps_ = false,
       loses_below_ = false, turned_apart_ = false;
  size_t tape_used_ = 0;
  alignas(16) std::byte tape_[kTapeBytes];  // flux only
};

}  // namespace photon_splat
