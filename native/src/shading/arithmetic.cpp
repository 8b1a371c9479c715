// Numbers, vectors, ranges, ramps and curves. Where a function has no value (a division by 0, a
// root of a negative number) the result is Cycles', mostly 0.
#include <cstring>

#include "math/lanes.h"
#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

float power(float a, float b) {
  if (b == 0) return 1;
  if (a == 0) return 0;
  return a < 0 && b != std::trunc(b) ? 0 : std::pow(a, b);
}

float sign(float a) { return static_cast<float>((a > 0) - (a < 0)); }
float fraction(float a) { return a - std::floor(a); }
float modulo(float a, float b) { return b != 0 ? std::fmod(a, b) : 0; }
float floored_modulo(float a, float b) { return b != 0 ? a - std::floor(a / b) * b : 0; }
float wrapped(float a, float max, float min) {
  const float range = max - min;
  return range != 0 ? a - range * std::floor((a - min) / range) : min;
}
float snap(float a, float step) { return std::floor(safe_divide(a, step)) * step; }
float round_half_up(float a) { return std::floor(a + 0.5f); }

// The polynomial minimum of Quilez, cubic, of width k.
float smooth_minimum(float a, float b, float k) {
  if (k == 0) return std::min(a, b);
  const float h = std::max(k - std::abs(a - b), 0.0f) / k;
  return std::min(a, b) - h * h * h * k * (1.0f / 6.0f);
}

float smoothstep(float edge0, float edge1, float x) {
  if (x < edge0) return 0;
  if (x >= edge1) return 1;
  const float t = (x - edge0) / (edge1 - edge0);
  return (3 - 2 * t) * t * t;
}
float smootherstep(float edge0, float edge1, float x) {
  const float t = clamp_unit(safe_divide(x - edge0, edge1 - edge0));
  return t * t * t * (t * (t * 6 - 15) + 10);
}

float evaluate(MathOperation operation, float a, float b, float c) {
  using enum MathOperation;
  switch (operation) {
    case ADD: return a + b;
    case SUBTRACT: return a - b;
    case MULTIPLY: return a * b;
    case DIVIDE: return safe_divide(a, b);
    case MULTIPLY_ADD: return a * b + c;
    case POWER: return power(a, b);
    case LOGARITHM: return a > 0 && b > 0 ? safe_divide(std::log(a), std::log(b)) : 0;
    case SQRT: return std::sqrt(std::max(a, 0.0f));
    case INVERSE_SQRT: return a > 0 ? 1 / std::sqrt(a) : 0;
    case ABSOLUTE: return std::abs(a);
    case EXPONENT: return std::exp(a);
    case MINIMUM: return std::min(a, b);
    case MAXIMUM: return std::max(a, b);
    case LESS_THAN: return a < b ? 1.0f : 0.0f;
    case GREATER_THAN: return a > b ? 1.0f : 0.0f;
    case SIGN: return sign(a);
    case COMPARE: return a == b || std::abs(a - b) <= std::max(c, 1.1920929e-7f) ? 1.0f : 0.0f;
    case SMOOTH_MIN: return smooth_minimum(a, b, c);
    case SMOOTH_MAX: return -smooth_minimum(-a, -b, c);
    case ROUND: return round_half_up(a);
    case FLOOR: return std::floor(a);
    case CEIL: return std::ceil(a);
    case TRUNC: return std::trunc(a);
    case FRACT: return fraction(a);
    case MODULO: return modulo(a, b);
    case FLOORED_MODULO: return floored_modulo(a, b);
    case WRAP: return wrapped(a, b, c);
    case SNAP: return snap(a, b);
    case PINGPONG: return b != 0 ? std::abs(fraction((a - b) / (b * 2)) * b * 2 - b) : 0;
    case SINE: return std::sin(a);
    case COSINE: return std::cos(a);
    case TANGENT: return std::tan(a);
    case ARCSINE: return std::asin(std::clamp(a, -1.0f, 1.0f));
    case ARCCOSINE: return std::acos(std::clamp(a, -1.0f, 1.0f));
    case ARCTANGENT: return std::atan(a);
    case ARCTAN2: return a == 0 && b == 0 ? 0 : std::atan2(a, b);
    case SINH: return std::sinh(a);
    case COSH: return std::cosh(a);
    case TANH: return std::tanh(a);
    case RADIANS: return a * (kPi / 180);
    case DEGREES: return a * (180 / kPi);
  }
  return 0;
}

