#include "scene/panorama.h"

namespace photon_splat {
namespace {

// `angle` from the viewing axis, turned about it as (x, y) is.
Vec3 off_axis(float angle, float x, float y) {
  const float r = std::sqrt(x * x + y * y), sine = r > 0 ? std::sin(angle) / r : 0;
  return {x * sine, y * sine, -std::cos(angle)};
}

// Distance from the centre in mm at which a polynomial lens shows that angle to its axis, by
// Newton's method.
float polynomial_distance(const std::array<float, 5>& k, float angle) {
  float r = std::abs(k[1]) > 0 ? -(angle + k[0]) / k[1] : 1;
  for (int i = 0; i < 16; ++i) {
    const float error = angle + k[0] + r * (k[1] + r * (k[2] + r * (k[3] + r * k[4])));
    const float slope = k[1] + r * (2 * k[2] + r * (3 * k[3] + r * 4 * k[4]));
    if (!(std::abs(slope) > 0)) break;
    r -= error / slope;
  }
  return r;
}

}  // namespace

std::optional<Vec3> panorama_direction(const PanoramaSettings& s, float u, float v) {
  switch (s.kind) {
    case PanoramaKind::kNone: return std::nullopt;
    case PanoramaKind::kEquirectangular: {
      const float longitude = s.longitude_min + (s.longitude_max - s.longitude_min) * u;
      const float latitude = s.latitude_min + (s.latitude_max - s.latitude_min) * v;
      return Vec3{std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                  -std::cos(latitude) * std::cos(longitude)};
    }
    case PanoramaKind::kEquiangularCubeFace: {
      const float limit = kPi / 2 - 1e-4f;  // a filter reaches beyond the face
      const auto edge = [limit](float t) {
        return std::tan(std::clamp((t - 0.5f) * (kPi / 2), -limit, limit));
      };
      return normalize(Vec3{edge(u), edge(v), -1});
    }
    // a small mirrored ball seen from afar along -Z; what it shows lies behind the viewer
    case PanoramaKind::kMirrorBall: {
      const float x = 2 * u - 1, y = 2 * v - 1, r2 = x * x + y * y;
      if (r2 > 1) return std::nullopt;
      const float z = std::sqrt(1 - r2);
      return Vec3{2 * z * x, 2 * z * y, 1 - 2 * z * z};
    }
    case PanoramaKind::kFisheyeEquidistant: {
      const float x = 2 * u - 1, y = 2 * v - 1, r = std::sqrt(x * x + y * y);
      if (r > 1) return std::nullopt;
      return off_axis(r * 0.5f * s.fov, x, y);
    }
    case PanoramaKind::kFisheyeEquisolid: {
      const float x = (u - 0.5f) * s.sensor_width, y = (v - 0.5f) * s.sensor_height,
                  r = std::sqrt(x * x + y * y);
      if (!(r <= 2 * s.focal_length * std::sin(0.25f * s.fov)) || r > 2 * s.focal_length)
        return std::nullopt;
      return off_axis(2 * std::asin(r / (2 * s.focal_length)), x, y);
    }
    case PanoramaKind::kFisheyePolynomial: {
      const float x = (u - 0.5f) * s.sensor_width, y = (v - 0.5f) * s.sensor_height,
                  r = std::sqrt(x * x + y * y);
      const auto& k = s.polynomial;
      const float angle = -(k[0] + r * (k[1] + r * (k[2] + r * (k[3] + r * k[4]))));
      if (!(std::abs(angle) <= 0.5f * s.fov)) return std::nullopt;
      return off_axis(angle, x, y);
    }
    case PanoramaKind::kCentralCylindrical: {
      const float angle = s.u_min + (s.u_max - s.u_min) * u,
                  height = s.v_min + (s.v_max - s.v_min) * v;
      return normalize(Vec3{std::sin(angle), height, -std::cos(angle)});
    }
  }
  return std::nullopt;
}

Vec2 panorama_place(const PanoramaSettings& s, const Vec3& d) {
  const float across = std::sqrt(d.x * d.x + d.y * d.y), angle = std::atan2(across, -d.z);
  const float x = across > 0 ? d.x / across : 0, y = across > 0 ? d.y / across : 0;
  const auto off_centre = [&](float r) {
    return Vec2{0.5f + r * x / s.sensor_width, 0.5f + r * y / s.sensor_height};
  };
  const auto share = [](float value, float low, float high) {
    return (value - low) / (high - low);
  };
  switch (s.kind) {
    case PanoramaKind::kNone: return {};
    case PanoramaKind::kEquirectangular:
      return {share(std::atan2(d.x, -d.z), s.longitude_min, s.longitude_max),
              share(std::asin(std::clamp(d.y, -1.0f, 1.0f)), s.latitude_min, s.latitude_max)};
    case PanoramaKind::kEquiangularCubeFace: {
      const auto edge = [&](float t) { return 0.5f + std::atan2(t, -d.z) / (kPi / 2); };
      return {edge(d.x), edge(d.y)};
    }
    case PanoramaKind::kMirrorBall: {
      const float z = std::sqrt(std::max(0.5f * (1 - d.z), 1e-12f));
      return {0.5f + d.x / (4 * z), 0.5f + d.y / (4 * z)};
    }
    case PanoramaKind::kFisheyeEquidistant: {
      const float r = angle / s.fov;
      return {0.5f + r * x, 0.5f + r * y};
    }
    case PanoramaKind::kFisheyeEquisolid:
      return off_centre(2 * s.focal_length * std::sin(0.5f * angle));
    case PanoramaKind::kFisheyePolynomial:
      return off_centre(polynomial_distance(s.polynomial, angle));
    case PanoramaKind::kCentralCylindrical: {
      const float radius = std::sqrt(d.x * d.x + d.z * d.z);
      return {share(std::atan2(d.x, -d.z), s.u_min, s.u_max),
              share(radius > 0 ? d.y / radius : 0, s.v_min, s.v_max)};
    }
  }
  return {};
}

}  // namespace photon_splat
