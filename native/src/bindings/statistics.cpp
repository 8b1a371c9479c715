#include <nanobind/stl/string.h>

#include "bindings/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

nb::dict seconds_of(const StageSeconds& s) {
  nb::dict out;
  out["acceleration"] = s.acceleration;
  out["camera"] = s.camera;
  out["photons"] = s.photons;
  out["splat"] = s.splat;
  out["boundary"] = s.boundary;
  out["error"] = s.error;
  return out;
}

nb::dict photons_of(const RenderStatistics& s) {
  nb::dict out;
  uint64_t traced = 0, stored = 0, pilot = 0, reused = 0;
  for (const PhotonMapStatistics& map : s.maps) {
    traced += map.photons.traced;
    stored += map.photons.stored;
    pilot += map.pilot.traced;
    reused += map.reused;
    nb::dict part;
    part["traced"] = map.photons.traced;
    part["stored"] = map.photons.stored;
    part["guided"] = map.guided;
    out[map.stream == PhotonStream::kCaustic ? "caustic" : "indirect"] = part;
  }
  nb::dict beams;
  beams["traced"] = s.beams.traced;
  beams["stored"] = s.beams.stored;
  out["beams"] = beams;
  out["traced"] = traced;
  out["stored"] = stored;
  out["pilot"] = pilot;
  out["reused"] = reused;
  out["kept_bytes"] = s.kept_photon_bytes;
  return out;
}

nb::dict discs_of(const RenderStatistics& s) {
  VisiblePoints::Counts sum;
  for (const PhotonMapStatistics& map : s.maps) {
    sum.points += map.discs.points;
    sum.measured += map.discs.measured;
    sum.cut += map.discs.cut;
    sum.obstructed += map.discs.obstructed;
  }
  nb::dict out;
  out["points"] = sum.points;
  out["measured"] = sum.measured;
  out["cut"] = sum.cut;
  out["obstructed"] = sum.obstructed;
  return out;
}

nb::dict statistics(Renderer& r) {
  const RenderStatistics s = r.statistics();
  nb::dict out, error, path_traced;
  out["seconds"] = seconds_of(s.seconds);
  out["photons"] = photons_of(s);
  out["rays"] = s.rays;
  out["threads"] = s.threads;
  out["threads_wanted"] = s.threads_wanted;
  out["kernel"] = s.kernel;
  out["visible_points"] = s.visible_points;
  out["bad_samples"] = s.bad_samples;
  error["relative_rmse"] = s.error.relative_rmse;
  error["standard_error"] = s.error.standard_error;
  error["bias"] = s.error.bias;
  out["error"] = error;
  out["discs"] = discs_of(s);
  path_traced["points"] = s.path_traced;
  path_traced["share"] =
      s.places ? static_cast<double>(s.path_traced) / static_cast<double>(s.places) : 0.0;
  path_traced["everywhere"] = s.all_path_traced;
  path_traced["gathers_after_all"] = s.gathers_after_all;
  path_traced["world"] = s.world_path_traced;
  out["path_traced"] = path_traced;
  return out;
}

nb::dict squared_errors(const Renderer& r) {
  const PackedFilm& film = r.film().sum();
  const size_t width = static_cast<size_t>(film.width), height = static_cast<size_t>(film.height);
  const ErrorEstimate& errors = r.film().errors();
  nb::dict out;
  out["variance"] = to_numpy(std::vector<float>(errors.variance()), {height, width});
  out["squared_bias"] = to_numpy(std::vector<float>(errors.squared_bias()), {height, width});
  return out;
}

}  // namespace

void bind_statistics(RendererClass& renderer) {
  renderer
      .def(
          "statistics", &statistics,
          "Of this render, as nested dicts: seconds by stage; photons traced, stored, of the pilot, reused, and by photon\n"
          "map; rays; threads; kernel of the splatter; visible_points of the last pass; bad_samples, 0 unless something is\n"
          "wrong; error of the last estimate, relative to the mean luminance; discs that edges cut or things stand in;\n"
          "path_traced: places where camera paths went on for indirect light.")
      .def(
          "squared_errors", &squared_errors,
          "Parts of the squared error of each pixel by the last estimate, luminance squared: 'variance' and\n"
          "'squared_bias', (height, width) float32, row 0 at the bottom.")
      .def_prop_ro(
          "camera_seconds", [](const Renderer& r) { return r.seconds().camera; },
          "Of the stages' seconds: those that camera samples took.")
      .def_prop_ro(
          "photon_seconds", [](const Renderer& r) { return r.seconds().with_photons(); },
          "Likewise: photons.")
      .def_prop_ro(
          "pilot_seconds", [](const Renderer& r) { return r.seconds().pilot; },
          "Of the stages' seconds: in the first pass only.")
      .def_prop_ro(
          "film_bytes", [](const Renderer& r) { return r.film().bytes(); },
          "Memory of the film and of the pass that is being made.");
}

}  // namespace photon_splat
