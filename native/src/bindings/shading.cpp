#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include "bindings/bindings.h"
#include "bsdf/bsdf.h"
#include "shading/ops.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace photon_splat {
namespace {

// {name: (opcode, [(kind, operand, (mode, ...)), ...])}, see shading/ops.def.
nb::dict operation_table() {
  nb::dict table;
  uint32_t opcode = 0;
  for (const nodes::Operation& operation : nodes::operations()) {
    nb::list operands;
    for (const nodes::Operand& operand : operation.operands) {
      nb::list modes;
      for (const std::string& mode : operand.modes) modes.append(mode.c_str());
      operands.append(nb::make_tuple(operand.kind.c_str(), operand.name.c_str(), nb::tuple(modes)));
    }
    table[operation.name.c_str()] = nb::make_tuple(opcode++, operands);
  }
  return table;
}

uint32_t add_program(Renderer& r, const std::string& name, Array<uint32_t, nb::shape<-1>> code,
                     Array<float, nb::shape<-1>> constants, uint32_t registers, uint32_t features) {
  Program program;
  program.name = name;
  program.code.assign(code.data(), code.data() + code.size());
  program.constants.assign(constants.data(), constants.data() + constants.size());
  program.registers = registers;
  program.features = features;
  check_program(r.scene, program);
  look_at_program(program);
  r.scene.programs.push_back(std::move(program));
  return static_cast<uint32_t>(r.scene.programs.size() - 1);
}

auto run_constants(const Renderer& r, Array<uint32_t, nb::shape<-1>> code,
                   Array<float, nb::shape<-1>> constants, uint32_t registers) {
  Program program;
  program.name = "constants";
  program.code.assign(code.data(), code.data() + code.size());
  program.constants.assign(constants.data(), constants.data() + constants.size());
  program.registers = registers;
  check_program(r.scene, program);
  std::vector<float> result = run_constant_program(r.scene, program);
  const size_t size = result.size();
  return to_numpy(std::move(result), {size});
}

int require_program(const Renderer& r, uint32_t program) {
  if (program >= r.scene.programs.size())
    throw std::invalid_argument("a shader program does not exist");
  return static_cast<int>(program);
}

// Sets the volume program of the material added last.
void set_volume(Renderer& r, uint32_t program) {
  if (r.scene.materials.empty())
    throw std::invalid_argument("a volume belongs to a material that does not exist");
  r.scene.materials.back().volume = require_program(r, program);
}

uint32_t add_program_material(Renderer& r, uint32_t program) {
  Material material;
  material.program = require_program(r, program);
  r.scene.materials.push_back(material);
  return static_cast<uint32_t>(r.scene.materials.size() - 1);
}

Mesh& require_mesh(Renderer& r, uint32_t mesh) {
  if (mesh >= r.scene.meshes.size())
    throw std::invalid_argument("an attribute belongs to a mesh that does not exist");
  return r.scene.meshes[mesh];
}

void add_mesh_attribute(
    Renderer& r, uint32_t mesh_index, uint32_t id, const std::string& domain,
    nb::ndarray<nb::c_contig, nb::device::cpu, nb::shape<-1, -1>, nb::ro> values) {
  Mesh& mesh = require_mesh(r, mesh_index);
  MeshAttribute attribute;
  attribute.id = id;
  size_t elements = mesh.triangles.size();
  if (domain == "point") {
    attribute.domain = MeshAttribute::Domain::kPoint;
    elements = mesh.positions.size() - 1;
  } else if (domain == "corner") {
    attribute.domain = MeshAttribute::Domain::kCorner;
    elements *= 3;
  } else if (domain == "face") {
    attribute.domain = MeshAttribute::Domain::kFace;
  } else {
    throw std::invalid_argument("unknown attribute domain '" + domain + "'");
  }
  if (mesh.strands) {
    if (attribute.domain == MeshAttribute::Domain::kCorner)
      throw std::invalid_argument("strands have no corners");
    elements = attribute.domain == MeshAttribute::Domain::kPoint ? mesh.strands->key_count()
                                                                 : mesh.strands->count();
  }
  if (values.shape(0) != elements || values.shape(1) < 1 || values.shape(1) > 4)
    throw std::invalid_argument("an attribute does not fit its mesh");
  attribute.components = static_cast<uint32_t>(values.shape(1));
  if (values.dtype() == nb::dtype<uint8_t>() && attribute.components == 4) {
    const auto* p = static_cast<const uint8_t*>(values.data());
    attribute.bytes.assign(p, p + values.size());
  } else if (values.dtype() == nb::dtype<float>()) {
    attribute.floats = lent_or_copied<float>(values);
    const auto bad = [](float f) { return !std::isfinite(f); };
    if (std::any_of(attribute.floats.begin(), attribute.floats.end(), bad)) {
      LargeArray<float>& own = attribute.floats.own();
      std::replace_if(own.begin(), own.end(), bad, 0.0f);
    }
  } else {
    throw std::invalid_argument("an attribute is neither float32 nor four uint8");
  }
  if (mesh.attribute(id)) throw std::invalid_argument("a mesh has two attributes of one id");
  mesh.attributes.push_back(std::move(attribute));
}

void set_generated(Renderer& r, uint32_t mesh, std::array<float, 3> scale,
                   std::array<float, 3> offset) {
  require_mesh(r, mesh).generated = {{scale[0], scale[1], scale[2]},
                                     {offset[0], offset[1], offset[2]}};
}

void add_instance_attribute(Renderer& r, uint32_t id, Array<float, nb::shape<-1, -1>> values) {
  if (values.shape(0) != r.scene.instances.size() || values.shape(1) < 1 || values.shape(1) > 4)
    throw std::invalid_argument("an instance attribute has not one row per instance");
  InstanceAttribute attribute{
      id, static_cast<uint32_t>(values.shape(1)), {values.data(), values.data() + values.size()}};
  for (float& f : attribute.values)
    if (!std::isfinite(f)) f = 0;
  r.scene.instance_attributes.push_back(std::move(attribute));
}

void set_shading_view(Renderer& r, Array<double, nb::shape<4, 4>> matrix,
                      std::array<float, 4> screen, bool orthographic) {
  ShadingView& view = r.scene.view;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      double value = matrix.data()[4 * row + column];
      if (column == 3) value -= r.scene.origin[row];
      if (column == 2) value = -value;  // Blender's cameras look along -Z
      view.camera_to_world.m[4 * row + column] = static_cast<float>(value);
    }
  view.world_to_camera = inverse(view.camera_to_world);
  view.left = screen[0];
  view.right = screen[1];
  view.bottom = screen[2];
  view.top = screen[3];
  view.orthographic = orthographic;
  view.panorama = {};
}

