// Colours: blending, models, spectra.
#include <bit>

#include "math/spectrum.h"
#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

Vec3 rgb_to_hsv(const Rgb& c) {
  const float high = std::max({c.x, c.y, c.z}), low = std::min({c.x, c.y, c.z}), span = high - low;
  const float s = high != 0 ? span / high : 0;
  if (s == 0) return {0, 0, high};
  const Vec3 d = (Vec3{high, high, high} - c) / span;
  // A table here, too: which component is the highest.
  const float sectors[3] = {d.z - d.y, 2 + d.x - d.z, 4 + d.y - d.x};
  const auto lower = [high](float x) {
    return std::bit_cast<uint32_t>(x) != std::bit_cast<uint32_t>(high) ? 1u : 0u;
  };
  const float h = sectors[lower(c.x) * (1 + lower(c.y))] / 6;
  return {h < 0 ? h + 1 : h, s, high};
}

Rgb hsv_to_rgb(const Vec3& hsv) {
  const float s = hsv.y, v = hsv.z;
  if (s == 0) return {v, v, v};
  const float h = hsv.x == 1 ? 0 : hsv.x * 6, sector = std::floor(h), t = h - sector;
  const float p = v * (1 - s), q = v * (1 - s * t), r = v * (1 - s * (1 - t));
  // A table, as the sector of a texture's colour is no jump that a processor could foresee.
  static constexpr uint8_t kOrder[6][3] = {{0, 3, 1}, {2, 0, 1}, {1, 0, 3},
                                           {1, 2, 0}, {3, 1, 0}, {0, 1, 2}};
  const float values[4] = {v, p, q, r};
  const uint8_t* order = kOrder[std::min(static_cast<uint32_t>(to_int(sector)), 5u)];
  return {values[order[0]], values[order[1]], values[order[2]]};
}

Vec3 rgb_to_hsl(const Rgb& c) {
  const float high = std::max({c.x, c.y, c.z}), low = std::min({c.x, c.y, c.z}), span = high - low;
  const float l = std::min(1.0f, (high + low) / 2);
  if (span == 0) return {0, 0, l};
  const float s = l > 0.5f ? span / (2 - high - low) : span / (high + low);
  const float h = high == c.x   ? (c.y - c.z) / span + (c.y < c.z ? 6.0f : 0.0f)
                  : high == c.y ? (c.z - c.x) / span + 2
                                : (c.x - c.y) / span + 4;
  return {h / 6, s, l};
}

Rgb hsl_to_rgb(const Vec3& hsl) {
  const float chroma = (1 - std::abs(2 * hsl.z - 1)) * hsl.y;
  const Vec3 hue{clamp_unit(std::abs(hsl.x * 6 - 3) - 1), clamp_unit(2 - std::abs(hsl.x * 6 - 2)),
                 clamp_unit(2 - std::abs(hsl.x * 6 - 4))};
  return (hue - Vec3{0.5f, 0.5f, 0.5f}) * chroma + Vec3{hsl.z, hsl.z, hsl.z};
}

constexpr Vec3 kWhite{1, 1, 1};

float dodge(float a, float b, float t) {
  if (a == 0) return 0;
  const float d = 1 - t * b;
  return d <= 0 ? 1 : std::min(a / d, 1.0f);
}
float burn(float a, float b, float t) {
  const float d = 1 - t + t * b;
  return d <= 0 ? 0 : clamp_unit(1 - (1 - a) / d);
}
float overlay(float a, float b, float t) {
  return a < 0.5f ? a * (1 - t + 2 * t * b) : 1 - (1 - t + 2 * t * (1 - b)) * (1 - a);
}

