// Lamps, light groups and what lies beyond the scene.
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings/bindings.h"
#include "lights/sky/sky.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

void add_lamp(Renderer& r, const std::string& kind, Matrix matrix, Rgb3 strength, float radius,
              bool soft_falloff, float spot_size, float spot_blend, float angle,
              std::array<float, 2> size, bool ellipse, float spread, bool normalize,
              bool camera_visible, int program, uint64_t lit_groups, uint64_t blockers,
              int16_t light_group, RayMask seen_by, uint32_t max_bounces, bool met_by_rays,
              bool casts_shadows) {
  LampSettings s;
  s.kind = named<LampKind>(kind,
                           {{"point", LampKind::kPoint},
                            {"spot", LampKind::kSpot},
                            {"sun", LampKind::kSun},
                            {"area", LampKind::kArea}},
                           "lamp kind");
  s.to_world = relative(matrix, r.scene.origin);
  s.strength = to_rgb(strength);
  s.radius = radius;
  s.soft_falloff = soft_falloff;
  s.spot_size = spot_size;
  s.spot_blend = spot_blend;
  s.angle = angle;
  s.size_x = size[0];
  s.size_y = size[1];
  s.ellipse = ellipse;
  s.spread = spread;
  s.normalize = normalize;
  s.camera_visible = camera_visible;
  s.program = program;
  if (program < -1 || program >= static_cast<int>(r.scene.programs.size()))
    throw std::invalid_argument("a lamp names a program that does not exist");
  s.lit_groups = lit_groups;
  s.blockers = blockers;
  s.light_group = light_group;
  s.seen_by = seen_by;
  s.max_bounces = max_bounces;
  s.met_by_rays = met_by_rays;
  s.casts_shadows = casts_shadows;
  bool finite = is_finite(s.strength);
  for (float f : s.to_world.m) finite &= std::isfinite(f);
  for (float f : {radius, spot_size, spot_blend, angle, size[0], size[1], spread})
    finite &= std::isfinite(f);
  if (!finite) throw std::invalid_argument("a lamp has a setting that is not finite");
  r.lamps.push_back(s);
}

// Takes map and suns away, too.
void set_world(Renderer& r, Rgb3 radiance, RayMask seen_by) {
  if (!is_finite(to_rgb(radiance)))
    throw std::invalid_argument("the world has a colour that is not finite");
  r.scene.world = max(to_rgb(radiance), Vec3{});
  r.scene.world_map = {};
  r.scene.sun_discs.clear();
  r.scene.world_seen_by = light_rays(seen_by, true);
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
                   float aerosol, float ozone, float turbidity, float ground_albedo,
                   float angular_diameter, int width, int height) {
  SkySettings s;
  s.model = named<SkyModel>(model,
                            {{"single_scattering", SkyModel::kSingleScattering},
                             {"preetham", SkyModel::kPreetham},
                             {"hosek_wilkie", SkyModel::kHosekWilkie},
                             {"multiple_scattering", SkyModel::kMultipleScattering}},
                            "sky model");
  s.sun_elevation = sun_elevation;
  s.altitude = altitude;
  s.air = air, s.aerosol = aerosol, s.ozone = ozone;
  s.turbidity = turbidity;
  s.ground_albedo = ground_albedo;
  for (float f :
       {sun_elevation, altitude, air, aerosol, ozone, turbidity, ground_albedo, angular_diameter})
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

std::vector<std::tuple<int32_t, uint32_t, uint32_t>> lights_in_surfaces(const Renderer& r) {
  std::vector<std::tuple<int32_t, uint32_t, uint32_t>> found;
  for (const Lights::InSurface& p : r.lights_in_surfaces())
    found.emplace_back(p.lamp, p.emissive, p.instance);
  return found;
}

}  // namespace

void bind_lights(nb::module_& m, RendererClass& renderer) {
  renderer
      .def(
          "add_lamp", &add_lamp, "kind"_a, "matrix"_a, "strength"_a, "radius"_a, "soft_falloff"_a,
          "spot_size"_a, "spot_blend"_a, "angle"_a, "size"_a, "ellipse"_a, "spread"_a,
          "normalize"_a, "camera_visible"_a, "program"_a = -1, "lit_groups"_a = ~uint64_t{0},
          "blockers"_a = ~uint64_t{0}, "light_group"_a = kNoLightGroup, "seen_by"_a = kAllRays,
          "max_bounces"_a = ~uint32_t{0}, "met_by_rays"_a = true, "casts_shadows"_a = true,
          "kind: 'point', 'spot', 'sun' or 'area'; matrix: (4, 4) float64, to the world, light shines along -Z.\n"
          "strength: rgb, W (a sun's W/m^2); radius, m, of point and spot; spot_size, angle, spread: whole angles, rad;\n"
          "size: m, of an area lamp; program: a factor of strength, or -1. max_bounces: of a path before it finds the\n"
          "lamp; met_by_rays: not by light samples alone. Linking and groups: see add_instance(). ValueError for what is\n"
          "not finite or another kind.")
      .def_prop_ro(
          "lights_in_surfaces", &lights_in_surfaces,
          "Area lamps and emissive meshes that lie in the plane of a surface, in a built scene, as (number of the lamp or\n"
          "-1, emissive instance where it is none, instance of the surface).")
      .def(
          "set_light_groups",
          [](Renderer& r, int count, int16_t world) {
            if (count < 0 || count > 10000)
              throw std::invalid_argument("there are more than 10000 light groups");
            r.scene.light_groups = count;
            r.scene.world_light_group = world;
          },
          "count"_a, "world"_a,
          "How many, and that of the world; -1: none. film() then has the light of each.")
      .def(
          "set_world", &set_world, "radiance"_a, "seen_by"_a = kAllRays,
          "rgb, W/m^2/sr, from all directions; takes map and suns away. seen_by: bits of the kinds of rays that see it.")
      .def(
          "set_world_map", &set_world_map, "texture"_a, "mirror_ball"_a, "to_lookup"_a,
          "An image of the world, equirectangular or of a mirror ball; set_world() gives its factor. to_lookup: (4, 4)\n"
          "float64, from world directions to those of the image.")
      .def(
          "add_sun_disc", &add_sun_disc, "direction"_a, "half_angle"_a, "bottom"_a, "top"_a,
          "horizon"_a,
          "The sun of a sky: unit direction to it, half its angle, rad, radiance at its lower and upper edge, rgb in\n"
          "W/m^2/sr, and the elevation of the horizon, rad. After set_world().");
  m.def(
      "sky", &make_sky, "model"_a, "sun_elevation"_a, "altitude"_a, "air"_a, "aerosol"_a, "ozone"_a,
      "turbidity"_a, "ground_albedo"_a, "angular_diameter"_a, "width"_a, "height"_a,
      "Blender's Sky Texture. model: 'single_scattering', 'multiple_scattering', 'preetham', 'hosek_wilkie'; angles in rad, altitude in m.\n"
      "Returns (image (height, width, 4) float32, sun's lower edge rgb, upper edge rgb, elevation of the horizon).");
}

}  // namespace photon_splat