// Runs the programs of the surfaces that rays meet first. For tests.
nb::dict shade_rays(Renderer& r, Array<float, nb::shape<-1, 3>> origins,
                    Array<float, nb::shape<-1, 3>> directions, float footprint, bool cone,
                    const std::string& kind) {
  const size_t n = origins.shape(0);
  if (directions.shape(0) != n) throw std::invalid_argument("not as many directions as origins");
  if (!r.scene.embree()) throw std::invalid_argument("the scene is not built");
  std::vector<float> values[4];
  for (auto& v : values) v.assign(3 * n, 0);
  std::vector<uint8_t> hit(n, 0);
  RayInfo info;
  info.through = kind == "transmission";
  info.kind = kind == "shadow"         ? RayInfo::kShadow
              : kind == "diffuse"      ? RayInfo::kDiffuse
              : kind == "glossy"       ? RayInfo::kGlossy
              : kind == "transmission" ? RayInfo::kTransmission
                                       : RayInfo::kCamera;
  {
    nb::gil_scoped_release release;
    const auto* o = reinterpret_cast<const Vec3*>(origins.data());
    const auto* d = reinterpret_cast<const Vec3*>(directions.data());
    for (size_t i = 0; i < n; ++i) {
      Surface s;
      const Vec3 direction = normalize(d[i]);
      ShadingPoint point;
      const Program* program = nullptr;
      if (r.scene.intersect(o[i], direction, 0, INFINITY, false, s)) {
        hit[i] = 1;
        const Material& material = r.scene.material_of(s.instance, s.triangle);
        if (material.program < 0) continue;
        program = &r.scene.programs[material.program];
        point = {s.position, s.ng,       s.ns, -direction, s.back,
                 s.instance, s.triangle, s.u,  s.v,        info};
        point.ray.length = s.distance;
        point.ray.footprint = cone ? footprint * s.distance : footprint;
      } else if (r.scene.world_program >= 0) {
        program = &r.scene.programs[r.scene.world_program];
        point = {direction, -direction, -direction, -direction, false, ShadingPoint::kNoInstance,
                 0,         0,          0,          info};
        point.ray.length = std::numeric_limits<float>::max();
        ++point.ray.depth;
      } else {
        continue;
      }
      Bsdf bsdf(Transport::kRadiance, point.wo, point.ng, point.ns, point.back);
      run_program(r.scene, *program, point, bsdf);
      bsdf.finish();
      const Rgb results[4] = {bsdf.emission(), bsdf.transparency(), bsdf.gather(), bsdf.albedo()};
      for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) values[k][3 * i + c] = results[k][c];
    }
  }
  nb::dict out;
  const char* names[4] = {"emission", "transparency", "gather", "albedo"};
  for (int k = 0; k < 4; ++k) out[names[k]] = to_numpy(std::move(values[k]), {n, 3});
  out["hit"] = to_numpy(std::move(hit), {n});
  return out;
}

}  // namespace

