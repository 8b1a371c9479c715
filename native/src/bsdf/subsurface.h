// Light that goes below a surface and leaves it elsewhere, as a closure: what of it does so, and
// how far it gets. subsurface/walk.h says where it leaves. The methods are those of Cycles 5.2.
#pragma once

#include "math/vec.h"

namespace photon_splat {

enum class SubsurfaceMethod : uint8_t { kBurley, kRandomWalk, kRandomWalkLegacy, kRandomWalkSkin };

// Which closures a Bsdf keeps as such. The others are diffuse.
enum class SubsurfaceUse : uint8_t { kNone, kWalks, kAll };

struct SubsurfaceInputs {
  SubsurfaceMethod method = SubsurfaceMethod::kRandomWalk;
  Rgb color{0.8f, 0.8f, 0.8f};  // albedo of a flat, deep body
  Rgb radius{};                 // m, in world space
  float ior = 1.4f, anisotropy = 0;
  float alpha = 1;  // of the facets that light enters by
  Vec3 normal;      // on the geometric front
};

struct Subsurface {
  Rgb weight;  // of what leaves; `albedo` is part of it
  Rgb albedo;
  // m: mean free path, reduced for the older walks; Burley: the profile's d
  Rgb radius;
  Vec3 n;  // on the side of wo
  float ior, alpha, anisotropy;
  SubsurfaceMethod method;
};

}  // namespace photon_splat
