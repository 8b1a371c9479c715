#include "lights/sky/sky.h"

#include "lights/sky/sky_table.h"

namespace photon_splat {
namespace {

Rgb to_rgb(const Vec3& c) {  // CIE XYZ to linear Rec. 709, D65
  return max(Vec3{3.2404542f * c.x - 1.5371385f * c.y - 0.4985314f * c.z,
                  -0.9692660f * c.x + 1.8760108f * c.y + 0.0415560f * c.z,
                  0.0556434f * c.x - 0.2040259f * c.y + 1.0572252f * c.z},
             Vec3{});
}

// Bilinear, longitude wraps; u, v in 0..1 of the table.
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

// Preetham et al. 1999, appendix: xyY from the zenith's by Perez' formula.
class Preetham {
 public:
  explicit Preetham(const SkySettings& s) : sun_(0.5f * kPi - s.sun_elevation) {
    const float t = s.turbidity, a = sun_, a2 = a * a, a3 = a2 * a;
    const float chi = (4.0f / 9 - t / 120) * (kPi - 2 * a);
    const float zenith[3] = {
        ((4.0453f * t - 4.9710f) * std::tan(chi) - 0.2155f * t + 2.4192f) * 0.06f,
        (0.00166f * a3 - 0.00375f * a2 + 0.00209f * a) * t * t +
            (-0.02903f * a3 + 0.06377f * a2 - 0.03202f * a + 0.00394f) * t +
            (0.11693f * a3 - 0.21196f * a2 + 0.06052f * a + 0.25886f),
        (0.00275f * a3 - 0.00610f * a2 + 0.00317f * a) * t * t +
            (-0.04214f * a3 + 0.08970f * a2 - 0.04153f * a + 0.00516f) * t +
            (0.15346f * a3 - 0.26756f * a2 + 0.06670f * a + 0.26688f)};
    const float slope[3][5] = {{0.1787f, -0.3554f, -0.0227f, 0.1206f, -0.0670f},
                               {-0.0193f, -0.0665f, -0.0004f, -0.0641f, -0.0033f},
                               {-0.0167f, -0.0950f, -0.0079f, -0.0441f, -0.0109f}};
    const float offset[3][5] = {{-1.4630f, 0.4275f, 5.3251f, -2.5771f, 0.3703f},
                                {-0.2592f, 0.0008f, 0.2125f, -0.8989f, 0.0452f},
                                {-0.2608f, 0.0092f, 0.2102f, -1.6537f, 0.0529f}};
    for (int c = 0; c < 3; ++c) {
      for (int i = 0; i < 5; ++i) k_[c][i] = slope[c][i] * t + offset[c][i];
      zenith_[c] = zenith[c] / perez(c, 0, sun_);
    }
  }

  Vec3 xyz(const Vec3& d, const Vec3& sun) const {
    // The horizon's below it
    const float theta = std::min(std::acos(std::clamp(d.z, -1.0f, 1.0f)), 0.5f * kPi - 0.001f);
    const float gamma = std::acos(std::clamp(dot(d, sun), -1.0f, 1.0f));
    const float luminance = zenith_[0] * perez(0, theta, gamma),
                x = zenith_[1] * perez(1, theta, gamma), y = zenith_[2] * perez(2, theta, gamma);
    if (!(y > 0)) return {};
    return {x / y * luminance, luminance, (1 - x - y) / y * luminance};
  }

 private:
  float perez(int c, float theta, float gamma) const {
    const float* k = k_[c];
    const float cosine = std::cos(gamma);
    return (1 + k[0] * std::exp(k[1] / std::cos(theta))) *
           (1 + k[2] * std::exp(k[3] * gamma) + k[4] * cosine * cosine);
  }

  float sun_, k_[3][5], zenith_[3];
};

}  // namespace

Texture sky_image(const SkySettings& s, int width, int height, ThreadPool& pool) {
  Texture image;
  image.width = width;
  image.height = height;
  image.floats.assign(size_t{4} * width * height, 1.0f);
  std::vector<Vec3> table;
  if (s.model == SkyModel::kSingleScattering) table = single_scattering_table(s, pool);
  if (s.model == SkyModel::kMultipleScattering) table = multiple_scattering_table(s, pool);
  const Preetham preetham(s);
  const Vec3 sun{std::cos(s.sun_elevation), 0, std::sin(s.sun_elevation)};
  pool.for_each(height, CancelFlag(), [&](size_t row, int) {
    const float latitude =
        ((static_cast<float>(row) + 0.5f) / static_cast<float>(height) - 0.5f) * kPi;
    const float v =
        std::copysign(std::sqrt(std::abs(latitude) / (0.5f * kPi)), latitude) * 0.5f + 0.5f;
    for (int column = 0; column < width; ++column) {
      // The sun is in the middle
      const float u = (static_cast<float>(column) + 0.5f) / static_cast<float>(width);
      Rgb color;
      if (s.model == SkyModel::kPreetham) {
        const float longitude = (0.5f - u) * 2 * kPi;
        color = to_rgb(preetham.xyz({std::cos(latitude) * std::cos(longitude),
                                     std::cos(latitude) * std::sin(longitude), std::sin(latitude)},
                                    sun));
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
  if (s.model == SkyModel::kPreetham || !(solid_angle > 0)) return sun;
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
