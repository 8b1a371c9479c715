#include "util/gather.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "util/parallel.h"

namespace photon_splat {
namespace {

constexpr size_t kPart = 1 << 16;

template <uint32_t width>
void gather_rows(std::span<const uint32_t> values, std::span<const uint32_t> indices,
                 std::span<uint32_t> out) {
  const size_t rows = values.size() / width;
  std::atomic<bool> outside{false};
  for_parts_by_all(indices.size(), kPart, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t from = indices[i];
      if (from >= rows) {
        outside = true;
        return;
      }
      std::copy_n(&values[from * width], width, &out[i * width]);
    }
  });
  if (outside) throw std::invalid_argument("an index names an element that does not exist");
}

}  // namespace

void gather(std::span<const uint32_t> values, uint32_t width, std::span<const uint32_t> indices,
            std::span<uint32_t> out) {
  if (out.size() != indices.size() * width)
    throw std::invalid_argument("there is no room for what is gathered");
  if (width == 1) return gather_rows<1>(values, indices, out);
  if (width == 2) return gather_rows<2>(values, indices, out);
  if (width == 3) return gather_rows<3>(values, indices, out);
  throw std::invalid_argument("rows of one to three numbers can be gathered");
}

}  // namespace photon_splat
