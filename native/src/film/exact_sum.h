// A sum of floats without any rounding: whatever their order and grouping, it is the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace photon_splat {

// All floats are multiples of the smallest one, so that their sum is an integer; it is kept in
// limbs of 32 bits that are carried late (Kulisch's accumulator).
class ExactSum {
 public:
  // Finite; up to 2^30 of them.
  void add(float value);
  // The nearest float, ties to even (the largest where it is beyond those), which is subtracted: of
  // one sum always the same sequence until nothing is left.
  float take();
  bool empty();

 private:
  static constexpr int kLimbs = 11;  // 2^-149 to 2^128, and what 2^30 of them carry
  void carry();

  int64_t limbs_[kLimbs] = {};
};

// Component c of sum i, from the largest on, at [c * count + i]: floats whose exact sum is that of
// the terms at [t * count + i]. One component at the least. Throws std::invalid_argument for a term
// that is not finite.
std::vector<float> exact_sums(const float* terms, size_t count_of_terms, size_t count);

}  // namespace photon_splat
