// Elements of an array by their numbers, by all threads.
#pragma once

#include <cstdint>
#include <span>

namespace photon_splat {

// Row indices[i] of `values`, `width` numbers a row (1 to 3), as row i of `out`. Throws
// std::invalid_argument for rows that do not exist.
void gather(std::span<const uint32_t> values, uint32_t width, std::span<const uint32_t> indices,
            std::span<uint32_t> out);

}  // namespace photon_splat
