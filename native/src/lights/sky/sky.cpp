#include "lights/sky/sky.h"

#include "lights/sky/sky_analytic.h"
#include "lights/sky/sky_table.h"

namespace photon_splat {
namespace {

Rgb to_rgb(const Vec3& c) {  // CIE XYZ to linear Rec. 709, D65
  return max(Vec3{3.2404542f * c.x - 1.5371385f * c.y - 0.4985314f * c.z,
                  -0.9692660f * c.x + 1.8760108f * c.y + 0.0415560f * c.z,
                  0.0556434f * c.x - 0.2040259f * c.y + 1.0572252f * c.z},
             Vec3{});
}

// Bilinear lookup; longitude wraps; u, v in 0..1 of the table.
Vec3 at(const std::vector<Vec3>& table, float u, float v) {
  const float x = u * kSkyColumns - 0.5f, y = v * kSkyRows - 0.5f, fx = std::floor(x),
              fy = std::floor(y);
  const auto texel = [&](int column, int row) {
    return table[std::clamp(row, 0, kSkyRows - 1) * kSkyColumns +
                 ((column % kSkyColumns) + kSkyColumns) % kSkyColumns];
  };
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const float s = x - fx, t = y - fy;
  return (texel(ix, iy) * (1 - s) + texel(ix + 1, iy) * s) * (1 - t) +
         (texel(ix, iy + 1) * (1 - s) + texel(ix + 1, iy + 1) * s) * t;
}

}  // namespace

Texture sky_image(const SkySettings& s, int width, int height, ThreadPool& pool) {
  Texture image;
  image.width = width;
  image.height = height;
  image.floats.assign(size_t{4} * width * height, 1.0f);
  std::vector<Vec3> table;
  if (s.model == SkyModel::kSingleScattering) table = single_scattering_table(s, pool);
  if (s.model == SkyModel::kMultipleScattering) table = multiple_scattering_table(s, pool);
  const AnalyticSky analytic = analytic_sky(s);
  pool.for_each(height, CancelFlag(), [&](size_t row, int) {
    const float latitude =
        ((static_cast<float>(row) + 0.5f) / static_cast<float>(height) - 0.5f) * kPi;
    const float v =
        std::copysign(std::sqrt(std::abs(latitude) / (0.5f * kPi)), latitude) * 0.5f + 0.5f;
    for (int column = 0; column < width; ++column) {
      // The sun is in the middle
      const float u = (static_cast<float>(column) + 0.5f) / static_cast<float>(width);
      Rgb color;
      if (analytic) {
        const float longitude = (0.5f - u) * 2 * kPi;
        color = to_rgb(analytic({std::cos(latitude) * std::cos(longitude),
                                 std::cos(latitude) * std::sin(longitude), std::sin(latitude)}));
      } else if (s.model == SkyModel::kSingleScattering && latitude < 0) {
        // Blender lets the horizon's colour fade out
        const float fade = std::max(0.0f, 1 + 2.5f * std::sin(latitude));
        color = fade > 0 ? to_rgb(at(table, u, 0.508f)) * (fade * fade * fade) : Rgb{};
      } else {
        color = to_rgb(at(table, u, v));
      }
      float* p = &image.floats[4 * (row * width + column)];
      for (int c = 0; c < 3; ++c) p[c] = std::isfinite(color[c]) ? color[c] : 0;
    }
  });
  return image;
}

SkySun sky_sun(const SkySettings& s, float angular_diameter) {
  SkySun sun;
  const float half = 0.5f * angular_diameter, sine = std::sin(0.5f * half),
              solid_angle = 4 * kPi * sine * sine;
  if (is_analytic(s.model) || !(solid_angle > 0)) return sun;
  if (s.model == SkyModel::kMultipleScattering) {
    constexpr float kEarth = 6371;  // km
    sun.horizon = std::asin(kEarth / (kEarth + s.altitude / 1000)) - 0.5f * kPi;
    sun.bottom = to_rgb(multiple_scattering_sun(s, s.sun_elevation - half, solid_angle));
    sun.top = to_rgb(multiple_scattering_sun(s, s.sun_elevation + half, solid_angle));
  } else if (s.sun_elevation + half > 0) {
    sun.bottom = to_rgb(single_scattering_sun(s, s.sun_elevation - half, solid_angle));
    sun.top = to_rgb(single_scattering_sun(s, s.sun_elevation + half, solid_angle));
  }
  return sun;
}

}  // namespace photon_splat
