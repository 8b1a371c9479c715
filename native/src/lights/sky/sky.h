// Blender's Sky Texture as an image of all directions, and its sun.
#pragma once

#include "textures/texture.h"
#include "util/parallel.h"

namespace photon_splat {

enum class SkyModel {
  kSingleScattering,  // Nishita et al. 1993, "Display of the Earth taking into account atmospheric
                      // scattering"
  // Garcia Linan 2022, a fit of four wavelengths (fgarlin.com/posts/2024-12-06-spectral_sky)
  kMultipleScattering,
  kPreetham,    // Preetham et al. 1999, "A practical analytic model for daylight"
  kHosekWilkie  // Hosek and Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance"
};

struct SkySettings {
  SkyModel model = SkyModel::kSingleScattering;
  float sun_elevation = 0;                // radians
  float altitude = 0;                     // m
  float air = 1, aerosol = 1, ozone = 1;  // densities relative to those of the models
  float turbidity = 2.2f;                 // Preetham, Hosek and Wilkie
  float ground_albedo = 0.3f;             // Hosek and Wilkie
};

// Linear RGB, W/m^2/sr, equirectangular with the sun in the direction +X, without its disc. Width
// is even.
Texture sky_image(const SkySettings& settings, int width, int height, ThreadPool& pool);

// Radiance of the sun's disc at its lower and its upper edge, before limb darkening, and the
// elevation of the visible horizon.
struct SkySun {
  Rgb bottom{}, top{};
  float horizon = 0;
};
SkySun sky_sun(const SkySettings& settings, float angular_diameter);

}  // namespace photon_splat
