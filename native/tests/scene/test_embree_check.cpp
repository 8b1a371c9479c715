#include "scene/embree_check.h"

#include <doctest/doctest.h>

TEST_CASE("the Embree that we are built for is accepted") {
  CHECK_NOTHROW(photon_splat::check_embree_version());
}
