// The closures that a surface is made of: add_...() cleans what nodes give, and keeps it for other
// views.
#include <cstring>

#include "bsdf/bsdf.h"
#include "bsdf/principled.h"

namespace photon_splat {
namespace {

// Closures with clean inputs. expand() adds their lobes as seen from `view`; as many whatever the
// view.

struct Diffuse {
  Rgb weight, color;
  Vec3 normal;
  float roughness;
  void expand(const View& view, LobeList& out) const {
    const Vec3 n = view.turned(normal);
    out.add([&] {
      return roughness > 1e-5f ? oren_nayar_lobe(view, weight, n, roughness, color)
                               : lambert_lobe(weight, n);
    });
  }
};

struct Translucent {
  Rgb weight;
  Vec3 normal;
  void expand(const View& view, LobeList& out) const {
    out.add([&] { return translucent_lobe(view, weight, view.turned(normal)); });
  }
};

struct Facet {
  Rgb weight;
  Vec3 normal;
  FacetShape shape;
  FresnelTerms fresnel;    // ior as seen from the front
  bool transmits, mirror;  // refraction alone: no mirror
  void expand(const View& view, LobeList& out) const {
    FresnelTerms f = fresnel;
    if (transmits) {
      const bool straight = bends_nothing(f.ior);
      // The film too is seen from within the glass
      if (view.back) f.film_ior /= f.ior, f.ior = 1 / f.ior;
      const float f0 = f0_from_ior(f.ior);
      f.f0 = {f0, f0, f0};
      if (!mirror) f.f0 = f.f90 = {};
      if (straight) return add_straight_glass(view, weight, view.turned(normal), shape, f, out);
    }
    out.add([&] { return facet_lobe(view, weight, view.turned(normal), shape, f); });
  }
};

struct AshikhminShirley {
  Rgb weight;
  Vec3 normal;
  FacetShape shape;
  void expand(const View& view, LobeList& out) const {
    out.add([&] { return ashikhmin_shirley_lobe(view, weight, view.turned(normal), shape); });
  }
};

struct Sheen {
  Rgb weight;
  Vec3 normal;
  float roughness;
  bool ashikhmin;
  void expand(const View& view, LobeList& out) const {
    const Vec3 n = view.turned(normal);
    out.add([&] {
      return ashikhmin ? velvet_lobe(view, weight, n, roughness)
                       : sheen_lobe(view, weight, n, roughness);
    });
  }
};

struct Toon {
  Rgb weight;
  Vec3 normal;
  float size, smooth;
  bool glossy;
  void expand(const View& view, LobeList& out) const {
    out.add([&] { return toon_lobe(weight, view.turned(normal), glossy, size, smooth); });
  }
};

struct Transparent {
  Rgb weight;
  void expand(const View&, LobeList& out) const { out.transparency += weight; }
};

struct Emission {
  Rgb weight;
  void expand(const View&, LobeList& out) const { out.emission += weight; }
};

struct Holdout {
  float weight;
  void expand(const View&, LobeList& out) const { out.holdout += weight; }
};

struct Principled {
  Rgb weight;
  PrincipledInputs inputs;
  SubsurfaceUse use;
  void expand(const View& view, LobeList& out) const {
    expand_principled(weight, inputs, view, use, out);
  }
};

struct Below {
  Rgb weight;
  SubsurfaceInputs inputs;
  SubsurfaceUse use;
  void expand(const View& view, LobeList& out) const {
    expand_subsurface(weight, inputs, view, use, out);
  }
};

struct Hair {
  Rgb weight;
  Vec3 normal;
  HairInputs inputs;
  void expand(const View& view, LobeList& out) const {
    out.add([&] { return hair_lobe(view, weight, view.turned(normal), inputs); });
  }
};

struct PrincipledHair {
  Rgb weight;
  Vec3 normal;
  PrincipledHairInputs inputs;
  void expand(const View& view, LobeList& out) const {
    out.add([&] { return principled_hair_lobe(view, weight, view.turned(normal), inputs); });
  }
};

struct FacetHair {
  Rgb weight;
  Vec3 normal;
  FacetHairInputs inputs;
  void expand(const View& view, LobeList& out) const {
    out.add([&] { return facet_hair_lobe(view, weight, view.turned(normal), inputs); });
  }
};

// False where the frame has no direction along the strand: the closure is then left out.
bool clean_frame(HairFrame& frame) {
  const float len = length(frame.tangent);
  if (!(len > 0 && std::isfinite(len))) return false;
  frame.tangent = frame.tangent / len;
  frame.across = clean(frame.across, -1, 1, 0);
  return true;
}

FacetShape clean_shape(Distribution d, float roughness, float anisotropy, float rotation,
                       const Vec3& tangent) {
  FacetShape shape;
  shape.beckmann = d == Distribution::kBeckmann;
  shape.preserve_energy = d == Distribution::kMultiGgx;
  shape.roughness = clean(roughness, 0, 1, 0.5f);
  // Anisotropy as Blender's Glossy node defines it.
  const float a = clean(anisotropy, -0.99f, 0.99f, 0);
  if (a > 0) shape.along = 1 - a, shape.across = 1 / (1 - a);
  if (a < 0) shape.along = 1 / (1 + a), shape.across = 1 + a;
  shape.rotation = clean(rotation, -1e4f, 1e4f, 0);
  if (is_finite(tangent)) shape.tangent = tangent;
  return shape;
}

// What one facet scatters (the colour), and the factor of it all that makes up `weight`.
Rgb split_color(const Rgb& weight, const Rgb* color, Rgb* tint) {
  const Rgb w = clean_color(weight);
  *tint = min(color ? clean_color(*color) : w, kWhite);
  const auto ratio = [](float a, float b) { return b > 0 ? std::min(a / b, 1e6f) : 0.0f; };
  return {ratio(w.x, tint->x), ratio(w.y, tint->y), ratio(w.z, tint->z)};
}

}  // namespace

template <class Closure>
void Bsdf::add(const Closure& closure) {
  static_assert(std::is_trivially_copyable_v<Closure>);
  closure.expand(view_, lobes_);
  keep(closure);
}

template <class Closure>
void Bsdf::keep(const Closure& closure) {
  if (transport_ == Transport::kRadiance) return;
  constexpr size_t room = (sizeof(Entry) + sizeof(Closure) + 15) / 16 * 16;
  if (tape_used_ + room > kTapeBytes) return;
  const Entry entry{[](const void* bytes, const View& view, LobeList& out) {
                      Closure kept;
                      std::memcpy(static_cast<void*>(&kept), bytes, sizeof(Closure));
                      kept.expand(view, out);
                    },
                    room};
  std::memcpy(tape_ + tape_used_, &entry, sizeof entry);
  std::memcpy(tape_ + tape_used_ + sizeof entry, &closure, sizeof closure);
  tape_used_ += room;
}

void Bsdf::expand(const View& view, LobeList& out) const {
  for (size_t at = 0; at < tape_used_;) {
    Entry entry;
    std::memcpy(&entry, tape_ + at, sizeof entry);
    entry.expand(tape_ + at + sizeof entry, view, out);
    at += entry.size;
  }
}

void Bsdf::add_diffuse(const Rgb& weight, const Vec3& normal, float roughness, const Rgb* color) {
  const Rgb w = clean_color(weight);
  add(Diffuse{w, color ? clean_color(*color) : w, normal, clean(roughness, 0, 1, 0)});
}
void Bsdf::add_translucent(const Rgb& weight, const Vec3& normal) {
  add(Translucent{clean_color(weight), normal});
}
void Bsdf::add_transparent(const Rgb& weight) { add(Transparent{clean_color(weight)}); }
void Bsdf::add_emission(const Rgb& weight) {
  add(Emission{clean_color(weight) - clean_color(-weight)});
}
void Bsdf::add_holdout(float weight) { add(Holdout{clean(weight, 0, 1, 0)}); }
void Bsdf::add_principled(const Rgb& weight, PrincipledInputs&& inputs) {
  make_clean(inputs);
  const Rgb w = clean_color(weight);
  expand_principled(w, inputs, view_, use_, lobes_);
  if (transport_ == Transport::kFlux) keep(Principled{w, inputs, use_});
}
void Bsdf::add_subsurface(const Rgb& weight, SubsurfaceInputs&& inputs) {
  make_clean(inputs);
  add(Below{clean_color(weight), inputs, use_});
}
void Bsdf::add_sheen(const Rgb& weight, const Vec3& normal, float roughness, bool ashikhmin) {
  add(Sheen{clean_color(weight), normal, clean(roughness, 0, 1, 0.5f), ashikhmin});
}
void Bsdf::add_toon(const Rgb& weight, const Vec3& normal, bool glossy, float size, float smooth) {
  add(Toon{clean_color(weight), normal, clean(size, 0, 1, 0.5f), clean(smooth, 0, 1, 0), glossy});
}

void Bsdf::add_hair(const Rgb& weight, const Vec3& normal, HairInputs&& in) {
  if (!clean_frame(in.frame)) return;
  in.offset = clean(in.offset, -kPi / 2, kPi / 2, 0);
  in.along = clean(in.along, 0.001f, 1, 0.1f);
  in.around = clean(in.around, 0.001f, 1, 1);
  add(Hair{clean_color(weight), normal, in});
}
void Bsdf::add_principled_hair(const Rgb& weight, const Vec3& normal, PrincipledHairInputs&& in) {
  if (!clean_frame(in.frame)) return;
  in.absorption = clean_color(in.absorption);
  in.offset = clean(in.offset, -kPi / 2, kPi / 2, 0);
  in.along = clean(in.along, 0.001f, 1, 0.3f);
  in.around = clean(in.around, 0.001f, 1, 0.3f);
  in.coat = clean(in.coat, 0, 1, 0);
  in.ior = clean(in.ior, 1.0001f, 1e3f, 1.55f);
  add(PrincipledHair{clean_color(weight), normal, in});
}

void Bsdf::add_facet_hair(const Rgb& weight, const Vec3& normal, FacetHairInputs&& in) {
  if (!clean_frame(in.frame)) return;
  in.absorption = clean_color(in.absorption);
  if (!is_finite(in.major)) in.major = {};
  in.roughness = clean(in.roughness, 0.001f, 1, 0.3f);
  in.aspect = clean(in.aspect, 0.01f, 100, 1);
  in.offset = clean(in.offset, -kPi / 2, kPi / 2, 0);
  in.ior = clean(in.ior, 1.0001f, 1e3f, 1.55f);
  for (float* factor : {&in.reflection, &in.transmission, &in.secondary})
    *factor = clean(*factor, 0, 1e3f, 1);
  in.coverage = clean(in.coverage, 1e-4f, 1, 1);
  add(FacetHair{clean_color(weight), normal, in});
}

void Bsdf::add_glossy(const Rgb& weight, const Vec3& normal, Distribution d, float roughness,
                      float anisotropy, float rotation, const Vec3& tangent, const Rgb* color) {
  if (d == Distribution::kAshikhminShirley) {
    add(AshikhminShirley{clean_color(weight), normal,
                         clean_shape(d, roughness, anisotropy, rotation, tangent)});
    return;
  }
  FresnelTerms f;
  const Rgb mix = split_color(weight, color, &f.reflect_tint);
  add(Facet{mix, normal, clean_shape(d, roughness, anisotropy, rotation, tangent), f, false, true});
}

void Bsdf::add_glass(const Rgb& weight, const Vec3& normal, Distribution d, float roughness,
                     float ior, float film_thickness, float film_ior, const Rgb* color) {
  FresnelTerms f;
  const Rgb mix = split_color(weight, color, &f.reflect_tint);
  f.transmit_tint = f.reflect_tint;
  f.kind = FresnelKind::kDielectric;
  f.ior = clean(ior, 1e-5f, 1e5f, 1.45f);
  f.film_thickness = clean(film_thickness, 0, 1e5f, 0);
  f.film_ior = clean(film_ior, 1e-5f, 1e5f, 1.33f);
  add(Facet{mix, normal, clean_shape(d, roughness, 0, 0, {}), f, true, true});
}

void Bsdf::add_refraction(const Rgb& weight, const Vec3& normal, Distribution d, float roughness,
                          float ior) {
  FresnelTerms f;
  f.kind = FresnelKind::kDielectric;
  f.ior = clean(ior, 1e-5f, 1e5f, 1.45f);
  f.reflect_tint = {};
  f.transmit_tint = kWhite;
  add(Facet{clean_color(weight), normal,
            clean_shape(d == Distribution::kMultiGgx ? Distribution::kGgx : d, roughness, 0, 0, {}),
            f, true, false});
}

void Bsdf::add_metallic(const Rgb& weight, const Vec3& normal, Distribution d, float roughness,
                        float anisotropy, float rotation, const Vec3& tangent, bool physical,
                        const Rgb& base_or_ior, const Rgb& edge_or_extinction, float film_thickness,
                        float film_ior) {
  FresnelTerms f;
  if (physical) {
    f.kind = FresnelKind::kConductor;
    f.f0 = clean_color(base_or_ior);
    f.f90 = clean_color(edge_or_extinction);
  } else {
    f.kind = FresnelKind::kF82;
    f.f0 = min(clean_color(base_or_ior), kWhite);
    f.f90 = min(clean_color(edge_or_extinction), kWhite);
  }
  f.film_thickness = clean(film_thickness, 0, 1e5f, 0);
  f.film_ior = clean(film_ior, 1e-5f, 1e5f, 1.33f);
  FacetShape shape = clean_shape(d, roughness, 0, rotation, tangent);
  // As Principled's (Burley 2012)
  const float aspect = std::sqrt(1 - 0.9f * clean(anisotropy, 0, 1, 0));
  shape.along = 1 / aspect;
  shape.across = aspect;
  add(Facet{clean_color(weight), normal, shape, f, false, true});
}

}  // namespace photon_splat
