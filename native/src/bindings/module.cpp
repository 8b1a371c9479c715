// Python's view of the renderer. Arrays come in and go out as numpy; the GIL is released while
// stages run.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <atomic>

#include "bench/photon_tracer.h"
#include "bindings/bindings.h"
#include "scene/embree_check.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

template <class T, class... Shape>
using Array = nb::ndarray<const T, nb::c_contig, nb::device::cpu, Shape...>;
using Matrix = Array<double, nb::shape<4, 4>>;
using Rgb3 = std::array<float, 3>;

Rgb to_rgb(const Rgb3& c) { return {c[0], c[1], c[2]}; }

std::array<double, 12> to_rows(const double* m) {
  std::array<double, 12> rows;
  std::copy(m, m + 12, rows.begin());
  return rows;
}

Affine relative(const Matrix& matrix, const double origin[3]) {
  auto rows = to_rows(matrix.data());
  for (int i = 0; i < 3; ++i) rows[4 * i + 3] -= origin[i];
  Affine out;
  for (int i = 0; i < 12; ++i) out.m[i] = static_cast<float>(rows[i]);
  return out;
}

// numpy's memory into the first `count` elements of ours, by all threads; visit(element) sees each.
template <class T, class Source, class Visit>
void copy_in_parts(ThreadPool& pool, const Source* from, LargeArray<T>* to, size_t count,
                   Visit&& visit) {
  const T* source = reinterpret_cast<const T*>(from);
  pool.for_parts(count, 1 << 15, CancelFlag{}, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) visit((*to)[i] = source[i]);
  });
}

uint32_t add_mesh(Renderer& r, Array<float, nb::shape<-1, 3>> positions,
                  Array<uint32_t, nb::shape<-1, 3>> triangles,
                  std::optional<Array<float, nb::shape<-1, 3, 3>>> corner_normals,
                  std::optional<Array<float, nb::shape<-1, 3, 2>>> uv,
                  std::optional<Array<uint16_t, nb::shape<-1>>> slots,
                  std::optional<Array<float, nb::shape<-1, 3>>> vertex_normals) {
  const size_t vertices = positions.shape(0), count = triangles.shape(0);
  if (count >= (1u << 30))
    throw std::invalid_argument("a mesh has more triangles than the renderer can hold");
  if ((corner_normals && corner_normals->shape(0) != count) || (uv && uv->shape(0) != count) ||
      (slots && slots->shape(0) != count))
    throw std::invalid_argument("a mesh's corner data does not fit its triangles");
  if (vertex_normals && (corner_normals || vertex_normals->shape(0) != vertices))
    throw std::invalid_argument("a mesh's normals do not fit its vertices");
  Mesh mesh;
  std::atomic<bool> outside{false}, not_finite{false};
  mesh.triangles.resize(count);
  copy_in_parts(r.scene.pool(), triangles.data(), &mesh.triangles, count, [&](const Triangle& t) {
    if (std::max({t[0], t[1], t[2]}) >= vertices) outside.store(true, std::memory_order_relaxed);
  });
  if (outside) throw std::invalid_argument("a mesh's triangle names a vertex that does not exist");
  mesh.positions.resize(vertices + 1);
  mesh.positions.back() = {};  // Embree reads 16 bytes at the last vertex
  copy_in_parts(r.scene.pool(), positions.data(), &mesh.positions, vertices, [&](const Vec3& p) {
    if (!is_finite(p)) not_finite.store(true, std::memory_order_relaxed);
  });
  if (not_finite) throw std::invalid_argument("a mesh has a vertex that is not finite");
  if (corner_normals) {
    mesh.corner_normals.resize(3 * count);
    copy_in_parts(r.scene.pool(), corner_normals->data(), &mesh.corner_normals, 3 * count,
                  [](const Vec3&) {});
  }
  if (vertex_normals) {  // no vertex is named that does not exist
    mesh.corner_normals.resize(3 * count);
    const Vec3* normals = reinterpret_cast<const Vec3*>(vertex_normals->data());
    r.scene.pool().for_parts(count, 1 << 15, CancelFlag{}, [&](size_t begin, size_t end) {
      for (size_t t = begin; t < end; ++t)
        for (size_t i = 0; i < 3; ++i)
          mesh.corner_normals[3 * t + i] = normals[mesh.triangles[t][i]];
    });
  }
  if (uv) {
    mesh.uv.resize(3 * count);
    copy_in_parts(r.scene.pool(), uv->data(), &mesh.uv, 3 * count, [](const Vec2&) {});
  }
  if (slots) mesh.slots.assign(slots->data(), slots->data() + count);
  r.scene.meshes.push_back(std::move(mesh));
  return static_cast<uint32_t>(r.scene.meshes.size() - 1);
}