Rgb blend(Blend kind, float t, const Rgb& a, const Rgb& b) {
  using enum Blend;
  switch (kind) {
    case MIX: return mix(a, b, t);
    case DARKEN: return mix(a, min(a, b), t);
    case MULTIPLY: return mix(a, a * b, t);
    case BURN: return each(a, b, [t](float x, float y) { return burn(x, y, t); });
    case LIGHTEN: return mix(a, max(a, b), t);
    case SCREEN: return kWhite - (kWhite * (1 - t) + (kWhite - b) * t) * (kWhite - a);
    case DODGE: return each(a, b, [t](float x, float y) { return dodge(x, y, t); });
    case ADD: return mix(a, a + b, t);
    case OVERLAY: return each(a, b, [t](float x, float y) { return overlay(x, y, t); });
    case SOFT_LIGHT:
      return a * (1 - t) + ((kWhite - a) * b * a + a * (kWhite - (kWhite - b) * (kWhite - a))) * t;
    case LINEAR_LIGHT: return a + (b * 2 - kWhite) * t;
    case DIFFERENCE: return mix(a, each(a - b, [](float x) { return std::abs(x); }), t);
    case EXCLUSION: return max(mix(a, a + b - a * b * 2, t), Vec3{});
    case SUBTRACT: return mix(a, a - b, t);
    case DIVIDE:
      return each(a, b, [t](float x, float y) { return y != 0 ? x * (1 - t) + t * x / y : x; });
    case HUE:
    case COLOR: {
      const Vec3 other = rgb_to_hsv(b);
      if (other.y == 0) return a;
      Vec3 hsv = rgb_to_hsv(a);
      hsv.x = other.x;
      if (kind == COLOR) hsv.y = other.y;
      return mix(a, hsv_to_rgb(hsv), t);
    }
    case SATURATION: {
      Vec3 hsv = rgb_to_hsv(a);
      if (hsv.y == 0) return a;
      hsv.y = mix(hsv.y, rgb_to_hsv(b).y, t);
      return hsv_to_rgb(hsv);
    }
    case VALUE: {
      Vec3 hsv = rgb_to_hsv(a);
      hsv.z = mix(hsv.z, rgb_to_hsv(b).z, t);
      return hsv_to_rgb(hsv);
    }
  }
  return a;
}

// Open Shading Language's fit of the chromaticity of a black body in Rec. 709, as Cycles has it: in
// pieces of temperature (K), red and green as a/T + b T + c, blue as a cubic. Its luminance is 1 or
// so.
struct BlackbodyPiece {
  float below;
  float red[3], green[3], blue[4];
};
constexpr BlackbodyPiece kBlackbody[] = {
    {965,
     {1.61919106e3f, -2.05010916e-3f, 5.02995757f},
     {-4.88999748e2f, 6.04330754e-4f, -7.55807526e-2f},
     {5.96945309e-11f, -4.85742887e-8f, -9.70622247e-5f, -4.07936148e-3f}},
    {1167,
     {2.48845471e3f, -1.11330907e-3f, 3.22621544f},
     {-7.55994277e2f, 3.16730098e-4f, 4.78306139e-1f},
     {2.40430366e-11f, 5.55021075e-8f, -1.98503712e-4f, 2.89312858e-2f}},
    {1449,
     {3.34143193e3f, -4.86551192e-4f, 1.76486769f},
     {-1.02363977e3f, 1.20223470e-4f, 9.36662319e-1f},
     {-1.40949732e-11f, 1.89878968e-7f, -3.56632824e-4f, 9.10767778e-2f}},
    {1902,
     {4.09461742e3f, -1.27446582e-4f, 7.25731635e-1f},
     {-1.26571316e3f, 4.87340896e-6f, 1.27054498f},
     {-3.61460868e-11f, 2.84822009e-7f, -4.93211319e-4f, 1.56723440e-1f}},
    {3315,
     {4.67028036e3f, 2.91258199e-5f, 1.26703442e-1f},
     {-1.42529332e3f, -4.01150431e-5f, 1.43972784f},
     {-1.97075738e-11f, 1.75359352e-7f, -2.50542825e-4f, -2.22783266e-2f}},
    {6365,
     {4.59509185e3f, 2.87495649e-5f, 1.50345020e-1f},
     {-1.17554822e3f, -2.16378048e-5f, 1.30408023f},
     {-1.61997957e-13f, -1.64216008e-8f, 3.86216271e-4f, -7.38077418e-1f}},
    {INFINITY,
     {3.78717450e3f, 9.35907826e-6f, 3.99075871e-1f},
     {-5.00799571e2f, -4.59832026e-6f, 1.09098763f},
     {6.72650283e-13f, -2.73078809e-8f, 4.24098264e-4f, -7.52335691e-1f}},
};

