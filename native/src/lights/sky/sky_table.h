// The two scattering skies, each as a table in CIE XYZ that is denser towards the horizon.
#pragma once

#include <array>

#include "lights/sky/sky.h"

namespace photon_splat {

// Size of Blender's table: its interpolation is part of the look
inline constexpr int kSkyColumns = 512, kSkyRows = 256;

// Rows from the nadir to the zenith, columns of longitude from -180 degrees; XYZ as a vector.
std::vector<Vec3> single_scattering_table(const SkySettings& settings, ThreadPool& pool);
std::vector<Vec3> multiple_scattering_table(const SkySettings& settings, ThreadPool& pool);

// XYZ of the sun's disc at an elevation, for a disc of this solid angle.
Vec3 single_scattering_sun(const SkySettings& settings, float elevation, float solid_angle);
Vec3 multiple_scattering_sun(const SkySettings& settings, float elevation, float solid_angle);

}  // namespace photon_splat