Vec3 refract(const Vec3& incident, const Vec3& normal, float eta) {
  const float cosine = dot(normal, incident);
  const float k = 1 - eta * eta * (1 - cosine * cosine);
  return k < 0 ? Vec3{} : incident * eta - normal * (eta * cosine + std::sqrt(k));
}

// Sets `value` for an operation that yields a number, else `vector`.
void evaluate(VectorOperation operation, const Vec3& a, const Vec3& b, const Vec3& c, float scale,
              Vec3& vector, float& value) {
  using enum VectorOperation;
  switch (operation) {
    case ADD: vector = a + b; return;
    case SUBTRACT: vector = a - b; return;
    case MULTIPLY: vector = a * b; return;
    case DIVIDE: vector = safe_divide(a, b); return;
    case MULTIPLY_ADD: vector = a * b + c; return;
    case CROSS_PRODUCT: vector = cross(a, b); return;
    case PROJECT: {
      const float l2 = length2(b);
      vector = l2 != 0 ? b * (dot(a, b) / l2) : Vec3{};
      return;
    }
    case REFLECT: {
      const Vec3 n = safe_normalize(b);
      vector = a - n * (2 * dot(a, n));
      return;
    }
    case REFRACT: vector = refract(a, safe_normalize(b), scale); return;
    case FACEFORWARD: vector = dot(c, b) < 0 ? a : -a; return;
    case DOT_PRODUCT: value = dot(a, b); return;
    case DISTANCE: value = length(a - b); return;
    case LENGTH: value = length(a); return;
    case SCALE: vector = a * scale; return;
    case NORMALIZE: vector = safe_normalize(a); return;
    case ABSOLUTE: vector = each(a, [](float x) { return std::abs(x); }); return;
    case POWER: vector = each(a, b, power); return;
    case SIGN: vector = each(a, sign); return;
    case MINIMUM: vector = min(a, b); return;
    case MAXIMUM: vector = max(a, b); return;
    case ROUND: vector = each(a, round_half_up); return;
    case FLOOR: vector = each(a, [](float x) { return std::floor(x); }); return;
    case CEIL: vector = each(a, [](float x) { return std::ceil(x); }); return;
    case FRACTION: vector = each(a, fraction); return;
    case MODULO: vector = each(a, b, modulo); return;
    case WRAP: vector = each(a - c, b - c, floored_modulo) + c; return;
    case SNAP: vector = each(a, b, snap); return;
    case SINE: vector = each(a, [](float x) { return std::sin(x); }); return;
    case COSINE: vector = each(a, [](float x) { return std::cos(x); }); return;
    case TANGENT: vector = each(a, [](float x) { return std::tan(x); }); return;
  }
}

float steps_of(float factor, float steps) {
  return steps > 0 ? std::floor(factor * (steps + 1)) / steps : 0;
}

float clamp_between(float x, float a, float b) {
  return std::min(std::max(x, std::min(a, b)), std::max(a, b));
}

// Component `c` of a table's entry at `x` in 0..1; `at` is the table's length followed by its
// entries of `stride` floats.
float look_up(const float* at, uint32_t stride, uint32_t c, float x, bool extrapolate) {
  const int last = static_cast<int>(at[0]) - 1;
  const float* values = at + 1 + c;
  const auto entry = [&](int i) { return values[static_cast<size_t>(i) * stride]; };
  if (extrapolate && (x < 0 || x > 1)) {
    const float end = x < 0 ? entry(0) : entry(last), inner = x < 0 ? entry(1) : entry(last - 1);
    return end + (end - inner) * (x < 0 ? -x : x - 1) * static_cast<float>(last);
  }
  x = clamp_unit(x) * static_cast<float>(last);
  const int i = std::clamp(to_int(x), 0, last);
  const float t = x - static_cast<float>(i);
  return t > 0 ? (1 - t) * entry(i) + t * entry(i + 1) : entry(i);
}

