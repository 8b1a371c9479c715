// Another camera without another build: for renders of the same scene, and for a viewport, whose
// pictures while the camera moves come from photons that serve every view.
#include "render/renderer.h"
#include "shading/sees_view.h"

namespace photon_splat {

void Renderer::set_view() {
  map();
  *camera_ = Camera(camera_settings);
  reset_film();
}

void Renderer::relight() {
  map();
  check_light_groups();
  scene.update_features();
  scene.update_own_scenes(cancel_);
  scene.update_media(cancel_);
  current_ = nullptr;  // what they were made of goes
  maps_.clear();
  camera_pass_.reset();
  make_lights();
  make_camera_pass();
  make_maps();
  set_view();
}

void Renderer::begin_again() {
  map();
  seconds_ = {};
  if (std::any_of(scene.programs.begin(), scene.programs.end(), sees_view)) return relight();
  make_camera_pass();
  for (const auto& map : maps_) map->begin_again();
  current_ = maps_.front().get();
  set_view();
}

void Renderer::trace_viewport_photons(uint64_t paths, size_t most_bytes) {
  map();
  for (const auto& map : maps_) map->trace_viewport_photons(paths, most_bytes / maps_.size());
}

void Renderer::draw_viewport() {
  map();
  for (const auto& map : maps_)
    if (!map->viewport_photons() || !map->viewport_photons()->radii())
      throw std::logic_error("trace_viewport_photons() comes before draw_viewport()");
  set_view();
  camera_pass_->set_beams(nullptr);
  camera_pass_->trace_gather_points(0, maps_, film_.begin_pass());
  for (const auto& map : maps_) map->place_viewport_points(*camera_pass_->gather_points());
  resolve();
}

}  // namespace photon_splat
