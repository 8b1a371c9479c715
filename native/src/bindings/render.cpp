// Options, passes, and the stages of a pass one by one.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bench/photon_tracer.h"
#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

// An object of Python's with begin_pass(), add_photons() and finish_pass().
class PythonSplatter final : public ExternalSplatter {
 public:
  explicit PythonSplatter(nb::object object) : object_(std::move(object)) {}
  ~PythonSplatter() override {
    nb::gil_scoped_acquire gil;
    object_.reset();
  }
  bool begin_pass() override { return ask("begin_pass"); }
  bool add_photons() override { return ask("add_photons"); }
  bool finish_pass() override { return ask("finish_pass"); }

 private:
  bool ask(const char* what) {
    nb::gil_scoped_acquire gil;
    return nb::cast<bool>(object_.attr(what)());
  }
  nb::object object_;
};

void render_pass(Renderer& r, uint32_t pass, double seconds, uint64_t paths_per_batch,
                 nb::object splatter) {
  std::optional<PythonSplatter> elsewhere;
  if (!splatter.is_none()) elsewhere.emplace(std::move(splatter));
  nb::gil_scoped_release release;
  r.render_pass(pass, {seconds, paths_per_batch}, elsewhere ? &*elsewhere : nullptr);
}

std::pair<double, double> learn_in_common(Renderer& r, double seconds, nb::object splatter) {
  std::optional<PythonSplatter> elsewhere;
  if (!splatter.is_none()) elsewhere.emplace(std::move(splatter));
  nb::gil_scoped_release release;
  const Renderer::PassSize of_one = r.learn_in_common(seconds, elsewhere ? &*elsewhere : nullptr);
  return {of_one.samples, of_one.photons};
}

nb::dict bench(Renderer& r, uint64_t paths) {
  TracerBench result;
  {
    nb::gil_scoped_release release;
    result = bench_photon_tracer(r, paths);
  }
  nb::dict out, embree;
  out["rays"] = result.rays;
  out["embree_rays"] = result.embree_rays;
  out["tracer_seconds"] = result.tracer_seconds;
  embree["intersect1"] = result.intersect1_seconds;
  embree["intersect8"] = result.intersect8_seconds;
  embree["intersect16"] = result.intersect16_seconds;
  out["embree_seconds"] = embree;
  return out;
}

