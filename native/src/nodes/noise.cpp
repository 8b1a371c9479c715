#include "noise.h"

#include <cstring>

#include "frame.h"
#include "hashes.h"

namespace photon_splat::nodes {
namespace {

constexpr float kPeriod = 100000;

// Noise repeats every 100,000 units; where there is no point it is 0.
template <int N>
Point<N> repeated(Point<N> p) {
  for (float& c : p.c) {
    if (!std::isfinite(c)) return {};  // noise is 0 at whole numbers
    if (std::abs(c) >= kPeriod) c = std::fmod(c, kPeriod) + (std::abs(c) >= 10 * kPeriod ? 0.5f : 0.0f);
  }
  return p;
}

template <int N>
bool is_near(const Point<N>& p) {
  bool near = true;
  for (float c : p.c) near &= std::abs(c) < kPeriod;
  return near;
}

template <int N>
Point<N> operator*(const Point<N>& p, float s) {
  Point<N> out;
  for (int d = 0; d < N; ++d) out.c[d] = p.c[d] * s;
  return out;
}

// Offsets in 100..200 stand in for a seed.
template <int N>
Point<N> moved(Point<N> p, float seed) {
  if constexpr (N == 1) p.c[0] += 100 + random_of(seed) * 100;
  else for (int d = 0; d < N; ++d) p.c[d] += 100 + random_of(seed, d) * 100;
  return p;
}

void evaluate_noise(int dimensions, NoisePoints& points, uint32_t count, float* values) {
  static const NoiseKernel kernel = choose_noise_kernel();
  for (int d = 0; d < dimensions; ++d) std::memset(&points.c[d][count], 0, NoisePoints::kPadding * sizeof(float));
  kernel(dimensions, points, count, values);
}

template <int N>
Point<N> distorted(Point<N> p, float distortion) {
  NoisePoints points;
  for (int k = 0; k < N; ++k) {
    const Point<N> at = moved(p, static_cast<float>(k));
    const Point<N> near = is_near(at) ? at : repeated(at);
    for (int d = 0; d < N; ++d) points.c[d][k] = near.c[d];
  }
  float noise[NoisePoints::kMost];
  evaluate_noise(N, points, N, noise);
  for (int d = 0; d < N; ++d) p.c[d] += noise[d] * distortion;
  return p;
}

void finish_noise(Frame& f, const NoiseQueue::Texture& texture, const float* noise) {
  const FractalSettings& s = texture.settings;
  const float value = fractal_of(noise, s);
  f.set(texture.w[0], value);
  if (texture.w[1] == kUnused) return;
  const uint32_t n = s.octaves;
  f.set(texture.w[1], Vec3{value, fractal_of(noise + n, s), fractal_of(noise + 2 * n, s)});
}

template <int N>
void noise_in(Frame& f, const uint32_t* w, Point<N> p, float distortion, const FractalSettings& s) {
  if (distortion != 0) p = distorted(p, distortion);
  const bool colored = w[1] != kUnused;
  f.noise.add<N>(f, w, s, s.octaves * (colored ? 3 : 1)).finish = finish_noise;
  f.noise.add_octaves(p, s);
  if (!colored) return;
  f.noise.add_octaves(moved(p, N), s);
  f.noise.add_octaves(moved(p, N + 1), s);
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
NoiseQueue::Texture& NoiseQueue::add(Frame& f, const uint32_t* w, const FractalSettings& s, uint32_t points) {
  if (dimensions_ != N || points_ + points > kMost) evaluate(f);
  dimensions_ = N;
  Texture& texture = waiting_[textures_++];
  texture.w = w;
  texture.settings = s;
  texture.first = points_;
  return texture;
}

template <int N>
void NoiseQueue::add_point(const Point<N>& p) {
  for (int d = 0; d < N; ++d) at_.c[d][points_] = p.c[d];
  ++points_;
}

template <int N>
void NoiseQueue::add_octaves(Point<N> p, const FractalSettings& s) {
  const bool by_scale = s.type == NoiseType::FBM;
  float scale = 1;
  for (uint32_t i = 0; i < s.octaves; ++i) {
    const Point<N> at = by_scale ? p * scale : p;
    add_point(is_near(at) ? at : repeated(at));
    scale *= s.lacunarity;
    if (!by_scale) p = p * s.lacunarity;
  }
}

void NoiseQueue::finish_texture(Frame& f) {
  if (together > 1) {
    --together;
    return;
  }
  together = 0;
  evaluate(f);
}

void NoiseQueue::evaluate(Frame& f) {
  if (textures_ == 0) return;
  alignas(64) float values[NoisePoints::kMost];
  evaluate_noise(dimensions_, at_, points_, values);
  for (const Texture* t = waiting_; t < waiting_ + textures_; ++t) t->finish(f, *t, values + t->first);
  points_ = textures_ = 0;
}

template NoiseQueue::Texture& NoiseQueue::add<3>(Frame&, const uint32_t*, const FractalSettings&, uint32_t);
template void NoiseQueue::add_octaves(Point<3>, const FractalSettings&);

void noise_texture(Frame& f, const uint32_t* w) {
  const float scale = f.number(w[4]), distortion = f.number(w[10]);
  const Vec3 v = f.vector(w[2]) * scale;
  const float t = f.number(w[3]) * scale;
  FractalSettings s{std::max(f.number(w[6]), 0.0f), f.number(w[7]), f.number(w[8]), f.number(w[9]), f.mode<NoiseType>(w[12]), f.on(w[13]), {}, {}, {}};
  s.set_detail(f.number(w[5]));
  switch (f.mode<Dimensions>(w[11])) {
    case Dimensions::D1: noise_in<1>(f, w, {{t}}, distortion, s); break;
    case Dimensions::D2: noise_in<2>(f, w, {{v.x, v.y}}, distortion, s); break;
    case Dimensions::D3: noise_in<3>(f, w, {{v.x, v.y, v.z}}, distortion, s); break;
    case Dimensions::D4: noise_in<4>(f, w, {{v.x, v.y, v.z, t}}, distortion, s); break;
  }
  f.noise.finish_texture(f);
}

}  // namespace photon_splat::nodes
