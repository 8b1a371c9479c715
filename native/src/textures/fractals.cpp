// Fractals by Musgrave, from the noise of their octaves.
#include "shading/frame.h"
#include "textures/noise.h"

namespace photon_splat::nodes {
namespace {

float fbm(const float* noise, const FractalSettings& s) {
  float amplitude = 1, total = 0, sum = 0;
  const int n = s.detail;
  for (int i = 0; i <= n; ++i) {
    sum += noise[i] * amplitude;
    total += amplitude;
    amplitude *= s.roughness;
  }
  const auto finished = [&](float x, float weight) {
    return s.normalize ? 0.5f * x / weight + 0.5f : x;
  };
  const float rest = s.part;
  if (rest == 0) return finished(sum, total);
  return mix(finished(sum, total), finished(sum + noise[n + 1] * amplitude, total + amplitude),
             rest);
}

float multifractal(const float* noise, const FractalSettings& s) {
  float value = 1, power = 1;
  const int n = s.detail;
  for (int i = 0; i <= n; ++i) {
    value *= power * noise[i] + 1;
    power *= s.roughness;
  }
  const float rest = s.part;
  return rest == 0 ? value : value * (rest * power * noise[n + 1] + 1);
}

float hetero_terrain(const float* noise, const FractalSettings& s) {
  float power = s.roughness, value = s.offset + noise[0];
  const int n = s.detail;
  for (int i = 1; i <= n; ++i) {
    value += (noise[i] + s.offset) * power * value;
    power *= s.roughness;
  }
  const float rest = s.part;
  return rest == 0 ? value : value + rest * (noise[n + 1] + s.offset) * power * value;
}

float hybrid_multifractal(const float* noise, const FractalSettings& s) {
  float power = 1, value = 0, weight = 1;
  const int n = s.detail;
  for (int i = 0; weight > 0.001f && i <= n; ++i) {
    weight = std::min(weight, 1.0f);
    const float signal = (noise[i] + s.offset) * power;
    power *= s.roughness;
    value += weight * signal;
    weight *= s.gain * signal;
  }
  const float rest = s.part;
  if (rest == 0 || !(weight > 0.001f)) return value;
  return value + rest * std::min(weight, 1.0f) * (noise[n + 1] + s.offset) * power;
}

float ridged_multifractal(const float* noise, const FractalSettings& s) {
  const auto ridge = [&](int i) {
    const float r = s.offset - std::abs(noise[i]);
    return r * r;
  };
  float power = s.roughness, signal = ridge(0), value = signal;
  for (int i = 1, n = s.detail; i <= n; ++i) {
    const float weight = clamp_unit(signal * s.gain);
    signal = ridge(i) * weight;
    value += signal * power;
    power *= s.roughness;
  }
  return value;
}

}  // namespace

void FractalSettings::set_detail(float octaves_beyond) {
  const float d = octaves_beyond >= 0 ? std::min(octaves_beyond, 15.0f) : 0;
  detail = static_cast<int>(d);
  part = d - static_cast<float>(detail);
  octaves = static_cast<uint32_t>(detail) + 1 +
            (part != 0 && type != NoiseType::RIDGED_MULTIFRACTAL ? 1 : 0);
}

float fractal_of(const float* noise, const FractalSettings& s) {
  switch (s.type) {
    case NoiseType::MULTIFRACTAL: return multifractal(noise, s);
    case NoiseType::RIDGED_MULTIFRACTAL: return ridged_multifractal(noise, s);
    case NoiseType::HYBRID_MULTIFRACTAL: return hybrid_multifractal(noise, s);
    case NoiseType::FBM: return fbm(noise, s);
    case NoiseType::HETERO_TERRAIN: return hetero_terrain(noise, s);
  }
  return 0;
}

}  // namespace photon_splat::nodes