void bind_options(nb::module_& m) {
  nb::enum_<IndirectLight>(
      m, "IndirectLight",
      "What brings indirect light. OR_PATHS: where a trial in the first pass finds that less work,\n"
      "camera paths bring all of it, caustics excepted.")
      .value("PHOTONS", IndirectLight::kPhotons, "Photons light what camera paths meet first.")
      .value("PHOTONS_OR_PATHS", IndirectLight::kPhotonsOrPaths, "The same, or camera paths.")
      .value("ANY", IndirectLight::kAny,
             "Photons or camera paths, and final gathering where few photons arrive.")
      .value("FINAL_GATHER", IndirectLight::kFinalGather,
             "Photons light what camera paths meet after one more bounce.")
      .value("FINAL_GATHER_OR_PATHS", IndirectLight::kFinalGatherOrPaths,
             "The same, or camera paths.");
  nb::class_<RenderPart>(
      m, "RenderPart", "One of the renders whose sums make a picture together; the whole at first.")
      .def(nb::init<>(), "The whole.")
      .def_rw("number", &RenderPart::number, "From 1 on; more than there are is one more.")
      .def_rw("count", &RenderPart::count, "Discs shrink with the paths of so many parts together.")
      .def_rw("generation", &RenderPart::generation, "How often the part has been interrupted.")
      .def_rw("passes_before", &RenderPart::passes_before, "Of the generations before.")
      .def_rw("paths_before", &RenderPart::paths_before,
              "Likewise: photon paths of each photon map.");
  nb::class_<RenderOptions>(m, "RenderOptions",
                            "What a render is asked for: to be set before build().")
      .def(nb::init<>(), "The defaults.")
      .def_rw("photons_per_pass", &RenderOptions::photons_per_pass,
              "Photon paths of a first pass in each photon map; 0: direct light only.")
      .def_rw("max_bounces", &RenderOptions::max_bounces,
              "Surface bounces between light and camera.")
      .def_rw("radius_scale", &RenderOptions::radius_scale, "On all kernel radii.")
      .def_rw("point_spacing", &RenderOptions::point_spacing,
              "Of visible points, in kernel radii; 0: one for each gather point.")
      .def_rw("boundary_correction", &RenderOptions::boundary_correction,
              "Whether irradiance is divided by the kernel's mass on its patch.")
      .def_rw("caustics", &RenderOptions::caustics,
              "A photon map of their own for caustics, where the scene can make them.")
      .def_rw("adaptive_radius", &RenderOptions::adaptive_radius,
              "Radii of pixels by what discs of two sizes have shown.")
      .def_rw("adaptive_samples", &RenderOptions::adaptive_samples,
              "Camera samples and photons by what passes have shown.")
      .def_rw("occlusion", &RenderOptions::occlusion,
              "Things and walls inside of discs; part of boundary_correction.")
      .def_rw("adaptive_indirect", &RenderOptions::adaptive_indirect,
              "Camera paths go on for indirect light where photons serve badly.")
      .def_rw("indirect_light", &RenderOptions::indirect_light, "What brings it: IndirectLight.")
      .def_rw("short_passes", &RenderOptions::short_passes,
              "One camera sample per pixel where there would be more, for a viewport.")
      .def_rw("ambient_distance", &RenderOptions::ambient_distance,
              "How far the Ambient Occlusion pass looks, m; 0: there is none.")
      .def_rw("seed", &RenderOptions::seed, "Of all random numbers, 32 bits.")
      .def_rw("part", &RenderOptions::part, "RenderPart: of renders that make a picture together.")
      .def_rw("kernel", &RenderOptions::kernel,
              "Of the splatter: 'generic', 'sse42', 'avx2', 'avx512'; '': the fastest.")
      .def_rw(
          "kept_photon_bytes", &RenderOptions::kept_photon_bytes,
          "Not 0: every render has the same photons whatever the view, and so many bytes of them are kept for the next.")
      .def_rw("fixed_radius", &RenderOptions::fixed_radius,
              "Of all discs, m; 0: chosen. For comparisons.");
}

}  // namespace