Rgb blackbody_color(float t) {
  if (t >= 12000) return {0.8262954810f, 0.9945080502f, 1.5663077103f};
  if (!(t >= 800)) return {5.4132944902f, 0, 0};
  const BlackbodyPiece* piece = kBlackbody;
  while (t >= piece->below) ++piece;
  const auto hyperbola = [t](const float* c) { return c[0] / t + c[1] * t + c[2]; };
  const float* b = piece->blue;
  return max(Rgb{hyperbola(piece->red), hyperbola(piece->green),
                 ((b[0] * t + b[1]) * t + b[2]) * t + b[3]},
             Rgb{});
}

Rgb wavelength_color(float nanometres) {
  return max(spectral_rgb(nanometres) * (1 / 2.52f), Rgb{});  // keeps every channel below 1
}

}  // namespace

void mix_color(Frame& f, const uint32_t* w) {
  const float t = f.number(w[1]);
  const Rgb result =
      blend(f.mode<Blend>(w[4]), f.on(w[5]) ? clamp_unit(t) : t, f.vector(w[2]), f.vector(w[3]));
  f.set(w[0], f.on(w[6]) ? clamp_unit(result) : result);
}

void hue_saturation(Frame& f, const uint32_t* w) {
  const Rgb color = f.vector(w[5]);
  Vec3 hsv = rgb_to_hsv(color);
  hsv.x += f.number(w[1]) + 0.5f;
  hsv.x -= std::floor(hsv.x);
  hsv.y = clamp_unit(hsv.y * f.number(w[2]));
  hsv.z *= f.number(w[3]);
  f.set(w[0], max(mix(color, hsv_to_rgb(hsv), f.number(w[4])), Rgb{}));
}

void bright_contrast(Frame& f, const uint32_t* w) {
  const float contrast = f.number(w[3]), slope = 1 + contrast,
              shift = f.number(w[2]) - contrast * 0.5f;
  f.set(w[0], each(f.vector(w[1]), [&](float c) { return std::max(slope * c + shift, 0.0f); }));
}

void gamma(Frame& f, const uint32_t* w) {
  const float exponent = f.number(w[2]);
  if (exponent == 0) return f.set(w[0], kWhite);
  f.set(w[0],
        each(f.vector(w[1]), [exponent](float c) { return c > 0 ? std::pow(c, exponent) : c; }));
}

void separate_color(Frame& f, const uint32_t* w) {
  Vec3 c = f.vector(w[3]);
  const ColorModel model = f.mode<ColorModel>(w[4]);
  if (model == ColorModel::HSV) c = rgb_to_hsv(c);
  if (model == ColorModel::HSL) c = rgb_to_hsl(c);
  f.set(w[0], c.x);
  f.set(w[1], c.y);
  f.set(w[2], c.z);
}

void combine_color(Frame& f, const uint32_t* w) {
  const Vec3 c{f.number(w[1]), f.number(w[2]), f.number(w[3])};
  const ColorModel model = f.mode<ColorModel>(w[4]);
  f.set(w[0], model == ColorModel::HSV   ? hsv_to_rgb(c)
              : model == ColorModel::HSL ? hsl_to_rgb(c)
                                         : c);
}

void blackbody(Frame& f, const uint32_t* w) { f.set(w[0], blackbody_color(f.number(w[1]))); }
void wavelength(Frame& f, const uint32_t* w) { f.set(w[0], wavelength_color(f.number(w[1]))); }

}  // namespace photon_splat::nodes
