#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include "bindings/bindings.h"
#include "lights/sky/sky.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

using Rgb3 = std::array<float, 3>;
using Matrix = nb::ndarray<const double, nb::c_contig, nb::device::cpu, nb::shape<4, 4>>;

Rgb to_rgb(const Rgb3& c) { return {c[0], c[1], c[2]}; }

// Takes map and suns away, too.
void set_world(Renderer& r, Rgb3 radiance, RayMask seen_by) {
  if (!is_finite(to_rgb(radiance)))
    throw std::invalid_argument("the world has a colour that is not finite");
  r.scene.world = max(to_rgb(radiance), Vec3{});
  r.scene.world_map = {};
  r.scene.sun_discs.clear();
  r.scene.world_seen_by = seen_by;
}

void set_world_map(Renderer& r, int texture, bool mirror_ball, Matrix to_lookup) {
  if (texture < 0 || texture >= static_cast<int>(r.scene.textures.size()))
    throw std::invalid_argument("the world names a texture that does not exist");
  WorldMap map;
  map.texture = texture;
  map.mirror_ball = mirror_ball;
  for (int i = 0; i < 12; ++i) map.to_lookup.m[i] = static_cast<float>(to_lookup.data()[i]);
  for (float f : map.to_lookup.m)
    if (!std::isfinite(f)) throw std::invalid_argument("the world's mapping is not finite");
  r.scene.world_map = map;
}

void add_sun_disc(Renderer& r, Rgb3 direction, float half_angle, Rgb3 bottom, Rgb3 top,
                  float horizon) {
  const SunDisc sun{to_rgb(direction), half_angle, to_rgb(bottom), to_rgb(top), horizon};
  if (!is_finite(sun.direction) || !(length2(sun.direction) > 0) || !std::isfinite(half_angle) ||
      !is_finite(sun.bottom) || !is_finite(sun.top))
    throw std::invalid_argument("the sky's sun has a setting that is not finite");
  r.scene.sun_discs.push_back(sun);
}

nb::tuple make_sky(const std::string& model, float sun_elevation, float altitude, float air,
                   float aerosol, float ozone, float turbidity, float angular_diameter, int width,
                   int height) {
  SkySettings s;
  s.model = named<SkyModel>(model,
                            {{"single_scattering", SkyModel::kSingleScattering},
                             {"preetham", SkyModel::kPreetham},
                             {"multiple_scattering", SkyModel::kMultipleScattering}},
                            "sky model");
  s.sun_elevation = sun_elevation;
  s.altitude = altitude;
  s.air = air, s.aerosol = aerosol, s.ozone = ozone;
  s.turbidity = turbidity;
  for (float f : {sun_elevation, altitude, air, aerosol, ozone, turbidity, angular_diameter})
    if (!std::isfinite(f)) throw std::invalid_argument("the sky has a setting that is not finite");
  if (width < 2 || height < 2) throw std::invalid_argument("the sky's image has no pixels");
  Texture image;
  {
    nb::gil_scoped_release release;
    ThreadPool pool(0);
    image = sky_image(s, width, height, pool);
  }
  const SkySun sun = sky_sun(s, angular_diameter);
  const auto triple = [](const Rgb& c) { return nb::make_tuple(c.x, c.y, c.z); };
  return nb::make_tuple(to_numpy(std::move(image.floats), {size_t(height), size_t(width), 4}),
                        triple(sun.bottom), triple(sun.top), sun.horizon);
}

}  // namespace

void bind_world(nb::module_& m, nb::class_<Renderer>& renderer) {
  renderer.def("set_world", &set_world, "radiance"_a, "seen_by"_a = kAllRays)
      .def("set_world_map", &set_world_map, "texture"_a, "mirror_ball"_a, "to_lookup"_a,
           "An image of the world; set_world() gives its factor.")
      .def("add_sun_disc", &add_sun_disc, "direction"_a, "half_angle"_a, "bottom"_a, "top"_a,
           "horizon"_a);
  m.def(
      "sky", &make_sky, "model"_a, "sun_elevation"_a, "altitude"_a, "air"_a, "aerosol"_a, "ozone"_a,
      "turbidity"_a, "angular_diameter"_a, "width"_a, "height"_a,
      "(image (height, width, 4) float32, sun's lower edge, upper edge, elevation of the horizon); see sky.h.");
}

}  // namespace photon_splat
