// Closures of media, with coefficients as Blender's nodes mean them (1/m at a density of 1).
#include "media/medium.h"
#include "textures/volume_grid.h"

#include "shading/frame.h"

namespace photon_splat::nodes {
namespace {

constexpr float kMost = 1e8f;  // 1/m

float positive(float x) { return x > 0 ? std::min(x, kMost) : 0; }
Rgb positive(const Rgb& c) { return {positive(c.x), positive(c.y), positive(c.z)}; }

void scatter(MediumPoint& out, const Rgb& coefficient, PhaseFunction function, float g, float alpha,
             float diameter) {
  switch (function) {
    case PhaseFunction::HENYEY_GREENSTEIN:
      return out.add_scattering(coefficient, {PhaseKind::kHenyeyGreenstein, g, 0});
    case PhaseFunction::DRAINE:
      return out.add_scattering(coefficient, {PhaseKind::kDraine, g, alpha});
    case PhaseFunction::RAYLEIGH:
      return out.add_scattering(coefficient, {PhaseKind::kRayleigh, 0, 0});
    case PhaseFunction::FOURNIER_FORAND:
      return out.add_scattering(coefficient, {PhaseKind::kFournierForand, g, alpha});
    case PhaseFunction::MIE: {
      const MieFit fit = fit_mie(diameter);
      out.add_scattering(coefficient * (1 - fit.second_share), fit.first);
      return out.add_scattering(coefficient * fit.second_share, fit.second);
    }
  }
}

const VolumeGrid* grid_of(const Frame& f, uint32_t id) {
  if (!f.is_on_mesh() || !f.point.medium) return nullptr;
  for (const MeshGrid& own : f.mesh().grids)
    if (own.id == id) return own.grid.get();
  return nullptr;
}

}  // namespace

void grid_value(Frame& f, const uint32_t* w) {
  const VolumeGrid* const grid = grid_of(f, w[4]);
  if (!grid) {
    const Vec3 absent = f.vector(w[3]);
    f.set(w[0], absent);
    f.set(w[1], absent.x);
    f.set(w[2], 1.0f);
    return;
  }
  static_assert(static_cast<int>(GridInterpolation::VOXEL) ==
                static_cast<int>(photon_splat::GridInterpolation::kVoxel));
  const VolumeGrid::Value v =
      grid->at(f.object_position(), f.mode<photon_splat::GridInterpolation>(w[5]));
  const uint32_t components = grid->components();
  Vec3 color = components == 1 ? Vec3{v[0], v[0], v[0]} : Vec3{v[0], v[1], v[2]};
  f.set(w[1], components == 1 ? v[0] : average(color));
  // Colours with an alpha are multiplied by it
  const float alpha = components == 4 ? v[3] : 1.0f;
  if (alpha > 1e-6f && alpha != 1) color = color / alpha;
  f.set(w[0], color);
  f.set(w[2], alpha);
}

void medium_closure(Frame& f, Op op, const uint32_t* w) {
  const float weight = positive(f.number(w[0]));
  if (weight == 0 || !f.point.medium) return;
  MediumPoint& out = *f.point.medium;
  const Rgb one{1, 1, 1};
  switch (op) {
    case Op::VolumeAbsorption:
      out.absorption +=
          positive(one - f.vector(w[1])) * positive(weight * positive(f.number(w[2])));
      break;
    case Op::VolumeScatter:
      scatter(out, positive(positive(f.vector(w[1])) * (weight * positive(f.number(w[2])))),
              f.mode<PhaseFunction>(w[6]), f.number(w[3]), f.number(w[4]), f.number(w[5]));
      break;
    case Op::VolumeCoefficients:
      out.absorption += positive(f.vector(w[1])) * weight;
      scatter(out, positive(f.vector(w[2])) * weight, f.mode<PhaseFunction>(w[7]), f.number(w[4]),
              f.number(w[5]), f.number(w[6]));
      out.emission += positive(f.vector(w[3])) * weight;
      break;
    case Op::PrincipledVolume: {
      const float density = positive(weight * positive(f.number(w[2])));
      const Rgb color = clamp_unit(positive(f.vector(w[1]))), absorbed = positive(f.vector(w[4]));
      const Rgb root{std::sqrt(absorbed.x), std::sqrt(absorbed.y), std::sqrt(absorbed.z)};
      out.add_scattering(color * density, {PhaseKind::kHenyeyGreenstein, f.number(w[3]), 0});
      out.absorption += positive(one - color) * positive(one - root) * density;
      break;
    }
    default: break;
  }
}

}  // namespace photon_splat::nodes
