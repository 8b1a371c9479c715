#include "util/large_pages.h"

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>

using namespace photon_splat;

TEST_CASE("an array that grows into large pages and beyond keeps its values") {
  constexpr size_t few = 1000, many = 3 * LargePages<uint64_t>::kLeast / sizeof(uint64_t) + 1;
  LargeArray<uint64_t> values(few);
  for (size_t i = 0; i < few; ++i) values[i] = i;
  for (size_t i = few; i < many; ++i) values.push_back(i);
  size_t wrong = 0;
  for (size_t i = 0; i < many; ++i) wrong += values[i] != i;
  CHECK(wrong == 0);
#ifdef __linux__  // Windows aligns to 2 MB only what it grants in large pages
  CHECK(reinterpret_cast<uintptr_t>(values.data()) % kLargePage == 0);
#endif
}

TEST_CASE("more than a process can address is refused") {
  CHECK_THROWS_AS(LargePages<double>{}.allocate(std::numeric_limits<size_t>::max() / 2),
                  std::bad_alloc);
}
