#include "lights/sky/sky_analytic.h"

namespace photon_splat {
namespace {

// Lumens of a watt at 555 nm
constexpr float kEfficacy = 683;

// Angles of a direction, radians
struct Angles {
  float from_zenith, from_sun;
};

// Preetham et al. 1999, appendix: xyY from the zenith's by Perez' formula.
class Preetham {
 public:
  static float sun(float elevation) { return elevation; }
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

  Vec3 operator()(const Angles& angles) const {
    const float theta = angles.from_zenith, gamma = angles.from_sun;
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

constexpr int kTurbidities = 10, kControls = 6, kTerms = 9;
struct HosekTable {
  // By channel, albedo of the ground 0 and 1, turbidity from 1, and control point
  double terms[3][2][kTurbidities][kControls][kTerms];
  double radiance[3][2][kTurbidities][kControls];
};
constexpr HosekTable kHosek{
#include "lights/sky/hosek_table.inc"
};

// Hosek and Wilkie 2012, "An Analytic Model for Full Spectral Sky-Dome Radiance": equation 8, whose
// terms are quintic Bezier curves of the sun's elevation, and linear in turbidity and albedo.
class HosekWilkie {
 public:
  // Where Blender has it: not below the horizon
  static float sun(float elevation) { return std::clamp(elevation, 0.0f, 0.5f * kPi); }
  explicit HosekWilkie(const SkySettings& s) {
    const double turbidity = std::clamp(double{s.turbidity}, 1.0, double{kTurbidities});
    const double albedo = std::clamp(double{s.ground_albedo}, 0.0, 1.0);
    const int low = std::min(static_cast<int>(turbidity), kTurbidities - 1) - 1;
    const double up = turbidity - 1 - low;
    const double x = std::cbrt(double{sun(s.sun_elevation)} / (0.5 * double{kPi})), y = 1 - x;
    const double bezier[kControls] = {y * y * y * y * y,      5 * y * y * y * y * x,
                                      10 * y * y * y * x * x, 10 * y * y * x * x * x,
                                      5 * y * x * x * x * x,  x * x * x * x * x};
    for (int c = 0; c < 3; ++c)
      for (int ground = 0; ground < 2; ++ground)
        for (int above = 0; above < 2; ++above)
          for (int k = 0; k < kControls; ++k) {
            const double share = (ground ? albedo : 1 - albedo) * (above ? up : 1 - up) * bezier[k];
            for (int i = 0; i < kTerms; ++i)
              terms_[c][i] += share * kHosek.terms[c][ground][low + above][k][i];
            radiance_[c] += share * kHosek.radiance[c][ground][low + above][k];
          }
  }

  Vec3 operator()(const Angles& angles) const {
    const double cosine = std::cos(double{angles.from_zenith}), gamma = angles.from_sun,
                 to_sun = std::cos(gamma);
    float xyz[3];
    for (int c = 0; c < 3; ++c) {
      const double* t = terms_[c];
      const double mie = (1 + to_sun * to_sun) / std::pow(1 + t[8] * t[8] - 2 * t[8] * to_sun, 1.5);
      const double relative = (1 + t[0] * std::exp(t[1] / (cosine + 0.01))) *
                              (t[2] + t[3] * std::exp(t[4] * gamma) + t[5] * to_sun * to_sun +
                               t[6] * mie + t[7] * std::sqrt(cosine));
      // Scaled as Blender scales it
      xyz[c] = static_cast<float>(relative * radiance_[c]) * (2 * kPi / kEfficacy);
    }
    return {xyz[0], xyz[1], xyz[2]};
  }

 private:
  double terms_[3][kTerms] = {}, radiance_[3] = {};
};

template <class Model>
AnalyticSky about(const SkySettings& settings) {
  const float elevation = Model::sun(settings.sun_elevation);
  const Vec3 sun{std::cos(elevation), 0, std::sin(elevation)};
  return [model = Model(settings), sun](const Vec3& d) {
    const auto angle = [](float cosine) { return std::acos(std::clamp(cosine, -1.0f, 1.0f)); };
    return model({std::min(angle(d.z), 0.5f * kPi - 0.001f), angle(dot(d, sun))});
  };
}

}  // namespace

AnalyticSky analytic_sky(const SkySettings& settings) {
  if (settings.model == SkyModel::kPreetham) return about<Preetham>(settings);
  if (settings.model == SkyModel::kHosekWilkie) return about<HosekWilkie>(settings);
  return {};
}

}  // namespace photon_splat