Interpolation interpolation_named(const std::string& name) {
  return named<Interpolation>(name,
                              {{"linear", Interpolation::kLinear},
                               {"closest", Interpolation::kClosest},
                               {"cubic", Interpolation::kCubic}},
                              "interpolation");
}

Extension extension_named(const std::string& name) {
  return named<Extension>(name,
                          {{"repeat", Extension::kRepeat},
                           {"extend", Extension::kExtend},
                           {"clip", Extension::kClip},
                           {"mirror", Extension::kMirror}},
                          "extension");
}

uint32_t add_texture_reading(Renderer& r, uint32_t of, const std::string& interpolation,
                             const std::string& extension) {
  if (of >= r.scene.textures.size())
    throw std::invalid_argument("a reading names a texture that does not exist");
  r.scene.textures.push_back(
      r.scene.textures[of].reading(interpolation_named(interpolation), extension_named(extension)));
  return static_cast<uint32_t>(r.scene.textures.size() - 1);
}

size_t texture_memory(const Renderer& r) {
  std::vector<const Texture*> kept;
  for (const Texture& t : r.scene.textures) kept.push_back(t.pixels_of ? t.pixels_of.get() : &t);
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  size_t sum = 0;
  for (const Texture* t : kept) sum += t->memory();
  return sum;
}

uint32_t add_texture(
    Renderer& r, nb::ndarray<nb::c_contig, nb::device::cpu, nb::shape<-1, -1, 4>, nb::ro> pixels,
    bool srgb, const std::string& interpolation, const std::string& extension) {
  Texture texture;
  texture.height = static_cast<int>(pixels.shape(0));
  texture.width = static_cast<int>(pixels.shape(1));
  if (texture.width < 1 || texture.height < 1)
    throw std::invalid_argument("a texture has no pixels");
  texture.srgb = srgb;
  texture.interpolation = interpolation_named(interpolation);
  texture.extension = extension_named(extension);
  if (pixels.dtype() == nb::dtype<uint8_t>()) {
    const auto* p = static_cast<const uint8_t*>(pixels.data());
    texture.bytes.assign(p, p + pixels.size());
  } else if (pixels.dtype() == nb::dtype<float>()) {
    const auto* p = static_cast<const float*>(pixels.data());
    texture.floats.assign(p, p + pixels.size());
    for (float& f : texture.floats)
      if (!std::isfinite(f)) f = 0;
  } else {
    throw std::invalid_argument("a texture's pixels are neither uint8 nor float32");
  }
  texture.compact();
  r.scene.textures.push_back(std::move(texture));
  return static_cast<uint32_t>(r.scene.textures.size() - 1);
}

MaterialSide make_side(const Renderer& r, const nb::tuple& t) {
  MaterialSide side;
  side.albedo = to_rgb(nb::cast<Rgb3>(t[0]));
  side.albedo_texture = nb::cast<int>(t[1]);
  side.emission = to_rgb(nb::cast<Rgb3>(t[2]));
  side.emission_texture = nb::cast<int>(t[3]);
  if (!is_finite(side.albedo) || !is_finite(side.emission))
    throw std::invalid_argument("a material has a colour that is not finite");
  side.albedo = max(side.albedo, Vec3{});
  for (int texture : {side.albedo_texture, side.emission_texture})
    if (texture >= static_cast<int>(r.scene.textures.size()))
      throw std::invalid_argument("a material names a texture that does not exist");
  return side;
}

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

