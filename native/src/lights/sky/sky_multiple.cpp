// Light scattered any number of times, at four wavelengths (630, 560, 490 and 430 nm): single
// scattering is integrated, what is scattered more often is a fit for the Earth's atmosphere, after
// F. Garcia Linan's Master's thesis (2022). Constants are those of Blender's Sky Texture, so that
// pictures agree. Lengths in km.
#include "lights/sky/sky_table.h"

namespace photon_splat {
namespace {

constexpr float kEarth = 6371, kThickness = 100, kAtmosphere = kEarth + kThickness;
constexpr int kSteps = 64;
constexpr int kCosines = 256, kAltitudes = 64;  // of the table of transmittances
constexpr float kGroundAlbedo = 0.3f, kAnisotropy = 0.8f, kIsotropic = 1 / (4 * kPi);

struct Four {
  float v[4] = {};
  Four() = default;
  Four(float a, float b, float c, float d) : v{a, b, c, d} {}
};
template <class F>
Four each(F&& f) {
  return {f(0), f(1), f(2), f(3)};
}

const Four kSun{1.679f, 1.828f, 1.986f, 1.307f};                        // irradiance, W/m^2/nm
const Four kAirScattering{6.605e-3f, 1.067e-2f, 1.842e-2f, 3.156e-2f};  // 1/km at sea level
const Four kOzone{3.472e-25f, 3.914e-25f, 1.349e-25f, 11.03e-27f};      // cross section, m^2
constexpr float kOzoneDobson = 334.5f;
const Four kAerosolAbsorption{2.8722e-24f, 4.6168e-24f, 7.9706e-24f, 1.3578e-23f};
const Four kAerosolScattering{1.5908e-22f, 1.7711e-22f, 2.0942e-22f, 2.4033e-22f};
constexpr float kAerosolDensity = 1.3681e20f, kAerosolBackground = 2e6f, kAerosolScale = 0.73f;
// Fit of light scattered more than once
const Four kOften{0.217f, 0.347f, 0.594f, 1.0f};
const Vec3 kToXyz[4] = {{53.386918f, 22.981338f, 0},
                        {43.904844f, 71.347796f, 0.10250687f},
                        {1.6137278f, 18.422961f, 31.742921f},
                        {20.762669f, 2.3614213f, 110.48010f}};

Vec3 to_xyz(const Four& spectrum) {
  Vec3 sum{};
  for (int i = 0; i < 4; ++i) sum += kToXyz[i] * spectrum.v[i];
  return sum;
}

// Distance to a sphere around the origin from within it, or to its near side from outside; -1:
// missed or behind.
float to_sphere(const Vec3& from, const Vec3& direction, float radius) {
  const float along = dot(from, direction), outside = length2(from) - radius * radius;
  const float inside2 = along * along - outside;
  if ((outside > 0 && along > 0) || inside2 < 0) return -1;
  return outside <= 0 ? -along + std::sqrt(inside2) : -along - std::sqrt(inside2);
}

class Atmosphere {
 public:
  explicit Atmosphere(const SkySettings& settings) : s_(settings) {}

  Four transmittance(float cosine, float altitude) const {
    const Vec3 from{0, 0, kEarth + altitude},
        direction{std::sqrt(std::max(0.0f, 1 - cosine * cosine)), 0, cosine};
    const float step = to_sphere(from, direction, kAtmosphere) / kSteps;
    Four depth;
    for (int i = 0; i < kSteps; ++i) {
      const Media m =
          media(length(from + direction * ((static_cast<float>(i) + 0.5f) * step)) - kEarth);
      for (int w = 0; w < 4; ++w) depth.v[w] += m.extinction.v[w] * step;
    }
    return each([&](int w) { return std::exp(-depth.v[w]); });
  }

  void tabulate(ThreadPool& pool) {
    table_.resize(kCosines * kAltitudes);
    pool.for_each(kAltitudes, CancelFlag(), [&](size_t row, int) {
      for (int x = 0; x < kCosines; ++x)
        table_[row * kCosines + x] =
            transmittance(2 * static_cast<float>(x) / (kCosines - 1) - 1,
                          kThickness * static_cast<float>(row) / (kAltitudes - 1));
    });
  }

  Four scattered(const Vec3& sun, const Vec3& from, const Vec3& direction, float distance) const {
    const float cosine = dot(direction, sun), g = kAnisotropy, step = distance / kSteps;
    const float air_phase = 3 / (16 * kPi) * (1 + cosine * cosine);
    const float aerosol_phase =
        kIsotropic * (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5f);
    Four sum, through{1, 1, 1, 1};
    for (int i = 0; i < kSteps; ++i) {
      const Vec3 at = from + direction * ((static_cast<float>(i) + 0.5f) * step);
      const float radius = length(at), altitude = std::max(radius - kEarth, 0.0f),
                  sun_cosine = dot(at, sun) / radius;
      const Media m = media(altitude);
      const Four direct = lookup(sun_cosine, altitude / kThickness),
                 often = multiple(sun_cosine, altitude / kThickness, radius);
      for (int w = 0; w < 4; ++w) {
        const float source =
            kSun.v[w] * (m.air.v[w] * (air_phase * direct.v[w] + often.v[w]) +
                         m.aerosol.v[w] * (aerosol_phase * direct.v[w] + often.v[w]));
        // The segment's integral for a constant source (Hillaire 2016).
        const float passed = std::exp(-step * m.extinction.v[w]);
        sum.v[w] += through.v[w] * source * (1 - passed) / std::max(m.extinction.v[w], 1e-7f);
        through.v[w] *= passed;
      }
    }
    return sum;
  }

