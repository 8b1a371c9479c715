// Light scattered once on its way from the sun to the eye (Nishita et al. 1993), at 21 wavelengths,
// in the Earth's atmosphere of air, aerosols and ozone. Constants are those of Blender's Sky
// Texture, so that pictures agree.
#include "lights/sky/sky_table.h"

namespace photon_splat {
namespace {

constexpr float kEarth = 6360e3f, kAtmosphere = 6420e3f;  // radii, m
// Heights over which densities fall to 1/e, m
constexpr float kAirScale = 8e3f, kAerosolScale = 1.2e3f;
constexpr float kAerosolScattering = 2e-5f;  // 1/m at sea level
constexpr float kAerosolExtinction = 1.11f * kAerosolScattering;
constexpr float kAnisotropy = 0.76f;
constexpr int kSegments = 32;
constexpr int kWavelengths = 21;  // 380 nm to 780 nm
constexpr float kStep = 20;       // nm

struct Wavelength {
  float irradiance;  // of the sun outside the atmosphere, W/m^2/nm
  float air, ozone;  // scattering and absorption at density 1, 1/m
  Vec3 xyz;          // CIE 1931 colour matching functions
};
constexpr Wavelength kSpectrum[kWavelengths] = {
    {1.45756830f, 5.42482009e-5f, 3.25126850e-9f, {0.001368f, 0.000039f, 0.006450001f}},
    {1.56596306f, 4.41854987e-5f, 5.85395365e-9f, {0.01431f, 0.000396f, 0.06785001f}},
    {1.65148449f, 3.63515191e-5f, 1.97719116e-8f, {0.13438f, 0.004f, 0.6456f}},
    {1.71496242f, 3.01792901e-5f, 7.30956876e-8f, {0.34828f, 0.023f, 1.74706f}},
    {1.75797983f, 2.52632023e-5f, 2.00845615e-7f, {0.2908f, 0.06f, 1.6692f}},
    {1.78256408f, 2.13085931e-5f, 4.03839581e-7f, {0.09564f, 0.13902f, 0.8129501f}},
    {1.79095108f, 1.80983803e-5f, 6.35513359e-7f, {0.0049f, 0.323f, 0.272f}},
    {1.78541550f, 1.54705713e-5f, 9.67070412e-7f, {0.06327f, 0.71f, 0.07824999f}},
    {1.76815555f, 1.33028498e-5f, 1.54797400e-6f, {0.2904f, 0.954f, 0.0203f}},
    {1.74122070f, 1.15018478e-5f, 2.09038647e-6f, {0.5945f, 0.995f, 0.0039f}},
    {1.70647127f, 9.99557430e-6f, 2.46128056e-6f, {0.9163f, 0.87f, 0.001650001f}},
    {1.66556087f, 8.72799974e-6f, 2.73551299e-6f, {1.0622f, 0.631f, 0.0008f}},
    {1.61993237f, 7.65513701e-6f, 2.15125863e-6f, {0.8544499f, 0.381f, 0.00019f}},
    {1.57083597f, 6.74217204e-6f, 1.59051841e-6f, {0.4479f, 0.175f, 0.00002f}},
    {1.51932335f, 5.96134126e-6f, 1.12356198e-6f, {0.1649f, 0.061f, 0}},
    {1.46628495f, 5.29034598e-6f, 7.35275515e-7f, {0.04677f, 0.017f, 0}},
    {1.41245853f, 4.71115688e-6f, 4.64501304e-7f, {0.01135916f, 0.004102f, 0}},
    {1.35844962f, 4.20910481e-6f, 3.30960799e-7f, {0.002899327f, 0.001047f, 0}},
    {1.30474914f, 3.77218381e-6f, 2.25126123e-7f, {0.0006900786f, 0.0002492f, 0}},
    {1.25174963f, 3.39051255e-6f, 1.48791293e-7f, {0.0001661505f, 0.00006f, 0}},
    {1.19975999f, 3.05591532e-6f, 1.68286234e-7f, {0.00004150994f, 0.00001499f, 0}}};

// Gauss-Laguerre nodes of order 8 over 25, weights times e^node over 25: densities fall
// exponentially along a ray.
constexpr float kNodes[8] = {0.006811185292f, 0.03614807107f, 0.09004346519f, 0.1706680068f,
                             0.2818362161f,   0.4303406404f,  0.6296271457f,  0.9145252695f};
constexpr float kWeights[8] = {0.01750893642f, 0.04135477391f, 0.06678839063f, 0.09507698807f,
                               0.1283416365f,  0.1707430204f,  0.2327233347f,  0.3562490486f};

// Densities of air, aerosols and ozone, as the components of a vector.
Vec3 densities(float height) {
  return {std::exp(-height / kAirScale), std::exp(-height / kAerosolScale),
          std::max(0.0f, 1 - std::abs(height - 25000) / 15000)};
}

float to_sphere(const Vec3& from, const Vec3& direction, float radius) {
  const float along = dot(from, direction);
  return -along + std::sqrt(std::max(0.0f, along * along - length2(from) + radius * radius));
}

Vec3 depth_to_space(const Vec3& from, const Vec3& direction) {
  const float length_of_ray = to_sphere(from, direction, kAtmosphere);
  Vec3 depth{};
  for (int i = 0; i < 8; ++i)
    depth +=
        densities(length(from + direction * (kNodes[i] * length_of_ray)) - kEarth) * kWeights[i];
  return depth * length_of_ray;
}

bool earth_blocks(const Vec3& from, const Vec3& direction) {
  const float along = dot(from, direction);
  return direction.z < 0 && along * along - length2(from) + kEarth * kEarth >= 0;
}

Vec3 eye(const SkySettings& s) { return {0, 0, kEarth + std::clamp(s.altitude, 1.0f, 59999.0f)}; }

Vec3 scattered_once(const SkySettings& s, const Vec3& direction, const Vec3& sun) {
  const Vec3 scale{s.air, s.aerosol, s.ozone}, from = eye(s);
  const float step = to_sphere(from, direction, kAtmosphere) / kSegments;
  const float cosine = dot(direction, sun), g2 = kAnisotropy * kAnisotropy;
  const float air_phase = 3 / (16 * kPi) * (1 + cosine * cosine);
  const float aerosol_phase =
      3 * (1 - g2) * (1 + cosine * cosine) /
      (8 * kPi * (2 + g2) * std::pow(1 + g2 - 2 * kAnisotropy * cosine, 1.5f));
  Vec3 depth{};
  float spectrum[kWavelengths] = {};
  for (int i = 0; i < kSegments; ++i) {
    const Vec3 at = from + direction * ((static_cast<float>(i) + 0.5f) * step);
    const Vec3 here = scale * densities(length(at) - kEarth);
    depth += here * step;
    if (earth_blocks(at, sun)) continue;
    const Vec3 whole = depth + scale * depth_to_space(at, sun);
    for (int w = 0; w < kWavelengths; ++w) {
      const Wavelength& l = kSpectrum[w];
      const float through =
          std::exp(-(whole.x * l.air + whole.y * kAerosolExtinction + whole.z * l.ozone));
      spectrum[w] += through *
                     (air_phase * here.x * l.air + aerosol_phase * here.y * kAerosolScattering) *
                     l.irradiance * step;
    }
  }
  Vec3 xyz{};
  for (int w = 0; w < kWavelengths; ++w) xyz += kSpectrum[w].xyz * spectrum[w];
  return xyz * kStep;
}

}  // namespace

std::vector<Vec3> single_scattering_table(const SkySettings& s, ThreadPool& pool) {
  std::vector<Vec3> table(kSkyColumns * kSkyRows);
  const Vec3 sun{std::cos(s.sun_elevation), 0, std::sin(s.sun_elevation)};
  constexpr int half = kSkyRows / 2;
  pool.for_each(half - 1, CancelFlag(), [&](size_t row_above, int) {  // the lower half stays black
    const int row = half + 1 + static_cast<int>(row_above);
    const float t = static_cast<float>(row) / half - 1, latitude = 0.5f * kPi * t * t;
    for (int column = 0; column < kSkyColumns / 2; ++column) {
      const float longitude = 2 * kPi / kSkyColumns * static_cast<float>(column) - kPi;
      const Vec3 direction{std::cos(latitude) * std::cos(longitude),
                           std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
      table[row * kSkyColumns + column] = table[row * kSkyColumns + kSkyColumns - 1 - column] =
          scattered_once(s, direction, sun);
    }
  });
  return table;
}

Vec3 single_scattering_sun(const SkySettings& s, float elevation, float solid_angle) {
  const float e = std::max(elevation, 0.0f);
  const Vec3 depth = depth_to_space(eye(s), {std::cos(e), 0, std::sin(e)});
  Vec3 xyz{};
  for (const Wavelength& l : kSpectrum)
    xyz +=
        l.xyz * (l.irradiance *
                 std::exp(-(l.air * depth.x * s.air + kAerosolExtinction * depth.y * s.aerosol)));
  return xyz * (kStep / solid_angle);
}

}  // namespace photon_splat
