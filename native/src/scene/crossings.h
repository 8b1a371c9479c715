// What a short ray goes through.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace photon_splat {

// All surfaces that a ray meets, the first eight that are found, in no order.
struct Crossings {
  static constexpr size_t kMost = 8;
  struct Met {
    uint32_t instance, triangle;
    float u, v, distance;
    bool back;
  };
  std::array<Met, kMost> met;
  size_t count = 0;

  const Met* begin() const { return met.data(); }
  const Met* end() const { return met.data() + count; }
};

}  // namespace photon_splat
