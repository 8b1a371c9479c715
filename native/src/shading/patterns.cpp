// Wave, Magic, Checker, Brick, Gradient and White Noise.
#include "shading/frame.h"
#include "textures/hashes.h"
#include "textures/noise.h"

namespace photon_splat::nodes {
namespace {

constexpr float kTwoPi = 2 * kPi;

// Away from whole numbers, where rounding decides.
Vec3 nudged(const Vec3& p) { return (p + Vec3{1e-6f, 1e-6f, 1e-6f}) * 0.999999f; }

float smoothstep(float t) { return t <= 0 ? 0 : t >= 1 ? 1 : (3 - 2 * t) * t * t; }

float wave_phase(const Vec3& p, WaveType type, BandsDirection bands, RingsDirection rings) {
  if (type == WaveType::BANDS) {
    switch (bands) {
      case BandsDirection::X: return p.x * 20;
      case BandsDirection::Y: return p.y * 20;
      case BandsDirection::Z: return p.z * 20;
      case BandsDirection::DIAGONAL: return (p.x + p.y + p.z) * 10;
    }
  }
  Vec3 q = p;
  if (rings == RingsDirection::X) q.x = 0;
  if (rings == RingsDirection::Y) q.y = 0;
  if (rings == RingsDirection::Z) q.z = 0;
  return length(q) * 20;
}

float wave_profile(float n, WaveProfile profile) {
  if (profile == WaveProfile::SIN) return 0.5f + 0.5f * std::sin(n - kPi / 2);
  n /= kTwoPi;
  return profile == WaveProfile::SAW ? n - std::floor(n) : std::abs(n - std::floor(n + 0.5f)) * 2;
}

float gradient(const Vec3& p, GradientType type) {
  switch (type) {
    case GradientType::LINEAR: return p.x;
    case GradientType::QUADRATIC: return std::max(p.x, 0.0f) * std::max(p.x, 0.0f);
    case GradientType::EASING: return smoothstep(p.x);
    case GradientType::DIAGONAL: return (p.x + p.y) * 0.5f;
    case GradientType::RADIAL: return std::atan2(p.y, p.x) / kTwoPi + 0.5f;
    case GradientType::SPHERICAL: return std::max(0.999999f - length(p), 0.0f);
    case GradientType::QUADRATIC_SPHERE: {
      const float r = std::max(0.999999f - length(p), 0.0f);
      return r * r;
    }
  }
  return 0;
}

// An integer noise in 0..1 of a brick's place.
float brick_tint(uint32_t n) {
  n = (n + 1013) & 0x7fffffff;
  n ^= n >> 13;
  return static_cast<float>((n * (n * n * 60493 + 19990303) + 1376312589) & 0x7fffffff) *
         (0.5f / 1073741824.0f);
}

}  // namespace

void wave_texture(Frame& f, const uint32_t* w) {
  const Vec3 p = nudged(f.vector(w[1]) * f.number(w[2]));
  const float n = wave_phase(p, f.mode<WaveType>(w[8]), f.mode<BandsDirection>(w[9]),
                             f.mode<RingsDirection>(w[10])) +
                  f.number(w[7]);
  const float distortion = f.number(w[3]);
  if (distortion != 0) {
    const Vec3 q = p * f.number(w[5]);
    NoiseQueue::Texture& waiting = f.noise.next();
    FractalSettings& s = waiting.settings;
    s = {f.number(w[6]), 2, 0, 0, NoiseType::FBM, true, {}, {}, {}};
    s.set_detail(f.number(w[4]));
    waiting.w = w;
    waiting.carried[0] = n;
    waiting.carried[1] = distortion;
    waiting.finish = [](Frame& frame, const NoiseQueue::Texture& t, const float* noise) {
      const float phase = t.carried[0] + t.carried[1] * (fractal_of(noise, t.settings) * 2 - 1);
      frame.set(t.w[0], wave_profile(phase, Frame::mode<WaveProfile>(t.w[11])));
    };
    f.noise.add<3>(f, s.octaves);
    f.noise.add_octaves<3>({{q.x, q.y, q.z}});
  } else {
    f.set(w[0], wave_profile(n, f.mode<WaveProfile>(w[11])));
  }
  f.noise.finish_texture(f);
}

void magic_texture(Frame& f, const uint32_t* w) {
  const float scale = f.number(w[3]), distortion = f.number(w[4]);
  const uint32_t depth = w[5];
  const bool wrap_scaled = f.on(w[6]);
  const float before = wrap_scaled ? scale : 1, after = wrap_scaled ? 1 : scale;
  const Vec3 p = each(f.vector(w[2]), [&](float c) { return std::fmod(c * before, kTwoPi); });
  float x = std::sin((p.x + p.y + p.z) * 5 * after), y = std::cos((-p.x + p.y - p.z) * 5 * after),
        z = -std::cos((-p.x - p.y + p.z) * 5 * after);
  if (depth > 0) {
    x *= distortion;
    y *= distortion;
    z *= distortion;
    y = -std::cos(x - y + z) * distortion;
  }
  if (depth > 1) x = std::cos(x - y - z) * distortion;
  if (depth > 2) z = std::sin(-x - y - z) * distortion;
  if (depth > 3) x = -std::cos(-x + y - z) * distortion;
  if (depth > 4) y = -std::sin(-x + y + z) * distortion;
  if (depth > 5) y = -std::cos(-x + y + z) * distortion;
  if (depth > 6) x = std::cos(x + y + z) * distortion;
  if (depth > 7) z = std::sin(x + y - z) * distortion;
  if (depth > 8) x = -std::cos(-x - y + z) * distortion;
  if (depth > 9) y = -std::sin(x - y + z) * distortion;
  const float divisor = distortion != 0 ? distortion * 2 : 1;
  const Rgb color{0.5f - x / divisor, 0.5f - y / divisor, 0.5f - z / divisor};
  f.set(w[0], color);
  f.set(w[1], average(color));
}

void checker_texture(Frame& f, const uint32_t* w) {
  const Vec3 p = nudged(f.vector(w[2]) * f.number(w[5]));
  const auto odd = [](float c) { return (to_int(std::floor(c)) & 1) != 0; };
  const bool first = (odd(p.x) == odd(p.y)) == odd(p.z);
  f.set(w[0], f.vector(first ? w[3] : w[4]));
  f.set(w[1], first ? 1.0f : 0.0f);
}

void brick_texture(Frame& f, const uint32_t* w) {
  const Vec3 p = f.vector(w[2]) * f.number(w[6]);
  const float mortar_size = f.number(w[7]), smooth = f.number(w[8]), height = f.number(w[11]);
  const uint32_t offset_frequency = w[14], squash_frequency = w[15];
  float width = f.number(w[10]), shift = 0;
  const int row = to_int(std::floor(p.y / height));
  if (offset_frequency && squash_frequency) {
    if (row % static_cast<int>(squash_frequency) == 0) width *= f.number(w[13]);
    if (row % static_cast<int>(offset_frequency) == 0) shift = width * f.number(w[12]);
  }
  const int column = to_int(std::floor((p.x + shift) / width));
  const float x = p.x + shift - width * static_cast<float>(column),
              y = p.y - height * static_cast<float>(row);
  const float tint = clamp_unit(
      brick_tint((static_cast<uint32_t>(row) << 16) + (static_cast<uint32_t>(column) & 0xffff)) +
      f.number(w[9]));
  const float nearest = std::min(std::min(x, y), std::min(width - x, height - y));
  float mortar = 0;
  if (nearest < mortar_size)
    mortar = smooth == 0 ? 1 : smoothstep((1 - nearest / mortar_size) / smooth);
  const Rgb brick = mix(f.vector(w[3]), f.vector(w[4]), tint);
  f.set(w[0], mix(brick, f.vector(w[5]), mortar));
  f.set(w[1], mortar);
}

void gradient_texture(Frame& f, const uint32_t* w) {
  f.set(w[0], clamp_unit(gradient(f.vector(w[1]), f.mode<GradientType>(w[2]))));
}

void white_noise_texture(Frame& f, const uint32_t* w) {
  const Vec3 v = f.vector(w[2]);
  const float t = f.number(w[3]);
  const bool color = w[1] != kUnused;
  switch (f.mode<Dimensions>(w[4])) {
    case Dimensions::D1:
      f.set(w[0], random_of(t));
      if (color) f.set(w[1], random_color(t));
      break;
    case Dimensions::D2:
      f.set(w[0], random_of(v.x, v.y));
      if (color) f.set(w[1], random_color(v.x, v.y));
      break;
    case Dimensions::D3:
      f.set(w[0], random_of(v.x, v.y, v.z));
      if (color) f.set(w[1], random_color(v.x, v.y, v.z));
      break;
    case Dimensions::D4:
      f.set(w[0], random_of(v.x, v.y, v.z, t));
      if (color) f.set(w[1], random_color(v.x, v.y, v.z, t));
      break;
  }
}

}  // namespace photon_splat::nodes
