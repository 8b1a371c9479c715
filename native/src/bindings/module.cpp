// Python's view of the renderer. Arrays come in and go out as numpy; the GIL is released while
// stages run.
#include "bindings/bindings.h"
#include "scene/embree_check.h"

NB_MODULE(photon_splat_native, m) {
  using namespace photon_splat;
  namespace nb = nanobind;
  try {
    check_embree_version();
  } catch (const std::exception& e) {
    throw nb::import_error(e.what());
  }
  m.doc() = "Photon tracer and splatter of Photon Splat.";
  m.attr("__version__") = PHOTON_SPLAT_VERSION;
  nb::exception<Cancelled>(m, "Cancelled");
  RendererClass renderer(
      m, "Renderer",
      "One render: it is filled (set_origin() first, then textures, programs, materials, meshes, instances, lamps, camera,\n"
      "options), built, and asked for passes by render_pass(); film() tells what they made. Indices count from 0 in the\n"
      "order of adding. Stages raise Cancelled after cancel(), and may run for minutes with the GIL released.");
  bind_geometry(m, renderer);
  bind_strands(renderer);
  bind_grids(renderer);
  bind_instances(renderer);
  bind_lights(m, renderer);
  bind_camera(renderer);
  bind_motion(renderer);
  bind_shading(m, renderer);
  bind_render(m, renderer);
  bind_statistics(renderer);
  bind_film(renderer);
  bind_sums(m, renderer);
  bind_data_passes(renderer);
  bind_splatting(renderer);
  bind_viewport(renderer);
  bind_dicing(m);
}
