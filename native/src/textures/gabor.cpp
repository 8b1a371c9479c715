// Gabor noise (Lagae et al. 2009, "Procedural noise using sparse Gabor convolution") as phasors
// (Tricard et al. 2019, "Procedural phasor noise"): eight impulses in every cell, windowed to their
// unit ball.
#include "shading/frame.h"
#include "textures/hashes.h"

namespace photon_splat::nodes {
namespace {

constexpr int kImpulses = 8;

struct Phasor {
  float x = 0, y = 0;

  void add(float r2, float cycles, float weight) {  // an impulse sqrt(r2) away
    const float envelope = weight * std::exp(-kPi * r2) * (0.5f + 0.5f * std::cos(kPi * r2));
    x += envelope * std::cos(2 * kPi * cycles);
    y += envelope * std::sin(2 * kPi * cycles);
  }
};

Phasor noise_2d(float px, float py, float frequency, float isotropy, float orientation) {
  const float cx = std::floor(px), cy = std::floor(py);
  Phasor sum;
  for (float j = -1; j <= 1; ++j)
    for (float i = -1; i <= 1; ++i) {
      const float kx = cx + i, ky = cy + j, lx = px - cx - i, ly = py - cy - j;
      for (int n = 0; n < kImpulses; ++n) {
        const float seed = static_cast<float>(3 * n);
        const float x = lx - random_of(kx, ky, seed + 1), y = ly - random_of(seed + 1, kx, ky);
        const float r2 = x * x + y * y;
        if (!(r2 < 1)) continue;
        const float angle = orientation + (random_of(kx, ky, seed) - 0.5f) * kPi * isotropy;
        const float weight = random_of(kx, ky, seed + 2) < 0.5f ? -1.0f : 1.0f;
        sum.add(r2, frequency * (x * std::cos(angle) + y * std::sin(angle)), weight);
      }
    }
  return sum;
}

Phasor noise_3d(const Vec3& p, float frequency, float isotropy, const Vec3& orientation) {
  const Vec3 cell = each(p, [](float c) { return std::floor(c); });
  const float inclination = std::acos(std::clamp(orientation.z, -1.0f, 1.0f));
  const float flat = std::sqrt(orientation.x * orientation.x + orientation.y * orientation.y);
  const float azimuth =
      (orientation.y < 0 ? -1.0f : 1.0f) * std::acos(std::clamp(orientation.x / flat, -1.0f, 1.0f));
  Phasor sum;
  for (float k = -1; k <= 1; ++k)
    for (float j = -1; j <= 1; ++j)
      for (float i = -1; i <= 1; ++i) {
        const Vec3 c = cell + Vec3{i, j, k}, local = p - cell - Vec3{i, j, k};
        for (int n = 0; n < kImpulses; ++n) {
          const float seed = static_cast<float>(3 * n);
          const Vec3 d = local - random_color(c.x, c.y, c.z, seed + 1);
          const float r2 = length2(d);
          if (!(r2 < 1)) continue;
          Vec3 axis = orientation;
          if (isotropy != 0) {
            const float theta = inclination + random_of(c.x, c.y, c.z, seed) * kPi * isotropy;
            const float phi = azimuth + random_of(c.z, c.x, seed, c.y) * kPi * isotropy;
            axis = {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                    std::cos(theta)};
          }
          const float weight = random_of(c.x, c.y, c.z, seed + 2) < 0.5f ? -1.0f : 1.0f;
          sum.add(r2, frequency * dot(d, axis), weight);
        }
      }
  return sum;
}

}  // namespace

void gabor_texture(Frame& f, const uint32_t* w) {
  const Vec3 p = f.vector(w[3]) * f.number(w[4]);
  const float frequency = std::max(0.001f, f.number(w[5])),
              isotropy = 1 - clamp_unit(f.number(w[6]));
  const bool flat = f.mode<GaborType>(w[9]) == GaborType::D2;
  const Phasor sum = flat ? noise_2d(p.x, p.y, frequency, isotropy, f.number(w[7]))
                          : noise_3d(p, frequency, isotropy, normalize(f.vector(w[8])));
  // Impulses times their mean square 1/2 times the integral of the squared kernel; six deviations
  // span the range.
  const float integral = flat ? 0.25f : 0.17677670f;
  const float range = 6 * std::sqrt(kImpulses * 0.5f * integral);
  f.set(w[0], sum.y / range * 0.5f + 0.5f);
  f.set(w[1], (std::atan2(sum.y, sum.x) + kPi) / (2 * kPi));
  f.set(w[2], std::sqrt(sum.x * sum.x + sum.y * sum.y) / range);
}

}  // namespace photon_splat::nodes
