// Closures of media, with coefficients as Blender's nodes mean them (1/m at a density of 1).
#include "media/medium.h"

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
    case PhaseFunction::MIE: {
      const MieFit fit = fit_mie(diameter);
      out.add_scattering(coefficient * (1 - fit.second_share), fit.first);
      return out.add_scattering(coefficient * fit.second_share, fit.second);
    }
  }
}

}  // namespace

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