void set_camera(Renderer& r, Matrix matrix, std::array<float, 4> screen, bool orthographic,
                float clip_start, float clip_end, std::array<int, 2> frame,
                std::array<int, 4> region, bool transparent, const std::string& filter,
                float filter_width) {
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
  r.camera_settings.panorama = p;
}

nb::dict statistics(Renderer& r) {
  nb::dict seconds, photons, out;
  seconds["acceleration"] = r.seconds().acceleration;
  seconds["camera"] = r.seconds().camera;
  seconds["photons"] = r.seconds().photons;
  seconds["splat"] = r.seconds().splat;
  seconds["boundary"] = r.seconds().boundary;
  seconds["error"] = r.seconds().error;
  uint64_t traced = 0, stored = 0, pilot = 0, reused = 0;
  VisiblePoints::Counts discs_sum;
  for (size_t i = 0; i < r.layer_count(); ++i) {
    const Layer& layer = r.layer(i);
    const PhotonCounts counts = r.photon_counts(layer);
    traced += counts.traced;
    stored += counts.stored;
    pilot += layer.pilot.traced;
    reused += layer.reused;
    nb::dict part;
    part["traced"] = counts.traced;
    part["stored"] = counts.stored;
    part["guided"] = layer.tracer->guided();
    const VisiblePoints::Counts& met = layer.points.counts();
    discs_sum.points += met.points;
    discs_sum.cut += met.cut;
    discs_sum.obstructed += met.obstructed;
    photons[layer.stream == PhotonStream::kCaustic ? "caustic" : "indirect"] = part;
  }
  photons["traced"] = traced;
  photons["stored"] = stored;
  photons["pilot"] = pilot;
  photons["reused"] = reused;
  photons["kept_bytes"] = r.kept_photon_bytes();
  out["seconds"] = seconds;
  out["photons"] = photons;
  out["rays"] = r.rays();
  out["threads"] = r.threads();
  out["threads_wanted"] = r.threads_wanted();
  out["kernel"] = r.kernel_name();
  out["visible_points"] = r.points().size();
  out["bad_samples"] = r.bad_samples();
  const ErrorFigures& figures = r.errors().figures();
  nb::dict error;
  error["relative_rmse"] = figures.relative_rmse;
  error["standard_error"] = figures.standard_error;
  error["bias"] = figures.bias;
  out["error"] = error;
  nb::dict discs;
  discs["points"] = discs_sum.points;
  discs["cut"] = discs_sum.cut;
  discs["obstructed"] = discs_sum.obstructed;
  out["discs"] = discs;
  nb::dict fallback;
  fallback["points"] = r.fallbacks();
  fallback["share"] =
      r.places() ? static_cast<double>(r.fallbacks()) / static_cast<double>(r.places()) : 0.0;
  fallback["everywhere"] = r.paths_bring_all();
  out["fallback"] = fallback;
  return out;
}

// Points of the current pass as plain arrays: a copy, for tests and other splatters.
nb::dict point_arrays(const Renderer& r) {
  const auto& blocks = r.points().blocks();
  const size_t n = r.points().size();
  std::vector<float> position(3 * n), normal(3 * n), radius(n), mass(n), irradiance(3 * n),
      count(n);
  std::vector<uint32_t> key(n);
  for (size_t i = 0; i < n; ++i) {
    const PointBlock& b = blocks[i / kBlockSize];
    const size_t l = i % kBlockSize;
    const float p[3] = {b.x[l], b.y[l], b.z[l]}, d[3] = {b.nx[l], b.ny[l], b.nz[l]},
                e[3] = {b.r[l], b.g[l], b.b[l]};
    for (int c = 0; c < 3; ++c) {
      position[3 * i + c] = p[c];
      normal[3 * i + c] = d[c];
      irradiance[3 * i + c] = e[c] * b.scale[l];
    }
    radius[i] = 1 / std::sqrt(b.inverse_h2[l]);
    mass[i] = 2 * b.inverse_h2[l] / (kPi * b.scale[l]);
    count[i] = b.count[l];
    key[i] = b.key[l];
  }
  nb::dict out;
  out["position"] = to_numpy(std::move(position), {n, 3});
  out["normal"] = to_numpy(std::move(normal), {n, 3});
  out["key"] = to_numpy(std::move(key), {n});
  out["radius"] = to_numpy(std::move(radius), {n});
  out["mass"] = to_numpy(std::move(mass), {n});
  out["irradiance"] = to_numpy(std::move(irradiance), {n, 3});
  out["count"] = to_numpy(std::move(count), {n});
  return out;
}

