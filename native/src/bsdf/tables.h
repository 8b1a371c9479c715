// Directional albedos of rough surfaces, integrated numerically the first time each is asked for
// (some ms, any thread). roughness = sqrt(alpha), in [0, 1]; mu = cos of the angle to the normal;
// ior > 0 and not 1.
#pragma once

namespace photon_splat {

struct Albedo {
  float directional, mean;  // mean = 2 integral of directional(mu) mu dmu
};

// GGX without Fresnel: what single scattering between facets leaves of the light.
Albedo ggx_albedo(float roughness, float mu);

// Dielectric GGX, reflection and refraction together. ior = index behind over index before.
Albedo glass_albedo(float roughness, float mu, float ior);

// Mean of the dielectric's reflectance over the facets seen, mapped so that normal incidence is 0
// and grazing 1. Facets that mirror the view below the surface count as 0, and masking of the light
// is left out, as in Cycles (measured).
float dielectric_rise(float roughness, float mu, float ior);

}  // namespace photon_splat
