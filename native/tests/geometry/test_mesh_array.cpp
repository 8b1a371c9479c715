#include "geometry/mesh_array.h"

#include <doctest/doctest.h>

#include <vector>

using namespace photon_splat;

TEST_CASE("an array that is lent is read where it is, and copied before it changes") {
  auto lender = std::make_shared<std::vector<int>>(std::vector{1, 2, 3});
  const std::weak_ptr<std::vector<int>> alive = lender;
  const int* const memory = lender->data();
  MeshArray<int> lent(memory, 3, std::move(lender));
  CHECK(lent.data() == memory);
  const MeshArray<int> other = lent;
  CHECK(other.data() == memory);

  lent.own()[1] = 7;
  CHECK(std::vector<int>(lent.begin(), lent.end()) == std::vector{1, 7, 3});
  CHECK(std::vector<int>(other.begin(), other.end()) == std::vector{1, 2, 3});
  lent.own().push_back(8);
  CHECK(lent.size() == 4);
  CHECK(!alive.expired());
  lent = other;
  CHECK(lent.data() == memory);
}

TEST_CASE("the lender is let go with the last array that reads its memory") {
  auto lender = std::make_shared<std::vector<int>>(4, 5);
  const std::weak_ptr<std::vector<int>> alive = lender;
  const int* const memory = lender->data();
  {
    MeshArray<int> lent(memory, 4, std::move(lender));
    CHECK(!alive.expired());
    lent.own();
    CHECK(alive.expired());
    CHECK(lent[3] == 5);
  }
  CHECK(MeshArray<int>().empty());
}
