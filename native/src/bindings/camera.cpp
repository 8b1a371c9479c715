#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

void set_camera(Renderer& r, Matrix matrix, std::array<float, 4> screen, bool orthographic,
                float clip_start, float clip_end, std::array<int, 2> frame,
                std::array<int, 4> region, bool transparent, float transparent_glass,
                float alpha_threshold, const std::string& filter, float filter_width,
                float exposure) {
  CameraSettings c;
  c.to_world = relative(matrix, r.scene.origin);
  c.left = screen[0];
  c.right = screen[1];
  c.bottom = screen[2];
  c.top = screen[3];
  c.orthographic = orthographic;
  c.clip_start = clip_start;
  c.clip_end = clip_end;
  c.width = frame[0];
  c.height = frame[1];
  c.x0 = region[0];
  c.y0 = region[1];
  c.region_width = region[2];
  c.region_height = region[3];
  c.transparent = transparent;
  c.transparent_glass = transparent_glass;
  c.alpha_threshold = alpha_threshold;
  c.exposure = exposure;
  c.filter = named<FilterKind>(filter,
                               {{"box", FilterKind::kBox},
                                {"gaussian", FilterKind::kGaussian},
                                {"blackman_harris", FilterKind::kBlackmanHarris}},
                               "pixel filter");
  c.filter_width = filter_width;
  r.camera_settings = c;
}

void set_panorama(Renderer& r, const std::string& kind, std::array<float, 2> longitude,
                  std::array<float, 2> latitude, float fov, float focal_length,
                  std::array<float, 2> sensor, std::array<float, 5> polynomial,
                  std::array<float, 4> cylinder) {
  PanoramaSettings p;
  p.kind = named<PanoramaKind>(kind,
                               {{"equirectangular", PanoramaKind::kEquirectangular},
                                {"equiangular_cubemap_face", PanoramaKind::kEquiangularCubeFace},
                                {"mirrorball", PanoramaKind::kMirrorBall},
                                {"fisheye_equidistant", PanoramaKind::kFisheyeEquidistant},
                                {"fisheye_equisolid", PanoramaKind::kFisheyeEquisolid},
                                {"fisheye_lens_polynomial", PanoramaKind::kFisheyePolynomial},
                                {"central_cylindrical", PanoramaKind::kCentralCylindrical}},
                               "panorama");
  p.longitude_min = longitude[0], p.longitude_max = longitude[1];
  p.latitude_min = latitude[0], p.latitude_max = latitude[1];
  p.fov = fov;
  p.focal_length = focal_length;
  p.sensor_width = sensor[0], p.sensor_height = sensor[1];
  p.polynomial = polynomial;
  p.u_min = cylinder[0], p.u_max = cylinder[1], p.v_min = cylinder[2], p.v_max = cylinder[3];
  r.camera_settings.panorama = r.scene.view.panorama = p;
}

}  // namespace

void bind_camera(RendererClass& renderer) {
  renderer
      .def(
          "set_camera", &set_camera, "matrix"_a, "screen"_a, "orthographic"_a, "clip_start"_a,
          "clip_end"_a, "frame"_a, "region"_a, "transparent"_a, "transparent_glass"_a,
          "alpha_threshold"_a, "pixel_filter"_a, "filter_width"_a, "exposure"_a,
          "matrix: (4, 4) float64, to the world, looking along -Z; screen: left, right, bottom, top of the frame on z = 1,\n"
          "or in m (orthographic); clip_start, clip_end: m; frame: width, height in pixels; region: x, y, width, height of\n"
          "the part to render; transparent: the world is not seen, nor through glass of at most the roughness\n"
          "transparent_glass (negative: it is); what is less opaque than alpha_threshold has no normal in the film;\n"
          "pixel_filter: 'box', 'gaussian', 'blackman_harris', of filter_width pixels;\n"
          "exposure: factor of all light in the picture. Before build(), set_view(), begin_again() or draw_viewport(), which take it up.")
      .def(
          "set_panorama", &set_panorama, "kind"_a, "longitude"_a, "latitude"_a, "fov"_a,
          "focal_length"_a, "sensor"_a, "polynomial"_a, "cylinder"_a,
          "After set_camera(): the frame is a map of directions. Angles in rad; focal_length and sensor in the same unit.")
      .def(
          "set_aperture",
          [](Renderer& r, float radius, float focus, int blades, float rotation, float ratio) {
            r.camera_settings.aperture = {radius, focus, blades, rotation, ratio};
          },
          "radius"_a, "focus"_a, "blades"_a, "rotation"_a, "ratio"_a,
          "After set_camera(): a lens of that radius, m, sharp at the distance `focus`, m; blades: 0 for a round one.")
      .def(
          "set_stereo",
          [](Renderer& r, float offset, float convergence, float merge_begins, float merge_ends) {
            r.camera_settings.stereo = {offset, convergence, merge_begins, merge_ends};
          },
          "offset"_a, "convergence"_a, "merge_begins"_a, "merge_ends"_a,
          "After set_camera(): every ray begins `offset` m to its right, and meets that of the other eye at the distance `convergence`, m, or nowhere where that is infinite. Angles above the horizon, rad, from which the eyes come together, and from which they are one; 0: they stay apart.");
}

}  // namespace photon_splat