// Rotation by Euler angles in the order XYZ: columns of the matrix Rz Ry Rx.
struct Rotation {
  Vec3 x, y, z;

  explicit Rotation(const Vec3& euler) {
    const float cx = std::cos(euler.x), sx = std::sin(euler.x), cy = std::cos(euler.y),
                sy = std::sin(euler.y), cz = std::cos(euler.z), sz = std::sin(euler.z);
    x = {cy * cz, cy * sz, -sy};
    y = {sy * sx * cz - cx * sz, sy * sx * sz + cx * cz, cy * sx};
    z = {sy * cx * cz + sx * sz, sy * cx * sz - sx * cz, cy * cx};
  }
  Vec3 apply(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 undo(const Vec3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

Vec3 rotate_around(const Vec3& v, const Vec3& axis, float angle) {  // Rodrigues' formula
  const float c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

}  // namespace

void math(Frame& f, const uint32_t* w) {
  const float result =
      evaluate(f.mode<MathOperation>(w[4]), f.number(w[1]), f.number(w[2]), f.number(w[3]));
  f.set(w[0], f.on(w[5]) ? clamp_unit(result) : result);
}

void vector_math(Frame& f, const uint32_t* w) {
  Vec3 vector;
  float value = 0;
  evaluate(f.mode<VectorOperation>(w[6]), f.vector(w[2]), f.vector(w[3]), f.vector(w[4]),
           f.number(w[5]), vector, value);
  f.set(w[0], vector);
  f.set(w[1], value);
}

void map_range(Frame& f, const uint32_t* w) {
  using enum RangeInterpolation;
  const float x = f.number(w[1]), from_min = f.number(w[2]), from_max = f.number(w[3]),
              to_min = f.number(w[4]), to_max = f.number(w[5]);
  const RangeInterpolation kind = f.mode<RangeInterpolation>(w[7]);
  if (from_min == from_max)
    return f.set(w[0], f.on(w[8]) ? clamp_between(0, to_min, to_max) : 0.0f);
  const bool falling = from_min > from_max;
  float factor = (x - from_min) / (from_max - from_min);
  if (kind == STEPPED) factor = steps_of(factor, f.number(w[6]));
  if (kind == SMOOTHSTEP)
    factor = falling ? 1 - smoothstep(from_max, from_min, x) : smoothstep(from_min, from_max, x);
  if (kind == SMOOTHERSTEP)
    factor =
        falling ? 1 - smootherstep(from_max, from_min, x) : smootherstep(from_min, from_max, x);
  const float result = to_min + factor * (to_max - to_min);
  f.set(w[0], f.on(w[8]) ? clamp_between(result, to_min, to_max) : result);
}

void map_range_vector(Frame& f, const uint32_t* w) {
  using enum RangeInterpolation;
  const Vec3 from_min = f.vector(w[2]), to_min = f.vector(w[4]), to_max = f.vector(w[5]);
  const RangeInterpolation kind = f.mode<RangeInterpolation>(w[7]);
  Vec3 factor = safe_divide(f.vector(w[1]) - from_min, f.vector(w[3]) - from_min);
  if (kind == STEPPED) factor = each(factor, f.vector(w[6]), steps_of);
  if (kind == SMOOTHSTEP) factor = each(factor, [](float t) { return smoothstep(0, 1, t); });
  if (kind == SMOOTHERSTEP) factor = each(factor, [](float t) { return smootherstep(0, 1, t); });
  Vec3 result = to_min + factor * (to_max - to_min);
  if (f.on(w[8]) && (kind == LINEAR || kind == STEPPED))
    result = {clamp_between(result.x, to_min.x, to_max.x),
              clamp_between(result.y, to_min.y, to_max.y),
              clamp_between(result.z, to_min.z, to_max.z)};
  f.set(w[0], result);
}

void clamp(Frame& f, const uint32_t* w) {
  const float x = f.number(w[1]), low = f.number(w[2]), high = f.number(w[3]);
  if (f.mode<ClampType>(w[4]) == ClampType::RANGE) return f.set(w[0], clamp_between(x, low, high));
  f.set(w[0], std::min(std::max(x, low), high));
}

void color_ramp(Frame& f, const uint32_t* w) {
  const float x = f.number(w[2]);
  const float* table = f.constants + w[3];
  const int last = static_cast<int>(table[0]) - 1;
  const float at = x > 0 ? std::min(x, 1.0f) * static_cast<float>(last) : 0.0f;
  const int i = std::min(static_cast<int>(at), last);
  const float t = f.on(w[4]) ? at - static_cast<float>(i) : 0.0f;
  Floats low, high;
  std::memcpy(&low, table + 1 + 4 * i, sizeof low);
  std::memcpy(&high, table + 1 + 4 * std::min(i + 1, last), sizeof high);
  const Floats color = low * (1 - t) + high * t;
  f.set(w[1], color[3]);
  f.set(w[0], Vec3{color[0], color[1], color[2]});
}

void float_curve(Frame& f, const uint32_t* w) {
  const float t = f.number(w[1]), x = f.number(w[2]), low = f.number(w[4]);
  const float y = look_up(f.constants + w[3], 1, 0, (x - low) / (f.number(w[5]) - low), f.on(w[6]));
  f.set(w[0], mix(x, y, t));
}

void curves(Frame& f, const uint32_t* w) {
  const float t = f.number(w[1]), low = f.number(w[4]), range = f.number(w[5]) - low;
  const Vec3 x = f.vector(w[2]);
  const float* table = f.constants + w[3];
  const bool extrapolate = f.on(w[6]);
  const auto curve = [&](uint32_t c) {
    return look_up(table, 3, c, (x[static_cast<int>(c)] - low) / range, extrapolate);
  };
  f.set(w[0], mix(x, Vec3{curve(0), curve(1), curve(2)}, t));
}

void vector_rotate(Frame& f, const uint32_t* w) {
  const Vec3 center = f.vector(w[2]), v = f.vector(w[1]) - center;
  const RotationType type = f.mode<RotationType>(w[6]);
  const bool invert = f.on(w[7]);
  if (type == RotationType::EULER_XYZ) {
    const Rotation rotation(f.vector(w[5]));
    return f.set(w[0], (invert ? rotation.undo(v) : rotation.apply(v)) + center);
  }
  Vec3 axis = type == RotationType::X_AXIS   ? Vec3{1, 0, 0}
              : type == RotationType::Y_AXIS ? Vec3{0, 1, 0}
                                             : Vec3{0, 0, 1};
  if (type == RotationType::AXIS_ANGLE) axis = safe_normalize(f.vector(w[3]));
  const float angle = f.number(w[4]);
  f.set(w[0], length2(axis) > 0 ? rotate_around(v, axis, invert ? -angle : angle) + center
                                : f.vector(w[1]));
}

void mapping(Frame& f, const uint32_t* w) {
  const Vec3 v = f.vector(w[1]), location = f.vector(w[2]), scale = f.vector(w[4]);
  const Rotation rotation(f.vector(w[3]));
  Vec3 result;
  switch (f.mode<MappingType>(w[5])) {
    case MappingType::POINT: result = rotation.apply(v * scale) + location; break;
    case MappingType::TEXTURE: result = safe_divide(rotation.undo(v - location), scale); break;
    case MappingType::VECTOR: result = rotation.apply(v * scale); break;
    case MappingType::NORMAL: result = safe_normalize(rotation.apply(safe_divide(v, scale))); break;
  }
  f.set(w[0], result);
}

void transform_point(Frame& f, const uint32_t* w) {
  const float* m = f.constants + w[2];
  const Vec3 p = f.vector(w[1]);
  f.set(w[0], Vec3{m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                   m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                   m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]});
}

}  // namespace photon_splat::nodes
