#include "util/gather.h"

#include <doctest/doctest.h>

#include <stdexcept>
#include <vector>

using namespace photon_splat;

TEST_CASE("rows are gathered by their numbers, few and many") {
  for (const uint32_t width : {1, 2, 3})
    for (const size_t count : {size_t{0}, size_t{5}, size_t{300000}}) {
      const uint32_t rows = 1000;
      std::vector<uint32_t> values(width * rows), indices(count), out(width * count);
      for (size_t i = 0; i < values.size(); ++i) values[i] = static_cast<uint32_t>(7 * i);
      for (size_t i = 0; i < count; ++i) indices[i] = static_cast<uint32_t>(i * 97 % rows);
      gather(values, width, indices, out);
      size_t wrong = 0;
      for (size_t i = 0; i < out.size(); ++i)
        wrong += out[i] != values[indices[i / width] * width + i % width];
      CHECK(wrong == 0);
    }
}

TEST_CASE("a row that does not exist, or has no room, is said") {
  std::vector<uint32_t> values(6), out(2);
  CHECK_THROWS_AS(gather(values, 2, std::vector<uint32_t>{3}, out), std::invalid_argument);
  CHECK_THROWS_AS(gather(values, 2, std::vector<uint32_t>{~0u}, out), std::invalid_argument);
  CHECK_THROWS_AS(gather(values, 2, std::vector<uint32_t>{0, 1}, out), std::invalid_argument);
  CHECK_THROWS_AS(gather(values, 0, std::vector<uint32_t>{0}, out), std::invalid_argument);
}
