// Shadow catchers: a path from the camera that meets one goes on as two. Both see its material; the
// one meets everything, the other shadow catchers alone. What comes of them is kept apart from the
// rest of the picture, and film/shadow_catcher.h makes the shadow of the two. Both use the same
// random numbers: where nothing is in the way they bring the same light, and the shadow has no
// noise. Photons bring none of it: few land where the shadow is, and those of the second path would
// have to be traced anew.
#include "integrators/camera_path.h"

namespace photon_splat {

// Whether the camera sees what is there, as it sees the world in a transparent film.
bool CameraTracer::seen_clearly(const Path& path) const {
  const CameraSettings& film = camera_.settings();
  return (path.vertex == 0 && !path.through_glass) ||
         (path.clear && film.transparent && film.transparent_glass >= 0);
}

bool CameraTracer::catches(const Path& path, const Surface& hit) const {
  const Instance& instance = scene_.instances[hit.instance];
  return !path.caught && instance.catcher && !instance.holdout && seen_clearly(path);
}

// The rest of a path that has come to a catcher.
void CameraTracer::catch_shadows(Path& path, const Surface& hit) const {
  Pixel& pixel = path.pixel;
  const Pixel others = pixel;
  const auto begin = [&] {
    pixel = {};
    pixel.depth = others.depth;
    pixel.surface_id = others.surface_id;
  };
  const float passed = average(path.emission_throughput);
  const float stays = path.vertex == 0 && !path.through_glass ? 1 : 0;  // glass has counted it
  const Rgb backdrop = camera_.settings().transparent || path.vertex > 0
                           ? Rgb{}
                           : path.emission_throughput * world_seen(path);
  path.caught = true;
  path.leaves_gather_points = path.learns = path.tries_density = path.deep = false;
  path.groups = nullptr;
  Path alone = path;
  alone.info.catchers_only = alone.from.catchers_only = true;
  if (scene_.media()) alone.media = scene_.media()->of_catchers(path.media);

  begin();
  if (meet_surface(path, hit)) follow(path, hit);
  const Pixel among_all = pixel;
  begin();
  if (meet_surface(alone, hit)) follow(alone, hit);
  const Rgb light_alone = pixel.combined();

  pixel = others;
  add_finite(pixel.caught, among_all.combined(), path.tile.bad_samples);
  add_finite(pixel.caught_alone, light_alone, path.tile.bad_samples);
  add_finite(pixel.backdrop, backdrop, path.tile.bad_samples);
  pixel.alpha += stays - passed;
  pixel.caught_alpha += among_all.alpha - (stays - passed);
  pixel.normal += among_all.normal;
  pixel.diffuse_color += among_all.diffuse_color;
  pixel.glossy_color += among_all.glossy_color;
  pixel.transmission_color += among_all.transmission_color;
  pixel.albedo += among_all.albedo;
  pixel.feature_normal += among_all.feature_normal;
  pixel.ambient_occlusion += among_all.ambient_occlusion;
  pixel.depth = among_all.depth;
  pixel.surface_id = among_all.surface_id;
}

}  // namespace photon_splat
