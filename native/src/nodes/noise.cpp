// Fractals of Perlin noise by Musgrave (Ebert et al., "Texturing and modeling", chapter 16). All the octaves that a texture asks for
// are computed by one call of a kernel (simd/noise_kernel.inl).
#include "noise.h"

#include <cstring>

#include "frame.h"
#include "hashes.h"
#include "noise_kernel.h"

namespace photon_splat::nodes {
namespace {

template <int N>
Point<N> operator*(const Point<N>& p, float s) {
  Point<N> out;
  for (int d = 0; d < N; ++d) out.c[d] = p.c[d] * s;
  return out;
}

// Points whose noise is wanted, then their noise. It repeats every 100,000 units; where there is no point it is 0.
template <int N>
class Batch {
 public:
  void add(const Point<N>& p) {
    const uint32_t i = count_++;
    bool near = true;
    for (int d = 0; d < N; ++d) {
      points_.c[d][i] = p.c[d];
      near &= std::abs(p.c[d]) < 100000.0f;
    }
    if (!near) repeat(i);
  }
  const float* evaluate() {
    for (int d = 0; d < N; ++d) std::memset(&points_.c[d][count_], 0, NoisePoints::kPadding * sizeof(float));
    static const NoiseKernel kernel = choose_noise_kernel();
    kernel(N, points_, count_, values_);
    return values_;
  }

 private:
  void repeat(uint32_t i) {
    for (int d = 0; d < N; ++d) {
      float& c = points_.c[d][i];
      if (!std::isfinite(c)) {
        for (int e = 0; e < N; ++e) points_.c[e][i] = 0;  // noise is 0 at whole numbers
        return;
      }
      if (std::abs(c) >= 100000.0f) c = std::fmod(c, 100000.0f) + (std::abs(c) >= 1000000.0f ? 0.5f : 0.0f);
    }
  }