nb::dict photon_arrays(const Renderer& r) {
  const auto& photons = r.photons();
  const size_t n = photons.size();
  std::vector<float> position(3 * n), normal(3 * n), power(3 * n);
  std::vector<uint32_t> key(n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 direction = decode_direction(photons[i].normal);
    key[i] = photons[i].key;
    for (int c = 0; c < 3; ++c) {
      position[3 * i + c] = photons[i].position[c];
      normal[3 * i + c] = direction[c];
      power[3 * i + c] = photons[i].power[c];
    }
  }
  nb::dict out;
  out["position"] = to_numpy(std::move(position), {n, 3});
  out["normal"] = to_numpy(std::move(normal), {n, 3});
  out["power"] = to_numpy(std::move(power), {n, 3});
  out["key"] = to_numpy(std::move(key), {n});
  return out;
}

}  // namespace
}  // namespace photon_splat

NB_MODULE(photon_splat_native, m) {
  using namespace photon_splat;
  try {
    check_embree_version();
  } catch (const std::exception& e) {
    throw nb::import_error(e.what());
  }
  m.doc() = "Photon tracer and splatter of Photon Splat.";
  nb::exception<Cancelled>(m, "Cancelled");
  const auto released = nb::call_guard<nb::gil_scoped_release>();

  nb::class_<Renderer> renderer(
      m, "Renderer",
      "One render; stages are called in the order pass by pass that renderer.h states.");
  renderer
      .def(
          "__init__",
          [](Renderer* self, int threads) {
            if (threads < 0) throw std::invalid_argument("the number of threads is negative");
            new (self) Renderer(threads);
          },
          "threads"_a)
      .def(
          "set_origin",
          [](Renderer& r, std::array<double, 3> o, float near) {
            std::copy(o.begin(), o.end(), r.scene.origin);
            r.scene.near = near;
          },
          "origin"_a, "near"_a = 0.0f,
          "World position that the renderer's coordinates are relative to; before anything is added. near: "
          "radius of what stands close to it where other things are very far off, else 0.")
      .def_prop_ro(
          "lamps_in_surfaces",
          [](const Renderer& r) {
            std::vector<std::pair<uint32_t, uint32_t>> pairs;
            for (const Lights::InSurface& p : r.lamps_in_surfaces())
              pairs.emplace_back(p.lamp, p.instance);
            return pairs;
          },
          "Area lamps that lie in the plane of a surface, as (number of the lamp, of the instance), in a built scene.")
      .def("add_texture", &add_texture, "pixels"_a, "srgb"_a, "interpolation"_a, "extension"_a)
      .def("add_texture_reading", &add_texture_reading, "of"_a, "interpolation"_a, "extension"_a,
           "The pixels of another texture read in another way; they are kept once.")
      .def_prop_ro("texture_memory", &texture_memory, "Bytes of all textures' pixels.")
      .def(
          "add_material",
          [](Renderer& r, nb::tuple front, nb::tuple back) {
            r.scene.materials.push_back({make_side(r, front), make_side(r, back)});
          },
          "front"_a, "back"_a,
          "Each side: (albedo rgb, albedo texture or -1, emission rgb, emission texture or -1).")
      .def("add_mesh", &add_mesh, "positions"_a, "triangles"_a, "corner_normals"_a.none(),
           "uv"_a.none(), "slots"_a.none(), "vertex_normals"_a = nb::none())
      .def(
          "add_instance",
          [](Renderer& r, uint32_t mesh, Matrix matrix, std::vector<int32_t> materials, int group,
             uint64_t lit_groups, uint64_t blockers, int16_t light_group, RayMask seen_by,
             bool holdout) {
            auto rows = to_rows(matrix.data());
            for (int i = 0; i < 3; ++i) rows[4 * i + 3] -= r.scene.origin[i];
            for (double d : rows)
              if (!std::isfinite(d))
                throw std::invalid_argument("an instance has a matrix that is not finite");
            if (group < 0 || group > 63)
              throw std::invalid_argument("an instance has a group of light linking beyond 0..63");
            r.scene.add_instance(mesh, rows, materials);
            r.scene.instances.back().group = uint64_t{1} << group;
            r.scene.instances.back().lit_groups = lit_groups;
            r.scene.instances.back().blockers = blockers;
            r.scene.instances.back().light_group = light_group;
            r.scene.instances.back().seen_by = seen_by;
            r.scene.instances.back().holdout = holdout;
          },
          "mesh"_a, "matrix"_a, "materials"_a, "group"_a = 0, "lit_groups"_a = ~uint64_t{0},
          "blockers"_a = ~uint64_t{0}, "light_group"_a = kNoLightGroup, "seen_by"_a = kAllRays,
          "holdout"_a = false)
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
      .def("add_lamp", &add_lamp, "kind"_a, "matrix"_a, "strength"_a, "radius"_a, "soft_falloff"_a,
           "spot_size"_a, "spot_blend"_a, "angle"_a, "size"_a, "ellipse"_a, "spread"_a,
           "normalize"_a, "camera_visible"_a, "program"_a = -1, "lit_groups"_a = ~uint64_t{0},
           "blockers"_a = ~uint64_t{0}, "light_group"_a = kNoLightGroup, "seen_by"_a = kAllRays,
           "max_bounces"_a = ~uint32_t{0}, "met_by_rays"_a = true, "casts_shadows"_a = true)
      .def("set_camera", &set_camera, "matrix"_a, "screen"_a, "orthographic"_a, "clip_start"_a,
           "clip_end"_a, "frame"_a, "region"_a, "transparent"_a, "pixel_filter"_a, "filter_width"_a)
      .def("set_panorama", &set_panorama, "kind"_a, "longitude"_a, "latitude"_a, "fov"_a,
           "focal_length"_a, "sensor"_a, "polynomial"_a, "cylinder"_a,
           "After set_camera: the frame is a map of directions.")
      .def(
          "set_aperture",
          [](Renderer& r, float radius, float focus, int blades, float rotation, float ratio) {
            r.camera_settings.aperture = {radius, focus, blades, rotation, ratio};
          },
          "radius"_a, "focus"_a, "blades"_a, "rotation"_a, "ratio"_a,
          "After set_camera: a lens of finite size.")
      .def(
          "set_options",
          [](Renderer& r, uint64_t photons_per_pass, int max_bounces, float radius_scale,
             float point_spacing, bool boundary_correction, bool caustics, uint32_t seed,
             const std::string& kernel, bool adaptive_radius, bool occlusion, bool adaptive_samples,
             bool fallback, bool force_caustics, bool final_gather, bool gather_trial) {
            r.options = {photons_per_pass,    max_bounces, radius_scale,   point_spacing,
                         boundary_correction, caustics,    force_caustics, adaptive_radius,
                         adaptive_samples,    occlusion,   fallback,       final_gather,
                         gather_trial,        seed,        kernel};
          },
          "photons_per_pass"_a, "max_bounces"_a, "radius_scale"_a, "point_spacing"_a,
          "boundary_correction"_a, "caustics"_a, "seed"_a, "kernel"_a = "",
          "adaptive_radius"_a = true, "occlusion"_a = true, "adaptive_samples"_a = true,
          "fallback"_a = true, "force_caustics"_a = false, "final_gather"_a = false,
          "gather_trial"_a = false)
      .def("build", &Renderer::build, released)
      .def_prop_ro("layers", &Renderer::layer_count,
                   "Kinds of photons: indirect light, and caustics where something can make them.")
      .def("select_layer", &Renderer::select_layer, "layer"_a,
           "The one that points, photons and splats are about from now on; 0 at first.")
      .def_prop_ro(
          "next_pass",
          [](Renderer& r) {
            const Renderer::PassSize size = r.next_pass();
            return std::pair(size.samples, size.photons);
          },
          "Of the next pass: camera samples in each pixel on average; photons over those of the first pass, by their work.")
      .def(
          "limit_pass",
          [](Renderer& r, double samples, double photons) { r.limit_pass({samples, photons}); },
          "samples"_a, "photons"_a,
          "Less in the passes to come than next_pass says: at most so much, but one camera sample in each pixel at the least.",
          released)
      .def_prop_ro(
          "camera_seconds", [](Renderer& r) { return r.seconds().camera; },
          "Of the stages' seconds: those that camera samples took.")
      .def_prop_ro(
          "photon_seconds", [](Renderer& r) { return r.seconds().photons + r.seconds().splat; },
          "Likewise: photons.")
      .def_prop_ro(
          "pilot_seconds", [](Renderer& r) { return r.seconds().pilot; },
          "Of the stages' seconds: in the first pass only.")
      .def_prop_ro(
          "paths_per_batch", &Renderer::paths_per_batch,
          "Photon paths that are best traced and splatted at once onto the points there are.")
      .def_prop_ro(
          "keeps_photons", [](const Renderer& r) { return r.options.kept_photon_bytes > 0; },
          "Whether batches are found again by other renders, and so are all of paths_per_batch.")
      .def_prop_ro("film_bytes", &Renderer::film_bytes,
                   "Memory of the film and of the pass that is being made.")
      .def_prop_ro("paths_per_pass", &Renderer::paths_per_pass,
                   "Photon paths of a pass in the selected layer.")
      .def("trace_camera", &Renderer::trace_camera, "pass"_a, released)
      .def("make_points", &Renderer::make_points, "pass"_a, released)
      .def("trace_photons", &Renderer::trace_photons, "first"_a, "count"_a, released)
      .def("splat", &Renderer::splat, released)
      .def(
          "end_photons", &Renderer::end_photons, "paths"_a,
          "Before resolve(), and after any splatter: no more of the selected layer's paths come in this pass; those count for all.")
      .def("end_passes", &Renderer::end_passes,
           "No pass follows: gives back memory that passes alone need.")
      .def("resolve", &Renderer::resolve, released)
      .def("trace_reference", &Renderer::trace_reference, "sample"_a, released)
      .def("cancel", &Renderer::cancel,
           "Makes the running stage, and every later one, raise Cancelled. From any thread.")
      .def("make_error_estimate", &Renderer::make_error_estimate,
           "Brings film()['error'] and statistics()['error'] up to date.", released)
      .def(
          "squared_errors",
          [](const Renderer& r) {
            const size_t width = static_cast<size_t>(r.packed_film().width),
                         height = static_cast<size_t>(r.packed_film().height);
            nb::dict out;
            out["variance"] = to_numpy(std::vector<float>(r.errors().variance()), {height, width});
            out["squared_bias"] =
                to_numpy(std::vector<float>(r.errors().squared_bias()), {height, width});
            return out;
          },
          "Parts of the squared error of each pixel by the last estimate, luminance squared, (H, W).")
      .def("statistics", &statistics)
      .def("points", &point_arrays)
      .def("photons", &photon_arrays)
      .def(
          "bench_photon_tracer",
          [](Renderer& r, uint64_t paths) {
            TracerBench result;
            {
              nb::gil_scoped_release release;
              result = bench_photon_tracer(r, paths);
            }
            nb::dict out;
            out["rays"] = result.rays;
            out["tracer_seconds"] = result.tracer_seconds;
            nb::dict embree;
            embree["intersect1"] = result.intersect1_seconds;
            embree["intersect8"] = result.intersect8_seconds;
            embree["intersect16"] = result.intersect16_seconds;
            out["embree_seconds"] = embree;
            return out;
          },
          "paths"_a, "Traces photon paths, then replays their rays by Embree alone.");
  bind_shading(m, renderer);
  bind_world(m, renderer);
  bind_film(renderer);
  bind_splatting(renderer);
  bind_viewport(renderer);
}