void bind_shading(nb::module_& m, RendererClass& renderer) {
  m.def(
      "shader_operations", &operation_table,
      "{name: (opcode, [(kind, operand, modes), ...])} of every instruction of shader programs, in the order of its words.");
  renderer
      .def(
          "add_program", &add_program, "name"_a, "code"_a, "constants"_a, "registers"_a,
          "features"_a,
          "A shader program; returns its index. Textures it names come first. ValueError for one that is not sound.")
      .def("run_constant_program", &run_constants, "code"_a, "constants"_a, "registers"_a,
           "(registers,) float32 that a program leaves which asks for nothing of a hit.")
      .def("add_program_material", &add_program_material, "program"_a,
           "A material that runs a program. Returns its index.")
      .def("set_volume", &set_volume, "program"_a,
           "The program of the medium behind surfaces of the material added last.")
      .def(
          "set_world_volume",
          [](Renderer& r, uint32_t program) { r.scene.world_volume = require_program(r, program); },
          "program"_a, "The program of a medium that is everywhere; after add_program().")
      .def(
          "set_world_program",
          [](Renderer& r, uint32_t program) {
            r.scene.world_program = require_program(r, program);
          },
          "program"_a, "The program that tells the world's radiance; after add_program().")
      .def(
          "add_mesh_attribute", &add_mesh_attribute, "mesh"_a, "attribute"_a, "domain"_a,
          "values"_a,
          "(N, 1..4) float32, or (N, 4) uint8 of an sRGB-encoded colour, per 'point', 'corner' (3 T rows) or 'face' (T rows).")
      .def("set_generated", &set_generated, "mesh"_a, "scale"_a, "offset"_a,
           "Generated coordinates of a mesh: its own coordinates times scale plus offset.")
      .def("add_instance_attribute", &add_instance_attribute, "attribute"_a, "values"_a,
           "(I, 1..4) float32, a row per instance added so far.")
      .def("set_shading_view", &set_shading_view, "matrix"_a, "screen"_a, "orthographic"_a,
           "The camera that shader nodes refer to, as in set_camera().")
      .def(
          "shade_rays", &shade_rays, "origins"_a, "directions"_a, "footprint"_a = 0.0f,
          "cone"_a = false, "kind"_a = "camera",
          "Runs the program at the first hit of each ray (relative to the origin) of a built scene, or the world's program.\n"
          "`footprint`: a pixel's width, m, or with `cone` per m of distance. Returns (N, 3) emission, transparency, gather, albedo; (N,) hit.");
}

}  // namespace photon_splat
