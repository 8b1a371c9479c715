#pragma once

#include "bsdf/bsdf.h"

namespace photon_splat {

// Inputs made finite and brought into the range that Cycles keeps them in.
void make_clean(PrincipledInputs& inputs);
void make_clean(SubsurfaceInputs& inputs);

// The Principled BSDF of Blender 4 and 5 as layers: sheen over coat over emission over a mix of
// metal, glass and dielectric over diffuse. A layer lets through what it does not reflect.
void expand_principled(const Rgb& weight, const PrincipledInputs& inputs, const View& view,
                       SubsurfaceUse use, LobeList& out);

void expand_subsurface(const Rgb& weight, const SubsurfaceInputs& inputs, const View& view,
                       SubsurfaceUse use, LobeList& out);

// x within [low, high], or `otherwise` where it is not finite.
inline float clean(float x, float low, float high, float otherwise) {
  return std::isfinite(x) ? std::clamp(x, low, high) : otherwise;
}
inline Rgb clean_color(const Rgb& c) {
  constexpr float most = 1e10f;  // products of three must stay finite
  return {clean(c.x, 0, most, 0), clean(c.y, 0, most, 0), clean(c.z, 0, most, 0)};
}

}  // namespace photon_splat
