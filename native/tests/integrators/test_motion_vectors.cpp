#include "integrators/motion_vectors.h"

#include <doctest/doctest.h>

#include <stdexcept>

using namespace photon_splat;

TEST_CASE("neighbouring frames that do not fit the scene are refused") {
  Scene scene(1);
  NeighbouringFrames frames;
  frames.check(scene);
  frames.of_instance = {-1};
  CHECK_THROWS_AS(frames.check(scene), std::invalid_argument);
  scene.instances.resize(1);
  scene.meshes.resize(1);
  scene.meshes[0].positions.resize(4);  // one more than there are vertices
  frames.shapes.resize(1);
  frames.check(scene);
  frames.of_instance = {0};  // of no moves
  CHECK_THROWS_AS(frames.check(scene), std::invalid_argument);
  frames.moves.resize(1);
  frames.check(scene);
  frames.shapes[0][1].resize(3);
  frames.check(scene);
  frames.shapes[0][1].resize(4);
  CHECK_THROWS_AS(frames.check(scene), std::invalid_argument);
}