  NoisePoints points_;
  uint32_t count_ = 0;
  alignas(64) float values_[NoisePoints::kMost];
};

float part_of_octave(const FractalSettings& s) { return s.detail - std::floor(s.detail); }

// Octaves of a fractal, with the one of which but a part counts.
uint32_t octaves_of(const FractalSettings& s) {
  return static_cast<uint32_t>(to_int(s.detail)) + 1 + (part_of_octave(s) != 0 && s.type != NoiseType::RIDGED_MULTIFRACTAL ? 1 : 0);
}

template <int N>
void add_octaves(Batch<N>& batch, Point<N> p, const FractalSettings& s) {
  float scale = 1;
  for (uint32_t i = 0, n = octaves_of(s); i < n; ++i) {
    if (s.type == NoiseType::FBM) {
      batch.add(p * scale);
      scale *= s.lacunarity;
    } else {
      batch.add(p);
      p = p * s.lacunarity;
    }
  }
}

// Each takes the noise of the octaves.

float fbm(const float* noise, const FractalSettings& s) {
  float amplitude = 1, total = 0, sum = 0;
  const int n = to_int(s.detail);
  for (int i = 0; i <= n; ++i) {
    sum += noise[i] * amplitude;
    total += amplitude;
    amplitude *= s.roughness;
  }
  const auto finished = [&](float x, float weight) { return s.normalize ? 0.5f * x / weight + 0.5f : x; };
  const float rest = part_of_octave(s);
  if (rest == 0) return finished(sum, total);
  return mix(finished(sum, total), finished(sum + noise[n + 1] * amplitude, total + amplitude), rest);
}

float multifractal(const float* noise, const FractalSettings& s) {
  float value = 1, power = 1;
  const int n = to_int(s.detail);
  for (int i = 0; i <= n; ++i) {
    value *= power * noise[i] + 1;
    power *= s.roughness;
  }
  const float rest = part_of_octave(s);
  return rest == 0 ? value : value * (rest * power * noise[n + 1] + 1);
}

float hetero_terrain(const float* noise, const FractalSettings& s) {
  float power = s.roughness, value = s.offset + noise[0];
  const int n = to_int(s.detail);
  for (int i = 1; i <= n; ++i) {
    value += (noise[i] + s.offset) * power * value;
    power *= s.roughness;
  }
  const float rest = part_of_octave(s);
  return rest == 0 ? value : value + rest * (noise[n + 1] + s.offset) * power * value;
}

float hybrid_multifractal(const float* noise, const FractalSettings& s) {
  float power = 1, value = 0, weight = 1;
  const int n = to_int(s.detail);
  for (int i = 0; weight > 0.001f && i <= n; ++i) {
    weight = std::min(weight, 1.0f);
    const float signal = (noise[i] + s.offset) * power;
    power *= s.roughness;
    value += weight * signal;
    weight *= s.gain * signal;
  }
  const float rest = part_of_octave(s);
  if (rest == 0 || !(weight > 0.001f)) return value;
  return value + rest * std::min(weight, 1.0f) * (noise[n + 1] + s.offset) * power;
}

float ridged_multifractal(const float* noise, const FractalSettings& s) {
  const auto ridge = [&](int i) {
    const float r = s.offset - std::abs(noise[i]);
    return r * r;
  };
  float power = s.roughness, signal = ridge(0), value = signal;
  for (int i = 1, n = to_int(s.detail); i <= n; ++i) {
    const float weight = clamp_unit(signal * s.gain);
    signal = ridge(i) * weight;
    value += signal * power;
    power *= s.roughness;
  }
  return value;
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

// Offsets in 100..200 stand in for a seed.
template <int N>
Point<N> moved(Point<N> p, float seed) {
  if constexpr (N == 1) p.c[0] += 100 + random_of(seed) * 100;
  else for (int d = 0; d < N; ++d) p.c[d] += 100 + random_of(seed, d) * 100;
  return p;
}

template <int N>
void noise_in(Frame& f, const uint32_t* w, Point<N> p, float distortion, const FractalSettings& s) {
  if (distortion != 0) {
    Batch<N> batch;
    for (int d = 0; d < N; ++d) batch.add(moved(p, static_cast<float>(d)));
    const float* noise = batch.evaluate();
    for (int d = 0; d < N; ++d) p.c[d] += noise[d] * distortion;
  }
  const bool colored = w[1] != kUnused;
  Batch<N> batch;
  add_octaves(batch, p, s);
  if (colored) {
    add_octaves(batch, moved(p, N), s);
    add_octaves(batch, moved(p, N + 1), s);
  }
  const float* noise = batch.evaluate();
  const float value = fractal_of(noise, s);
  f.set(w[0], value);
  if (!colored) return;
  const uint32_t n = octaves_of(s);
  f.set(w[1], Vec3{value, fractal_of(noise + n, s), fractal_of(noise + 2 * n, s)});
}

}  // namespace

NoiseKernel choose_noise_kernel(const std::string& name) {
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  if (avx512 && (name.empty() || name == "avx512")) return noise_avx512;
  if (__builtin_cpu_supports("avx2") && (name.empty() || name == "avx2")) return noise_avx2;
  if (__builtin_cpu_supports("sse4.2") && (name.empty() || name == "sse42")) return noise_sse42;
#endif
  return name.empty() || name == "generic" ? noise_generic : nullptr;
}

template <int N>
float fractal_noise(Point<N> p, const FractalSettings& s) {
  Batch<N> batch;
  add_octaves(batch, p, s);
  return fractal_of(batch.evaluate(), s);
}

template float fractal_noise(Point<3>, const FractalSettings&);

void noise_texture(Frame& f, const uint32_t* w) {
  const float scale = f.number(w[4]), distortion = f.number(w[10]);
  const Vec3 v = f.vector(w[2]) * scale;
  const float t = f.number(w[3]) * scale;
  FractalSettings s{std::clamp(f.number(w[5]), 0.0f, 15.0f), std::max(f.number(w[6]), 0.0f), f.number(w[7]), f.number(w[8]),
                    f.number(w[9]), f.mode<NoiseType>(w[12]), f.on(w[13])};
  if (!(s.detail >= 0)) s.detail = 0;
  switch (f.mode<Dimensions>(w[11])) {
    case Dimensions::D1: return noise_in<1>(f, w, {{t}}, distortion, s);
    case Dimensions::D2: return noise_in<2>(f, w, {{v.x, v.y}}, distortion, s);
    case Dimensions::D3: return noise_in<3>(f, w, {{v.x, v.y, v.z}}, distortion, s);
    case Dimensions::D4: return noise_in<4>(f, w, {{v.x, v.y, v.z, t}}, distortion, s);
  }
}

}  // namespace photon_splat::nodes
