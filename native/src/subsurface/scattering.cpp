#include "subsurface/scattering.h"

#include "bsdf/fresnel.h"

namespace photon_splat {
namespace {

constexpr float kMostAlbedo = 0.999999f;
// Darker media are walked in as this one, and their light scaled: as Cycles does
constexpr float kLeastAlbedo = 0.2f;

// Inversion of van de Hulst's reflectance of a half-space, fit by d'Eon (A Hitchhiker's Guide to
// Multiple Scattering, v0.3.2, equation 53.7).
float van_de_hulst(float color, float g) {
  const float s =
      4.20863f * color - std::sqrt(9.59217f + (41.6808f + 17.7126f * color) * color) + 4.09712f;
  const float s2 = sqr(s), below = 1 - g * s2;
  return below != 0 ? (1 - s2) / below : 0;
}

// Inversion for g >= 0, fit by Wrenninge, Villemin and Hery (Path Traced Subsurface Scattering
// using Anisotropic Phase Functions and Non-Exponential Free Flights, 2017), with the coefficients
// that Cycles has.
float wrenninge(float color, float g) {
  const auto polynomial = [g](const auto&... c) {
    const float all[] = {c...};
    float sum = 0;
    for (size_t i = sizeof...(c); i-- > 0;) sum = sum * g + all[i];
    return sum;
  };
  const float a = polynomial(1.8260523782f, -1.28451056436f, -1.79904629312f, 9.19393289202f,
                             -22.8215585862f, 32.0234874259f, -23.6264803333f, 7.21067002658f);
  const float b =
      4.98511194385f +
      0.127355959438f *
          std::exp(polynomial(0.0f, 31.1491581433f, -201.847017512f, 841.576016723f,
                              -2018.09288505f, 2731.71560286f, -1935.41424244f, 559.009054474f));
  const float c = polynomial(1.09686102424f, -0.394704063468f, 1.05258115941f, -8.83963712726f,
                             28.8643230661f, -46.8802913581f, 38.5402837518f, -12.7181042538f);
  const float d = polynomial(0.496310210422f, 0.360146581622f, -2.15139309747f, 17.8896899217f,
                             -55.2984010333f, 82.065982243f, -58.5106008578f, 15.8478295021f);
  const float e =
      4.23190299701f +
      0.00310603949088f *
          std::exp(polynomial(0.0f, 76.7316253952f, -594.356773233f, 2448.8834203f, -5576.68528998f,
                              7116.60171912f, -4763.54467887f, 1303.5318055f));
  const float f = polynomial(2.40602999408f, -2.51814844609f, 9.18494908356f, -79.2191708682f,
                             259.082868209f, -403.613804597f, 302.85712436f, -87.4370473567f);
  const float blend = std::pow(color, 0.25f);
  return (1 - blend) * a * std::pow(std::atan(b * color), c) +
         blend * d * std::pow(std::atan(e * color), f);
}

}  // namespace

Scattering Scattering::reduced() const {
  const Rgb scattered = scattering() * (1 - g), all = extinction - scattering() + scattered;
  return {all, divided(scattered, all), 0, factor};
}

Scattering scattering_of(const Subsurface& closure) {
  const float g = closure.anisotropy;
  const bool older = closure.method != SubsurfaceMethod::kRandomWalk && g >= 0;
  float extinction[3], albedo[3], factor[3];
  for (int i = 0; i < 3; ++i) {
    const float color = closure.albedo[i];
    const float found = older ? wrenninge(color, g) : van_de_hulst(color, g);
    const float single = found == found ? std::clamp(found, 0.0f, kMostAlbedo) : 0;
    albedo[i] = std::max(single, kLeastAlbedo);
    factor[i] = color > 0 ? single / albedo[i] / color : 0;
    extinction[i] = 1 / (std::max(closure.radius[i], 1e-16f) * (older ? 1 - g : 1));
  }
  return {{extinction[0], extinction[1], extinction[2]},
          {albedo[0], albedo[1], albedo[2]},
          g,
          {factor[0], factor[1], factor[2]}};
}

}  // namespace photon_splat
