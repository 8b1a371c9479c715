// Interference in a film on a surface: Belcour & Barla 2017, "A practical extension to microfacet
// theory for the modeling of varying iridescence", with the colour from a table of the colour
// matching functions' Fourier transform.
#include <complex>
#include <memory>
#include <vector>

#include "bsdf/fresnel.h"
#include "math/spectrum.h"

namespace photon_splat {
namespace {

using Complex = std::complex<float>;

// The library's takes several times as long.
Complex divided(const Complex& a, const Complex& b) {
  const double re = a.real(), im = a.imag(), x = b.real(), y = b.imag(), norm = x * x + y * y;
  return {static_cast<float>((re * x + im * y) / norm),
          static_cast<float>((im * x - re * y) / norm)};
}

// Mean of exp(2 pi i d / wavelength) as linear RGB (Rec. 709) sees it, by the optical path
// difference d; 1 at d = 0. Each channel has unit area.
class Spectrum {
 public:
  static constexpr float kStep = 4, kLongest = 16000;  // nm; longer: no colour is left

  Spectrum() : table_(static_cast<size_t>(kLongest / kStep) + 2) {
    double area[3] = {};
    for (double l = 380; l < 780; l += 2) {
      const Rgb rgb = spectral_rgb(static_cast<float>(l));
      const std::complex<double> turn = std::polar(1.0, 2 * M_PI * double(kStep) / l);
      std::complex<double> now = 1;
      for (Entry& entry : table_) {
        for (int c = 0; c < 3; ++c) entry.rgb[c] += Complex(double(rgb[c]) * now);
        now *= turn;
      }
      for (int c = 0; c < 3; ++c) area[c] += rgb[c];
    }
    for (Entry& entry : table_)
      for (int c = 0; c < 3; ++c) entry.rgb[c] /= static_cast<float>(area[c]);
  }

  Complex at(float difference, int channel) const {
    const float f = difference / kStep;
    if (!(f < static_cast<float>(table_.size() - 1))) return 0;
    const auto i = static_cast<size_t>(f);
    const float t = f - static_cast<float>(i);
    return table_[i].rgb[channel] * (1 - t) + table_[i + 1].rgb[channel] * t;
  }

 private:
  struct Entry {
    Complex rgb[3];
  };
  std::vector<Entry> table_;
};

}  // namespace

Rgb film_reflectance(float cos_i, float thickness, float film, const Rgb& n, const Rgb& k,
                     const Rgb* under) {
  static const Spectrum spectrum;
  const float sin2 = 1 - sqr(cos_i), cos2 = 1 - sin2 / sqr(film);
  if (!(cos2 > 0)) return kWhite;
  const float c1 = std::sqrt(cos2), difference = 2 * film * thickness * c1;
  float out[3];
  for (int channel = 0; channel < 3; ++channel) {
    const Complex index(n[channel], k[channel]);
    const Complex c2 = std::sqrt(1.0f - divided(sin2, index * index));
    float sum = 0;
    for (int polarised = 0; polarised < 2; ++polarised) {
      const float r12 = polarised ? (film * cos_i - c1) / (film * cos_i + c1)
                                  : (cos_i - film * c1) / (cos_i + film * c1);
      Complex r23 = polarised ? divided(index * c1 - film * c2, index * c1 + film * c2)
                              : divided(film * c1 - index * c2, film * c1 + index * c2);
      if (under) r23 = std::polar(std::sqrt(saturate((*under)[channel])), std::arg(r23));
      // |r|^2 = 1 - T12 T23 / |1 + z exp(i delta)|^2, z = r12 r23; the fraction is a Poisson
      // kernel, sum of (-z)^m exp(i m delta).
      const Complex z = -r12 * r23;
      Complex power = 1;
      float series = 1;
      for (int m = 1; m < 16; ++m) {
        power *= z;
        if (std::norm(power) < 1e-7f) break;
        series += 2 * (power * spectrum.at(difference * static_cast<float>(m), channel)).real();
      }
      sum += (1 - sqr(r12)) * std::max(0.0f, 1 - std::norm(r23)) /
             std::max(1 - std::norm(z), 1e-6f) * series;
    }
    out[channel] = saturate(1 - 0.5f * sum);
  }
  return {out[0], out[1], out[2]};
}

}  // namespace photon_splat
