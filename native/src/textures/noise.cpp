#include "textures/noise.h"

#include <cstring>

#include "shading/frame.h"
#include "simd/dispatch.h"
#include "textures/hashes.h"

namespace photon_splat::nodes {
namespace {

constexpr float kPeriod = 100000;

// Noise repeats every 100,000 units; where there is no point it is 0.
template <int N>
Point<N> repeated(Point<N> p) {
  for (float& c : p.c) {
    if (!std::isfinite(c)) return {};  // noise is 0 at whole numbers
    if (std::abs(c) >= kPeriod)
      c = std::fmod(c, kPeriod) + (std::abs(c) >= 10 * kPeriod ? 0.5f : 0.0f);
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
  if constexpr (N == 1)
    p.c[0] += 100 + random_of(seed) * 100;
  else
    for (int d = 0; d < N; ++d) p.c[d] += 100 + random_of(seed, d) * 100;
  return p;
}

void evaluate_noise(int dimensions, NoisePoints& points, uint32_t count, float* values) {
  static const NoiseKernel kernel = choose_noise_kernel();
  for (int d = 0; d < dimensions; ++d)
    std::memset(&points.c[d][count], 0, NoisePoints::kPadding * sizeof(float));
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
void add_noise(Frame& f, const NoiseQueue::Texture& texture, Point<N> p, float distortion) {
  if (distortion != 0) p = distorted(p, distortion);
  const bool colored = texture.w[1] != kUnused;
  f.noise.add<N>(f, texture.settings.octaves * (colored ? 3 : 1));
  f.noise.add_octaves(p);
  if (!colored) return;
  f.noise.add_octaves(moved(p, N));
  f.noise.add_octaves(moved(p, N + 1));
}

}  // namespace

NoiseKernel choose_noise_kernel(const std::string& name) {
  return choose_variant<NoiseKernel>(PHOTON_SPLAT_VARIANTS(noise), name);
}

template <int N>
void NoiseQueue::add(Frame& f, uint32_t points) {
  if (textures_ > 0 && (dimensions_ != N || points_ + points > kMost)) {
    const Texture texture = waiting_[textures_];
    evaluate(f);
    waiting_[0] = texture;
  }
  dimensions_ = N;
  waiting_[textures_++].first = points_;
}

template <int N>
void NoiseQueue::add_point(const Point<N>& p) {
  for (int d = 0; d < N; ++d) at_.c[d][points_] = p.c[d];
  ++points_;
}

template <int N>
void NoiseQueue::add_octaves(Point<N> p) {
  const FractalSettings& s = waiting_[textures_ - 1].settings;
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
  for (const Texture* t = waiting_; t < waiting_ + textures_; ++t)
    t->finish(f, *t, values + t->first);
  points_ = textures_ = 0;
}

template void NoiseQueue::add<3>(Frame&, uint32_t);
template void NoiseQueue::add_octaves(Point<3>);

void noise_texture(Frame& f, const uint32_t* w) {
  const float scale = f.number(w[4]), distortion = f.number(w[10]);
  const Vec3 v = f.vector(w[2]) * scale;
  const float t = f.number(w[3]) * scale;
  NoiseQueue::Texture& texture = f.noise.next();
  texture.w = w;
  texture.finish = finish_noise;
  FractalSettings& s = texture.settings;
  s.roughness = std::max(f.number(w[6]), 0.0f);
  s.lacunarity = f.number(w[7]);
  s.offset = f.number(w[8]);
  s.gain = f.number(w[9]);
  s.type = f.mode<NoiseType>(w[12]);
  s.normalize = f.on(w[13]);
  s.set_detail(f.number(w[5]));
  switch (f.mode<Dimensions>(w[11])) {
    case Dimensions::D1: add_noise<1>(f, texture, {{t}}, distortion); break;
    case Dimensions::D2: add_noise<2>(f, texture, {{v.x, v.y}}, distortion); break;
    case Dimensions::D3: add_noise<3>(f, texture, {{v.x, v.y, v.z}}, distortion); break;
    case Dimensions::D4: add_noise<4>(f, texture, {{v.x, v.y, v.z, t}}, distortion); break;
  }
  f.noise.finish_texture(f);
}

}  // namespace photon_splat::nodes
