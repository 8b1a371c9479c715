#include "bsdf/turned_glass.h"

namespace photon_splat {
namespace {

constexpr int kAngles = 8;       // between the surface's normal and the one given, tried first
constexpr int kHalvings = 20;    // of what lies between two of them
constexpr float kNudge = 1e-3f;  // of a viewer's direction, for derivatives
constexpr float kSameAngle = 1e-5f;
constexpr float kOpposite = 1 - 1e-6f;  // cosine

class Glass {
 public:
  Glass(const View& view, const Vec3& n, const Vec3& light, float ior)
      : view_(view), n_(n), light_(light), ior_(ior) {
    const Vec3 across = n - view.ng * dot(n, view.ng);
    const float sine = length(across);
    if (sine > 1e-6f) axis_ = across / sine, most_ = std::atan2(sine, dot(n, view.ng));
  }

  // A normal by which the light goes to a viewer who sees that very normal: the one given, or one
  // between two of which the first sends it to viewers whose normal leans further, the second to
  // others.
  std::optional<TurnedWay> way() const {
    const auto given = excess(most_);
    if (given && *given > -kSameAngle) return by_one_normal(most_);
    float angle = 0;
    std::optional<float> before = excess(0);
    for (int i = 1; i <= kAngles; ++i) {
      const float next = most_ * static_cast<float>(i) / kAngles;
      const std::optional<float> here = excess(next);
      float low = angle, high = next;
      if (before && !here) high = end_of_light(angle, next);
      if (!before && here) low = end_of_light(next, angle);
      if ((before || here) && excess(low).value_or(0) > 0 && excess(high).value_or(0) < 0)
        return by_turning_normals(root(low, high));
      angle = next;
      before = here;
    }
    return {};
  }

 private:
  Vec3 normal(float angle) const { return view_.ng * std::cos(angle) + axis_ * std::sin(angle); }

  // The viewer to whom a normal at that angle from the surface's sends the light.
  std::optional<Vec3> viewer(float angle) const {
    const Vec3 n = normal(angle);
    Vec3 to;
    if (!(dot(light_, n) < 0) || !refract(light_, -n, 1 / ior_, &to)) return {};
    if (!(dot(to, view_.ng) > 0) || !(dot(to, n) > 0)) return {};
    return normalize(to);
  }

  Vec3 turned(const Vec3& viewer) const {
    View view = view_;
    view.wo = viewer;
    return valid_reflection(view, n_);
  }

  // By how much the normal which that viewer sees leans further; nothing where it is black.
  std::optional<float> excess(float angle) const {
    const auto to = viewer(angle);
    if (!to) return {};
    const Vec3 seen = turned(*to);
    if (!(dot(seen, *to) > 0)) return {};
    return std::atan2(dot(seen, axis_), dot(seen, view_.ng)) - angle;
  }

  // The last angle that sends light to a viewer, between one that does and one that does not.
  float end_of_light(float lit, float dark) const {
    for (int i = 0; i < kHalvings; ++i) {
      const float middle = 0.5f * (lit + dark);
      (excess(middle) ? lit : dark) = middle;
    }
    return lit;
  }

  float root(float above, float below) const {
    for (int i = 0; i < kHalvings; ++i) {
      const float middle = 0.5f * (above + below);
      (excess(middle).value_or(0) > 0 ? above : below) = middle;
    }
    return above;
  }

  // denser: solid angle that the viewers see over that which the light comes from
  std::optional<TurnedWay> way_to(const Vec3& to, float denser) const {
    return TurnedWay{to, denser * dot(to, view_.ng) / std::max(-dot(light_, view_.ng), 1e-6f)};
  }

  std::optional<TurnedWay> by_one_normal(float angle) const {
    const auto to = viewer(angle);
    if (!to) return {};
    const Vec3 n = normal(angle);
    return way_to(*to, sqr(ior_) * -dot(n, light_) / dot(n, *to));
  }

  std::optional<TurnedWay> by_turning_normals(float angle) const {
    const auto to = viewer(angle);
    if (!to) return {};
    const Basis at_viewer(*to), at_light(light_);
    float slope[2][2];
    for (int i = 0; i < 2; ++i) {
      const Vec3 nudge = (i ? at_viewer.bitangent : at_viewer.tangent) * kNudge;
      Vec3 sees[2];
      for (int k = 0; k < 2; ++k) {
        const Vec3 viewer = normalize(k ? *to + nudge : *to - nudge);
        if (!refract(viewer, turned(viewer), ior_, &sees[k])) return {};
      }
      const Vec3 change = (sees[1] - sees[0]) / (2 * kNudge);
      slope[i][0] = dot(change, at_light.tangent);
      slope[i][1] = dot(change, at_light.bitangent);
    }
    const float area = std::abs(slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0]);
    if (!(area > 0)) return {};
    return way_to(*to, 1 / area);
  }

  View view_;
  Vec3 n_, light_, axis_{};
  float ior_, most_ = 0;
};

}  // namespace

std::optional<TurnedWay> way_through(const View& view, const Vec3& n, const Vec3& light,
                                     float ior) {
  if (!(dot(light, view.ng) < 0) || !(dot(n, view.ng) > -kOpposite)) return {};
  return Glass(view, n, light, ior).way();
}

}  // namespace photon_splat
