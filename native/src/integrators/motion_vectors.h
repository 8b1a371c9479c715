// How far what the camera sees moves from frame to frame, in pixels.
#pragma once

#include "scene/camera.h"
#include "scene/scene.h"

namespace photon_splat {

// Where things are a frame earlier and a frame later.
struct NeighbouringFrames {
  std::vector<int32_t> of_instance;          // into `moves`; -1: it stays where it is
  std::vector<std::array<Affine, 2>> moves;  // from where a point of it is in the world
  // By mesh, of each vertex or key: how far it is from where it is now, in its own coordinates;
  // empty: it keeps its shape
  std::vector<std::array<std::vector<Vec3>, 2>> shapes;
  std::array<Affine, 2> camera;
  std::array<float, 2> zoom{1, 1};  // of the frame's size over that of now

  // Throws std::invalid_argument where it does not fit the scene.
  void check(const Scene& scene) const;
};

class MotionVectors {
 public:
  MotionVectors(const Scene& scene, const CameraSettings& camera, const NeighbouringFrames& frames);
  // As Cycles has them: x and y of the earlier place less those of now, and of now less the later.
  std::array<float, 4> at(const Surface& hit) const;
  // Motion of the background in this direction, which only the camera moves. As in Cycles
  // directions are not divided by their depth.
  std::array<float, 4> beyond(const Vec3& direction) const;

 private:
  Vec3 offset(const Surface& hit, int frame) const;
  // Projects a place in the camera's space; far: a direction.
  Vec2 project(const Vec3& p, float zoom, bool far = false) const;

  const Scene& scene_;
  const CameraSettings& camera_;
  const NeighbouringFrames& frames_;
  Affine to_camera_;
  std::array<Affine, 2> to_cameras_;
};

}  // namespace photon_splat
