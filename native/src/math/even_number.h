// A random number that is spread evenly over a pixel's samples and serves one decision after
// another: each leaves what it has not used.
#pragma once

#include "math/sampling.h"

namespace photon_splat {

class EvenNumber {
 public:
  // u: the number before all decisions; the same at each call.
  // Whether something of this probability happens.
  bool decide(float u, float probability, Random& random) {
    if (used_up()) return random.next() < probability;
    const bool yes = rest(u, random) < probability;
    if (!yes) begin_ += share_ * probability;
    share_ *= yes ? probability : 1 - probability;
    return yes;
  }
  // Nothing of it is left.
  void use_up() { share_ = 0; }
  // Uniform, whatever has been decided.
  float rest(float u, Random& random) const {
    return used_up() ? random.next() : std::clamp((u - begin_) / share_, 0.0f, kBelowOne);
  }

 private:
  // Narrowed to this share a number is not divided further
  static constexpr float kNarrowest = 1 / 4096.0f;
  bool used_up() const { return share_ < kNarrowest; }

  float begin_ = 0, share_ = 1;
};

}  // namespace photon_splat
