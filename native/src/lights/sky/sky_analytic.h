// The two skies that are formulas of a direction and of the sun's, in CIE XYZ.
#pragma once

#include <functional>

#include "lights/sky/sky.h"

namespace photon_splat {

inline bool is_analytic(SkyModel model) {
  return model == SkyModel::kPreetham || model == SkyModel::kHosekWilkie;
}

// XYZ in a direction, the sun above +X. Below the horizon it is the horizon's.
using AnalyticSky = std::function<Vec3(const Vec3& direction)>;

// Empty for other models.
AnalyticSky analytic_sky(const SkySettings& settings);

}  // namespace photon_splat
