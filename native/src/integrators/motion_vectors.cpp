#include "integrators/motion_vectors.h"

#include <stdexcept>

namespace photon_splat {
namespace {

std::array<float, 4> between(const Vec2& before, const Vec2& now, const Vec2& after) {
  return {before.x - now.x, before.y - now.y, now.x - after.x, now.y - after.y};
}

}  // namespace

void NeighbouringFrames::check(const Scene& scene) const {
  const auto refuse = [](bool wrong) {
    if (wrong) throw std::invalid_argument("the neighbouring frames do not fit the scene");
  };
  refuse(of_instance.size() != scene.instances.size() || shapes.size() != scene.meshes.size());
  for (const int32_t move : of_instance) refuse(move >= static_cast<int32_t>(moves.size()));
  for (size_t i = 0; i < shapes.size(); ++i) {
    const Mesh& mesh = scene.meshes[i];
    const size_t places =
        mesh.strands ? mesh.strands->key_count() : mesh.positions.size() - !mesh.positions.empty();
    for (const auto& shape : shapes[i]) refuse(!shape.empty() && shape.size() != places);
  }
}

MotionVectors::MotionVectors(const Scene& scene, const CameraSettings& camera,
                             const NeighbouringFrames& frames)
    : scene_(scene),
      camera_(camera),
      frames_(frames),
      to_camera_(inverse(camera.to_world)),
      to_cameras_{inverse(frames.camera[0]), inverse(frames.camera[1])} {}

std::array<float, 4> MotionVectors::at(const Surface& hit) const {
  const Instance& instance = scene_.instances[hit.instance];
  const Mesh& mesh = scene_.meshes[instance.mesh];
  Vec3 now = hit.position;
  if (mesh.strands && !mesh.strands->are_curves()) {  // the middle of a ball
    now = mesh.strands->key(hit.triangle, kShutterCentre).position;
    if (instance.shared) now = instance.to_world.point(now);
  }
  const Vec2 here = project(to_camera_.point(now), 1);
  Vec2 there[2];
  const int32_t move = frames_.of_instance[hit.instance];
  for (int frame = 0; frame < 2; ++frame) {
    Vec3 x = now + offset(hit, frame);
    if (move >= 0) x = frames_.moves[static_cast<size_t>(move)][frame].point(x);
    there[frame] = project(to_cameras_[frame].point(x), frames_.zoom[frame]);
  }
  return between(there[0], here, there[1]);
}

std::array<float, 4> MotionVectors::beyond(const Vec3& direction) const {
  Vec2 there[2];
  for (int frame = 0; frame < 2; ++frame)
    there[frame] = project(to_cameras_[frame].vector(direction), frames_.zoom[frame], true);
  return between(there[0], project(to_camera_.vector(direction), 1, true), there[1]);
}

// By which its shape has moved the point in the other frame, in the world of now.
Vec3 MotionVectors::offset(const Surface& hit, int frame) const {
  const Instance& instance = scene_.instances[hit.instance];
  const auto& shape = frames_.shapes[instance.mesh][frame];
  if (shape.empty()) return {};
  const Mesh& mesh = scene_.meshes[instance.mesh];
  Vec3 own;
  if (!mesh.strands) {
    const Triangle& t = mesh.triangles[hit.triangle];
    own = shape[t[0]] * (1 - hit.u - hit.v) + shape[t[1]] * hit.u + shape[t[2]] * hit.v;
  } else if (mesh.strands->are_curves()) {
    const uint32_t first = mesh.strands->first_key(hit.triangle);
    own = shape[first] * (1 - hit.u) + shape[first + 1] * hit.u;
  } else {
    own = shape[hit.triangle];
  }
  return inverse(scene_.world_to_object[hit.instance]).vector(own);
}

// In pixels from the frame's lower left corner; of what lies in the camera's plane anywhere.
Vec2 MotionVectors::project(const Vec3& p, float zoom, bool far) const {
  const CameraSettings& c = camera_;
  Vec2 screen;
  if (c.panorama.kind != PanoramaKind::kNone) {
    screen = panorama_place(c.panorama, normalize(p));
  } else {
    const float scale = (c.orthographic || far ? 1 : p.z != 0 ? -1 / p.z : 0) / zoom;
    screen = {p.x * scale, p.y * scale};
  }
  const bool flat = c.orthographic || c.panorama.kind != PanoramaKind::kNone;
  const float corner = far && !flat ? -p.z : 1;
  return {(screen.x - c.left * corner) / (c.right - c.left) * static_cast<float>(c.width),
          (screen.y - c.bottom * corner) / (c.top - c.bottom) * static_cast<float>(c.height)};
}

}  // namespace photon_splat
