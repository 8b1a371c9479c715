#include "film/exact_sum.h"

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace photon_splat {
namespace {

constexpr int kMantissa = 24, kLimbBits = 32;
constexpr int kLeastExponent = -149;  // of a multiple of the smallest float
constexpr int kMostShift = 253;       // of the largest float's mantissa

}  // namespace

void ExactSum::add(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  const uint32_t exponent = bits >> 23 & 255;
  const int64_t mantissa = (bits & 0x7fffff) | (exponent ? 0x800000 : 0);
  const int shift = exponent ? static_cast<int>(exponent) - 1 : 0;
  const int64_t shifted = mantissa << shift % kLimbBits;
  const int64_t low = shifted & 0xffffffff, high = shifted >> kLimbBits;
  const int64_t sign = bits >> 31 ? -1 : 1;
  limbs_[shift / kLimbBits] += sign * low;
  limbs_[shift / kLimbBits + 1] += sign * high;
}

// Limbs are then 0..2^32-1; the last one has the sign.
void ExactSum::carry() {
  for (int i = 0; i + 1 < kLimbs; ++i) {
    limbs_[i + 1] += limbs_[i] >> kLimbBits;
    limbs_[i] &= 0xffffffff;
  }
}

bool ExactSum::empty() {
  carry();
  for (const int64_t limb : limbs_)
    if (limb) return false;
  return true;
}

float ExactSum::take() {
  carry();
  ExactSum size = *this;
  const bool negative = limbs_[kLimbs - 1] < 0;
  if (negative) {
    for (int64_t& limb : size.limbs_) limb = -limb;
    size.carry();
  }
  int top = kLimbs - 1;
  while (top >= 0 && !size.limbs_[top]) --top;
  if (top < 0) return 0;
  const int bits = top * kLimbBits + std::bit_width(static_cast<uint64_t>(size.limbs_[top]));
  const int drop = bits > kMantissa ? bits - kMantissa : 0;  // bits below the mantissa's
  const auto bit = [&](int at) { return size.limbs_[at / kLimbBits] >> at % kLimbBits & 1; };
  uint32_t mantissa = 0;
  for (int at = bits - 1; at >= drop; --at)
    mantissa = mantissa << 1 | static_cast<uint32_t>(bit(at));
  if (drop && bit(drop - 1)) {
    bool tie = true;
    for (int at = 0; tie && at < drop - 1; ++at) tie = !bit(at);
    if (!tie || mantissa & 1) ++mantissa;
  }
  float value = drop > kMostShift ? std::numeric_limits<float>::max()
                                  : std::ldexp(static_cast<float>(mantissa), drop + kLeastExponent);
  if (!std::isfinite(value)) value = std::numeric_limits<float>::max();
  if (negative) value = -value;
  add(-value);
  return value;
}

std::vector<float> exact_sums(const float* terms, size_t count_of_terms, size_t count) {
  std::vector<float> out(count);
  for (size_t i = 0; i < count; ++i) {
    ExactSum sum;
    bool any = false;
    for (size_t t = 0; t < count_of_terms; ++t) {
      const float value = terms[t * count + i];
      if (!std::isfinite(value))
        throw std::invalid_argument("a sum holds a value that is not finite");
      if (value == 0) continue;
      sum.add(value);
      any = true;
    }
    for (size_t c = 0; any && !sum.empty(); ++c) {
      if (out.size() < (c + 1) * count) out.resize((c + 1) * count);
      out[c * count + i] = sum.take();
    }
  }
  return out;
}

}  // namespace photon_splat
