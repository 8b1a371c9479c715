#include "density/clear_regions.h"

#include <doctest/doctest.h>

using namespace photon_splat;

namespace {

int looks_of_800(const ClearRegions& regions, uint64_t region) {
  int looks = 0;
  for (uint32_t chance = 0; chance < 800; ++chance) looks += regions.to_look_at(region, chance);
  return looks;
}

}  // namespace

TEST_CASE("few discs of a region are looked at once many have been clear") {
  ClearRegions regions;
  const uint64_t here = ClearRegions::region(7, {0.1f, 0.2f, 0.3f}, 0.1f),
                 there = ClearRegions::region(7, {5, 5, 5}, 0.1f);
  for (int i = 0; i < 15; ++i) regions.learn(here, true);
  CHECK(looks_of_800(regions, here) == 800);
  regions.learn(here, true);
  CHECK(looks_of_800(regions, here) == 50);
  CHECK(looks_of_800(regions, there) == 800);
}

TEST_CASE("all discs are looked at where one has not been clear, whenever that was") {
  ClearRegions early, late;
  const uint64_t here = ClearRegions::region(7, {0.1f, 0.2f, 0.3f}, 0.1f);
  early.learn(here, false);
  for (int i = 0; i < 100; ++i) early.learn(here, true), late.learn(here, true);
  late.learn(here, false);
  CHECK(looks_of_800(early, here) == 800);
  CHECK(looks_of_800(late, here) == 800);
}

TEST_CASE("regions are told apart by surface, by place and by size of the disc") {
  const Vec3 x{0.1f, -0.2f, 0.3f};
  const uint64_t here = ClearRegions::region(7, x, 0.1f);
  CHECK(here == ClearRegions::region(7, x + Vec3{0.001f, 0, 0}, 0.11f));
  CHECK(here != ClearRegions::region(8, x, 0.1f));
  CHECK(here != ClearRegions::region(7, x, 0.05f));
  for (const Vec3& way : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    CHECK(here != ClearRegions::region(7, x + way * 0.5f, 0.1f));
    CHECK(here != ClearRegions::region(7, x - way * 0.5f, 0.1f));
  }
}