 private:
  struct Media {
    Four air, aerosol, extinction;  // scattering, and everything that weakens a ray, 1/km
  };
  Media media(float height) const {
    const float h = std::max(height, 0.0f), log_h = std::log(std::max(h, 1e-4f));
    const float aerosols = s_.aerosol * kAerosolDensity *
                           (std::exp(-h / kAerosolScale) + kAerosolBackground / kAerosolDensity);
    const float off = log_h - 3.22261f;
    const float ozone =
        s_.ozone * kOzoneDobson * 3.78547397e20f * std::exp(-off * off * 5.55555555f - log_h);
    const float air = s_.air * std::exp(-0.07771971f * std::pow(h, 1.16364243f));
    Media m;
    for (int w = 0; w < 4; ++w) {
      m.air.v[w] = kAirScattering.v[w] * air;
      m.aerosol.v[w] = kAerosolScattering.v[w] * aerosols;
      m.extinction.v[w] =
          m.air.v[w] + m.aerosol.v[w] + kAerosolAbsorption.v[w] * aerosols + kOzone.v[w] * ozone;
    }
    return m;
  }

  Four lookup(float cosine, float altitude) const {
    const float x = std::clamp(0.5f * cosine + 0.5f, 0.0f, 1.0f) * (kCosines - 1),
                y = std::clamp(altitude, 0.0f, 1.0f) * (kAltitudes - 1);
    const int x0 = static_cast<int>(x), y0 = static_cast<int>(y),
              x1 = std::min(x0 + 1, kCosines - 1), y1 = std::min(y0 + 1, kAltitudes - 1);
    const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
    const auto at = [&](int column, int row, int w) {
      return table_[row * kCosines + column].v[w];
    };
    return each([&](int w) {
      return (at(x0, y0, w) * (1 - fx) + at(x1, y0, w) * fx) * (1 - fy) +
             (at(x0, y1, w) * (1 - fx) + at(x1, y1, w) * fx) * fy;
    });
  }

  // Per unit of scattering: light from the ground below, and from the rest of the atmosphere.
  Four multiple(float sun_cosine, float altitude, float radius) const {
    const float sine = kEarth / radius;
    const float ground_angle = 2 * kPi * (1 - std::sqrt(std::max(0.0f, 1 - sine * sine)));
    const Four sun_to_ground = lookup(sun_cosine, 0), all = lookup(1, 0),
               above = lookup(1, altitude);
    const float fit = 0.02f / (1 + 5 * std::exp(-17.92f * sun_cosine));
    return each([&](int w) {
      return kOften.v[w] * fit + kIsotropic * ground_angle * kGroundAlbedo / kPi *
                                     sun_to_ground.v[w] * all.v[w] / above.v[w] * sun_cosine;
    });
  }

  SkySettings s_;
  std::vector<Four> table_;
};

float altitude_of(const SkySettings& s) { return std::clamp(s.altitude, 1.0f, 99999.0f) / 1000; }

}  // namespace

std::vector<Vec3> multiple_scattering_table(const SkySettings& s, ThreadPool& pool) {
  Atmosphere atmosphere(s);
  atmosphere.tabulate(pool);
  std::vector<Vec3> table(kSkyColumns * kSkyRows);
  const Vec3 sun{-std::cos(s.sun_elevation), 0, std::sin(s.sun_elevation)},
      from{0, 0, kEarth + altitude_of(s)};
  pool.for_each(kSkyRows, CancelFlag(), [&](size_t row, int) {
    const float t = 2 * (static_cast<float>(row) + 0.5f) / kSkyRows - 1,
                elevation = std::copysign(t * t, t) * 0.5f * kPi;
    for (int column = 0; column < kSkyColumns / 2; ++column) {
      const float azimuth = 2 * kPi * (static_cast<float>(column) + 0.5f) / kSkyColumns;
      const Vec3 direction{std::cos(elevation) * std::cos(azimuth),
                           std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
      const float ground = to_sphere(from, direction, kEarth);
      const float distance = ground < 0 ? to_sphere(from, direction, kAtmosphere) : ground;
      const Vec3 xyz = to_xyz(atmosphere.scattered(sun, from, direction, distance));
      table[row * kSkyColumns + column] = table[row * kSkyColumns + kSkyColumns - 1 - column] = xyz;
    }
  });
  return table;
}

Vec3 multiple_scattering_sun(const SkySettings& s, float elevation, float solid_angle) {
  const Four through = Atmosphere(s).transmittance(std::sin(elevation), altitude_of(s));
  return to_xyz(each([&](int w) { return kSun.v[w] * through.v[w] / solid_angle; }));
}

}  // namespace photon_splat
