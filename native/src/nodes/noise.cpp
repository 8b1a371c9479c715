// Perlin's improved noise (2002) with the gradients of Gustavson's variants for other dimensions and lookup3 as the hash, as in
// Open Shading Language and Cycles; fractals by Musgrave (Ebert et al., "Texturing and modeling", chapter 16).
#include "noise.h"

#include "frame.h"
#include "hashes.h"

namespace photon_splat::nodes {
namespace {

float fade(float t) { return t * t * t * (t * (t * 6 - 15) + 10); }

inline Floats negated(const Floats& x, const Words& bit) {  // -x where bit (0 or 1) is set
  return bits_of<Floats>(bits_of<Words>(x) ^ bit << 31);
}

// Gradients of hashes h times the offsets, in the dimensions there are.
template <int N>
inline Floats gradient(Words h, const Floats& x, const Floats& y, const Floats& z, const Floats& w) {
  if constexpr (N == 1) return negated(to_floats((h & 7u) + 1u), h >> 3 & 1u) * x;
  if constexpr (N == 2) {
    h = h & 7u;
    return negated(choose(h < 4u, x, y), h & 1u) + negated(choose(h < 4u, y, x) * 2.0f, h >> 1 & 1u);
  }
  if constexpr (N == 3) {
    h = h & 15u;
    const Floats other = choose((h & 13u) == 12u, x, z);
    return negated(choose(h < 8u, x, y), h & 1u) + negated(choose(h < 4u, y, other), h >> 1 & 1u);
  }
  h = h & 31u;
  return negated(choose(h < 24u, x, y), h & 1u) + negated(choose(h < 16u, y, z), h >> 1 & 1u) +
         negated(choose(h < 8u, z, w), h >> 2 & 1u);
}

template <int N>
inline Words corner_hashes(const Words& x, const Words& y, const Words& z, const Words& w) {
  if constexpr (N == 1) return lookup3(x);
  if constexpr (N == 2) return lookup3(x, y);
  if constexpr (N == 3) return lookup3(x, y, z);
  return lookup3(x, y, z, w);
}

template <int N>
float perlin(const Point<N>& p) {
  uint32_t cell[4] = {};
  float fraction[4] = {}, weight[4] = {};
  for (int d = 0; d < N; ++d) {
    const float whole = std::floor(p.c[d]);
    cell[d] = static_cast<uint32_t>(static_cast<int32_t>(whole));
    fraction[d] = p.c[d] - whole;
    weight[d] = fade(fraction[d]);
  }
  // Corners of the cell: four lanes for x and y, one vector for every z and w.
  constexpr int kVectors = N <= 2 ? 1 : 1 << (N - 2);
  const Words cx = Words{0, 1, 0, 1} + cell[0], cy = Words{0, 0, 1, 1} + cell[1];
  const Floats fx = Floats{} + fraction[0] - Floats{0, 1, 0, 1}, fy = Floats{} + fraction[1] - Floats{0, 0, 1, 1};
  Floats value[kVectors];
  for (int i = 0; i < kVectors; ++i) {
    const uint32_t dz = i & 1, dw = i >> 1;
    const Words h = corner_hashes<N>(cx, cy, Words{} + (cell[2] + dz), Words{} + (cell[3] + dw));
    value[i] = gradient<N>(h, fx, fy, Floats{} + (fraction[2] - static_cast<float>(dz)),
                           Floats{} + (fraction[3] - static_cast<float>(dw)));
  }
  for (int d = N - 1, half = kVectors / 2; d >= 2; --d, half /= 2)
    for (int i = 0; i < half; ++i) value[i] = value[i] * (1 - weight[d]) + value[i + half] * weight[d];
  const Floats& last = value[0];
  const float low = mix(last[0], last[1], weight[0]);
  return N == 1 ? low : mix(low, mix(last[2], last[3], weight[0]), weight[1]);
}

constexpr float kScale[5] = {0, 0.2500f, 0.6616f, 0.9820f, 0.8344f};  // to [-1, 1] or so

template <int N>
Point<N> operator*(const Point<N>& p, float s) {
  Point<N> out;
  for (int d = 0; d < N; ++d) out.c[d] = p.c[d] * s;
  return out;
}

template <int N>
float fbm(const Point<N>& p, const FractalSettings& s) {
  float scale = 1, amplitude = 1, total = 0, sum = 0;
  for (int i = 0, n = to_int(s.detail); i <= n; ++i) {
    sum += signed_noise(p * scale) * amplitude;
    total += amplitude;
    amplitude *= s.roughness;
    scale *= s.lacunarity;
  }
  const auto finished = [&](float x, float weight) { return s.normalize ? 0.5f * x / weight + 0.5f : x; };
  const float rest = s.detail - std::floor(s.detail);
  if (rest == 0) return finished(sum, total);
  const float more = sum + signed_noise(p * scale) * amplitude;
  return mix(finished(sum, total), finished(more, total + amplitude), rest);
}

template <int N>
float multifractal(Point<N> p, const FractalSettings& s) {
  float value = 1, power = 1;
  for (int i = 0, n = to_int(s.detail); i <= n; ++i) {
    value *= power * signed_noise(p) + 1;
    power *= s.roughness;
    p = p * s.lacunarity;
  }
  const float rest = s.detail - std::floor(s.detail);
  return rest == 0 ? value : value * (rest * power * signed_noise(p) + 1);
}

template <int N>
float hetero_terrain(Point<N> p, const FractalSettings& s) {
  float power = s.roughness, value = s.offset + signed_noise(p);
  p = p * s.lacunarity;
  for (int i = 1, n = to_int(s.detail); i <= n; ++i) {
    value += (signed_noise(p) + s.offset) * power * value;
    power *= s.roughness;
    p = p * s.lacunarity;
  }
  const float rest = s.detail - std::floor(s.detail);
  return rest == 0 ? value : value + rest * (signed_noise(p) + s.offset) * power * value;
}

template <int N>
float hybrid_multifractal(Point<N> p, const FractalSettings& s) {
  float power = 1, value = 0, weight = 1;
  for (int i = 0, n = to_int(s.detail); weight > 0.001f && i <= n; ++i) {
    weight = std::min(weight, 1.0f);
    const float signal = (signed_noise(p) + s.offset) * power;
    power *= s.roughness;
    value += weight * signal;
    weight *= s.gain * signal;
    p = p * s.lacunarity;
  }
  const float rest = s.detail - std::floor(s.detail);
  if (rest == 0 || !(weight > 0.001f)) return value;
  return value + rest * std::min(weight, 1.0f) * (signed_noise(p) + s.offset) * power;
}

template <int N>
float ridged_multifractal(Point<N> p, const FractalSettings& s) {
  const auto ridge = [&] {
    const float r = s.offset - std::abs(signed_noise(p));
    return r * r;
  };
  float power = s.roughness, signal = ridge(), value = signal;
  for (int i = 1, n = to_int(s.detail); i <= n; ++i) {
    p = p * s.lacunarity;
    const float weight = clamp_unit(signal * s.gain);
    signal = ridge() * weight;
    value += signal * power;
    power *= s.roughness;
  }
  return value;
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
    const Point<N> start = p;
    for (int d = 0; d < N; ++d) p.c[d] += signed_noise(moved(start, static_cast<float>(d))) * distortion;
  }
  const float value = fractal_noise(p, s);
  f.set(w[0], value);
  if (w[1] == kUnused) return;
  f.set(w[1], Vec3{value, fractal_noise(moved(p, N), s), fractal_noise(moved(p, N + 1), s)});
}

}  // namespace

template <int N>
float signed_noise(const Point<N>& p) {
  Point<N> q = p;
  for (int d = 0; d < N; ++d) {
    if (std::abs(q.c[d]) < 100000.0f) continue;
    if (!std::isfinite(q.c[d])) return 0;
    q.c[d] = std::fmod(q.c[d], 100000.0f) + (std::abs(q.c[d]) >= 1000000.0f ? 0.5f : 0.0f);
  }
  return kScale[N] * perlin(q);
}

template <int N>
float fractal_noise(Point<N> p, const FractalSettings& s) {
  switch (s.type) {
    case NoiseType::MULTIFRACTAL: return multifractal(p, s);
    case NoiseType::RIDGED_MULTIFRACTAL: return ridged_multifractal(p, s);
    case NoiseType::HYBRID_MULTIFRACTAL: return hybrid_multifractal(p, s);
    case NoiseType::FBM: return fbm(p, s);
    case NoiseType::HETERO_TERRAIN: return hetero_terrain(p, s);
  }
  return 0;
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