void bind_render(nb::module_& m, RendererClass& renderer) {
  bind_options(m);
  const auto released = nb::call_guard<nb::gil_scoped_release>();
  renderer
      .def(
          "__init__",
          [](Renderer* self, int threads) {
            if (threads < 0) throw std::invalid_argument("the number of threads is negative");
            new (self) Renderer(threads);
          },
          "threads"_a, "threads: 0 for all of the machine. ValueError if it is negative.")
      .def_rw("options", &Renderer::options, "RenderOptions; to be set before build().")
      .def(
          "build", &Renderer::build, released,
          "Acceleration structure, lights, photon maps, an empty film. After everything has been added. ValueError for a\n"
          "light group that does not exist or a kernel that this machine does not run.")
      .def(
          "render_pass", &render_pass, "number"_a, "seconds"_a = INFINITY, "paths_per_batch"_a = 0,
          "splatter"_a = nb::none(),
          "The pass `number`, from 0 on: camera samples, photons, film. Where `seconds` do not suffice it has fewer\n"
          "photons, one batch at the least. paths_per_batch: of photons, 0 for as many as suit the points. splatter: an\n"
          "object whose begin_pass(), add_photons() and finish_pass() splat elsewhere what this holds (photon_count,\n"
          "photon_runs(), point_atlas(), set_sums()); False from one of them: it cannot go on, and its photons are\n"
          "splatted here. Raises what it raises, and Cancelled.")
      .def(
          "learn_in_common", &learn_in_common, "seconds"_a = INFINITY, "splatter"_a = nb::none(),
          "Before the first pass of a part of a picture, which else begins with it: passes that only teach what all\n"
          "parts have in common, smaller ones where `seconds` do not suffice, but with a sample of each pixel. Returns\n"
          "the seconds of such a sample of all pixels, and of a first pass' photons; zeros where nothing was to be done.\n"
          "splatter: as render_pass(). Raises what it raises.")
      .def(
          "trace_reference", &Renderer::trace_reference, "sample"_a, released,
          "One sample per pixel of the path tracer that needs no photons, instead of a pass. Raises Cancelled.")
      .def("end_passes", &Renderer::end_passes,
           "No pass follows: gives back memory that passes alone need.")
      .def_prop_ro(
          "next_pass",
          [](Renderer& r) {
            const Renderer::PassSize size = r.next_pass();
            return std::pair(size.samples, size.photons);
          },
          "Of the next pass: camera samples in each pixel on average; photons over those of the first pass, by their work.")
      .def_prop_ro(
          "samples_of_last_pass", &Renderer::samples_of_last_pass,
          "Camera samples in each pixel of the last pass on average: more than next_pass said where a first\n"
          "pass has tried what paths can do.")
      .def(
          "limit_pass",
          [](Renderer& r, double samples, double photons) { r.limit_pass({samples, photons}); },
          "samples"_a, "photons"_a,
          "Less in the passes to come than next_pass says: at most so much, but one camera sample in each pixel at the least.",
          released)
      .def("cancel", &Renderer::cancel,
           "Makes the running stage, and every later one, raise Cancelled. From any thread.")
      .def("resume", &Renderer::resume, "Takes cancel() back; only while no stage runs.")
      .def("make_error_estimate", &Renderer::make_error_estimate, released,
           "Brings film()['error'] and statistics()['error'] up to date.");
  // The stages of a pass, in this order; those between trace_camera() and resolve() for each map.
  renderer
      .def(
          "trace_camera", nb::overload_cast<uint32_t>(&Renderer::trace_camera), "number"_a,
          released,
          "Stage 1: camera samples with their direct light, and gather points where photons are wanted.")
      .def_prop_ro(
          "photon_maps", &Renderer::map_count,
          "How many: one of indirect light, and one of caustics where something can make them.")
      .def(
          "select_photon_map", &Renderer::select_map, "number"_a,
          "The one that points, photons and splats are about from now on; 0 at first. IndexError for another one.")
      .def(
          "place_points", &Renderer::place_points, "number"_a, released,
          "Stage 2: visible points for the gather points, with their radii and kernel masses; sums are 0. The first time\n"
          "a pilot is traced that chooses radii. RuntimeError before trace_camera().")
      .def_prop_ro(
          "paths_per_pass", &Renderer::paths_per_pass,
          "Photon paths of a pass in the selected map; 0 where camera paths bring all of its light.")
      .def_prop_ro(
          "paths_per_batch", &Renderer::paths_per_batch,
          "Photon paths that are best traced and splatted at once onto the points there are.")
      .def(
          "trace_photons",
          [](Renderer& r, uint64_t first, uint64_t count) { r.map().trace(first, count); },
          "first"_a, "count"_a, released,
          "Stage 3: a batch, the photon paths [first, first + count) of the pass. Kept until the next batch.")
      .def(
          "splat", [](Renderer& r) { r.map().splat(); }, released,
          "Stage 4: adds the batch to the points.")
      .def("resolve", &Renderer::resolve, released,
           "Stage 5: adds the pass to the film. RuntimeError before trace_camera().")
      .def(
          "bench_photon_tracer", &bench, "paths"_a,
          "Traces photon paths in a built scene, then by Embree alone a ray from each photon back to where it came from.\n"
          "Returns rays, tracer_seconds, embree_rays, and embree_seconds by packet size.");
}

}  // namespace photon_splat
