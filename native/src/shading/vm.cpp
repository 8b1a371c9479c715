#include <cstring>
#include <memory>

#include "shading/frame.h"

namespace photon_splat {
namespace {

using namespace nodes;

// The address of the instruction that follows, for jumps; the others return nullptr.
void execute(Frame& f) {
  const uint32_t* const code = f.program.code.data();
  for (const uint32_t* at = code;;) {
    const Op op = static_cast<Op>(*at);
    const uint32_t* const w = at + 1;
    at += kWords[*at];
    switch (op) {
      case Op::End: return;
      case Op::Jump: at = code + w[0]; break;
      case Op::JumpIfZero:
        if (f.number(w[0]) == 0) at = code + w[1];
        break;
      case Op::JumpIfEqual:
        if (f.number(w[0]) == f.number(w[1])) at = code + w[2];
        break;

      case Op::Copy: f.set(w[0], f.number(w[1])); break;
      case Op::CopyVector: f.set(w[0], f.vector(w[1])); break;
      case Op::Spread: {
        const float x = f.number(w[1]);
        f.set(w[0], Vec3{x, x, x});
        break;
      }
      case Op::Average: f.set(w[0], average(f.vector(w[1]))); break;
      case Op::Luminance: f.set(w[0], luminance(f.vector(w[1]))); break;
      case Op::Add: f.set(w[0], f.number(w[1]) + f.number(w[2])); break;
      case Op::Subtract: f.set(w[0], f.number(w[1]) - f.number(w[2])); break;
      case Op::Multiply: f.set(w[0], f.number(w[1]) * f.number(w[2])); break;
      case Op::MultiplyAdd: f.set(w[0], f.number(w[1]) * f.number(w[2]) + f.number(w[3])); break;
      case Op::OneMinus: f.set(w[0], 1 - f.number(w[1])); break;
      case Op::ClampUnit: f.set(w[0], clamp_unit(f.number(w[1]))); break;
      case Op::AddVector: f.set(w[0], f.vector(w[1]) + f.vector(w[2])); break;
      case Op::SubtractVector: f.set(w[0], f.vector(w[1]) - f.vector(w[2])); break;
      case Op::MultiplyVector: f.set(w[0], f.vector(w[1]) * f.vector(w[2])); break;
      case Op::ScaleVector: f.set(w[0], f.vector(w[1]) * f.number(w[2])); break;
      case Op::ClampUnitVector: f.set(w[0], clamp_unit(f.vector(w[1]))); break;
      case Op::Math: math(f, w); break;
      case Op::VectorMath: vector_math(f, w); break;

      case Op::MixFloat: {
        const float t = f.number(w[1]);
        f.set(w[0], mix(f.number(w[2]), f.number(w[3]), f.on(w[4]) ? clamp_unit(t) : t));
        break;
      }
      case Op::MixVector: {
        const float t = f.number(w[1]);
        f.set(w[0], mix(f.vector(w[2]), f.vector(w[3]), f.on(w[4]) ? clamp_unit(t) : t));
        break;
      }
      case Op::MixVectorNonUniform: {
        Vec3 t = f.vector(w[1]);
        if (f.on(w[4])) t = clamp_unit(t);
        f.set(w[0], f.vector(w[2]) * (Vec3{1, 1, 1} - t) + f.vector(w[3]) * t);
        break;
      }
      case Op::MixColor: mix_color(f, w); break;
      case Op::MapRange: map_range(f, w); break;
      case Op::MapRangeVector: map_range_vector(f, w); break;
      case Op::Clamp: nodes::clamp(f, w); break;
      case Op::ColorRamp: color_ramp(f, w); break;
      case Op::FloatCurve: float_curve(f, w); break;
      case Op::Curves: curves(f, w); break;
      case Op::HueSaturation: hue_saturation(f, w); break;
      case Op::BrightContrast: bright_contrast(f, w); break;
      case Op::Gamma: nodes::gamma(f, w); break;
      case Op::Invert: {
        const float t = f.number(w[1]);
        const Vec3 c = f.vector(w[2]);
        f.set(w[0], (Vec3{1, 1, 1} - c) * t + c * (1 - t));
        break;
      }
      case Op::SeparateColor: separate_color(f, w); break;
      case Op::CombineColor: combine_color(f, w); break;
      case Op::Blackbody: blackbody(f, w); break;
      case Op::Wavelength: wavelength(f, w); break;
      case Op::Fresnel: fresnel(f, w); break;
      case Op::LayerWeight: layer_weight(f, w); break;
      case Op::LightFalloff: light_falloff(f, w); break;
      case Op::VectorTransform: vector_transform(f, w); break;
      case Op::VectorRotate: vector_rotate(f, w); break;
      case Op::Mapping: mapping(f, w); break;
      case Op::TransformPoint: transform_point(f, w); break;

      case Op::Geometry: geometry(f, w); break;
      case Op::Backfacing: f.set(w[0], f.point.back ? 1.0f : 0.0f); break;
      case Op::TextureCoordinate: texture_coordinate(f, w); break;
      case Op::UvMap: uv_map(f, w); break;
      case Op::Attribute: mesh_attribute(f, w); break;
      case Op::GridValue: grid_value(f, w); break;
      case Op::InstanceAttribute: instance_attribute(f, w); break;
      case Op::ObjectLocation: object_location(f, w); break;
      case Op::CurvesInfo: curves_info(f, w); break;
      case Op::PointInfo: point_info(f, w); break;
      case Op::CameraData: camera_data(f, w); break;
      case Op::LightPath: light_path(f, w); break;
      case Op::Wireframe: wireframe(f, w); break;
      case Op::AmbientOcclusion: ambient_occlusion(f, w); break;
      case Op::Bevel: bevel(f, w); break;
      case Op::Raycast: raycast(f, w); break;
      case Op::TangentRadial: tangent_radial(f, w); break;
      case Op::TangentUv: tangent_uv(f, w); break;
      case Op::NormalMap: normal_map(f, w); break;
      case Op::Offset: offset(f, w); break;
      case Op::Bump: bump(f, w); break;
      case Op::VectorDisplacement: vector_displacement(f, w); break;
      case Op::DisplacementBump: displacement_bump(f, w); break;

      case Op::ImageTexture: image_texture(f, w); break;
      case Op::EnvironmentTexture: environment_texture(f, w); break;
      case Op::SunDisc: sun_disc(f, w); break;
      case Op::Together: f.noise.together = w[0]; break;
      case Op::NoiseTexture: noise_texture(f, w); break;
      case Op::VoronoiTexture: voronoi_texture(f, w); break;
      case Op::WaveTexture: wave_texture(f, w); break;
      case Op::MagicTexture: magic_texture(f, w); break;
      case Op::CheckerTexture: checker_texture(f, w); break;
      case Op::BrickTexture: brick_texture(f, w); break;
      case Op::GradientTexture: gradient_texture(f, w); break;
      case Op::WhiteNoiseTexture: white_noise_texture(f, w); break;
      case Op::GaborTexture: gabor_texture(f, w); break;
      case Op::IesTexture: ies_texture(f, w); break;

      case Op::BentNormal: bent_normal(f, w); break;
      case Op::Displace: f.displacement = f.vector(w[1]); break;

      case Op::Emission:
      case Op::Transparent:
      case Op::Holdout:
      case Op::Diffuse:
      case Op::Translucent:
      case Op::Glossy:
      case Op::Glass:
      case Op::Refraction:
      case Op::Metallic:
      case Op::Sheen:
      case Op::Toon:
      case Op::Subsurface:
      case Op::Hair:
      case Op::PrincipledHair:
      case Op::Principled: closure(f, op, w); break;
      case Op::VolumeAbsorption:
      case Op::VolumeScatter:
      case Op::VolumeCoefficients:
      case Op::PrincipledVolume: medium_closure(f, op, w); break;
      case Op::kCount: return;
    }
  }
}

}  // namespace

void run_program(const Scene& scene, const Program& program, const ShadingPoint& point, Bsdf& out) {
  constexpr uint32_t kOnStack = 2048;
  float registers[kOnStack];
  std::unique_ptr<float[]> more;
  float* memory = registers;
  if (program.registers > kOnStack) {
    more = std::make_unique<float[]>(program.registers);
    memory = more.get();
  } else if (program.registers > 0) {
    // Never of no bytes: with AVX-512 that is a masked store, which takes hundreds of cycles where
    // nothing has ever been written
    std::memset(registers, 0, program.registers * sizeof(float));
  }
  NoiseQueue noise;
  Frame frame{scene, program, point, out, memory, program.constants.data(), noise};
  execute(frame);
}

Vec3 run_displacement(const Scene& scene, const Program& program, const ShadingPoint& vertex,
                      std::vector<float>& registers) {
  registers.assign(program.registers, 0);
  Bsdf out(Transport::kRadiance, vertex.ns, vertex.ng, vertex.ns, false);
  NoiseQueue noise;
  Frame frame{scene, program, vertex, out, registers.data(), program.constants.data(), noise};
  execute(frame);
  return frame.displacement;
}

std::vector<float> run_constant_program(const Scene& scene, const Program& program) {
  std::vector<float> registers(program.registers);
  const Vec3 up{0, 0, 1};
  ShadingPoint nowhere;
  nowhere.ng = nowhere.ns = nowhere.wo = up;
  Bsdf out(Transport::kRadiance, up, up, up, false);
  NoiseQueue noise;
  Frame frame{scene, program, nowhere, out, registers.data(), program.constants.data(), noise};
  execute(frame);
  return registers;
}

}  // namespace photon_splat
