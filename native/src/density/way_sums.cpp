#include "density/way_sums.h"

#include <cstring>

namespace photon_splat {

void WaySums::set_up() {
  uint32_t count = 0;
  for (uint32_t& first : first_)
    if (first != kNone) first = count++;
  sums_.resize(count);
  if (count) std::memset(static_cast<void*>(sums_.data()), 0, count * sizeof(WayBlock));
}

}  // namespace photon_splat
