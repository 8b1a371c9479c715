#include "geometry/attributes.h"

#include "textures/texture.h"

namespace photon_splat {

std::array<float, 4> MeshAttribute::at(const std::array<uint32_t, 3>& vertices, uint32_t triangle,
                                       float u, float v) const {
  const float weights[3] = {1 - u - v, u, v};
  std::array<float, 4> sum{};
  const auto add = [&](size_t element, float weight) {
    if (!bytes.empty()) {
      const uint8_t* p = &bytes[4 * element];
      for (uint32_t c = 0; c < 3; ++c) sum[c] += weight * decode_srgb_byte(p[c]);
      sum[3] += weight * static_cast<float>(p[3]) * (1.0f / 255.0f);
      return;
    }
    const float* p = &floats[components * element];
    for (uint32_t c = 0; c < components; ++c) sum[c] += weight * p[c];
  };
  if (domain == Domain::kFace)
    add(triangle, 1);
  else
    for (size_t k = 0; k < 3; ++k)
      add(domain == Domain::kPoint ? vertices[k] : 3 * size_t{triangle} + k, weights[k]);
  return sum;
}

void MeshAttribute::swap_corners(size_t a, size_t b) {
  if (domain != Domain::kCorner) return;
  for (uint32_t c = 0; c < components; ++c) {
    if (bytes.empty())
      std::swap(floats.own()[components * a + c], floats.own()[components * b + c]);
    else
      std::swap(bytes[components * a + c], bytes[components * b + c]);
  }
}

}  // namespace photon_splat
