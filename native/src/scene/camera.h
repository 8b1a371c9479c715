// Perspective, orthographic and panoramic cameras with a lens of finite size, and the pixel filter.
#pragma once

#include "geometry/motion.h"
#include "scene/panorama.h"

#include <optional>
#include <vector>

namespace photon_splat {

enum class FilterKind { kBox, kGaussian, kBlackmanHarris };

// A thin lens: what lies at the distance of focus is sharp.
struct ApertureSettings {
  float radius = 0;    // m; 0: a pinhole, all is sharp
  float focus = 1;     // m, along the viewing axis (panoramas: along the ray)
  int blades = 0;      // 3 and more: a polygon inscribed in the circle
  float rotation = 0;  // of its blades, radians
  float ratio = 1;     // of height to width
};

// One eye of two, for pictures all around: every ray has an eye of its own, to its side.
struct StereoSettings {
  float offset = 0;              // m, to the right; 0: there is one eye
  float convergence = INFINITY;  // m, where both eyes' rays meet
  // Angles to the horizontal plane: eyes come together between them; 0: they never do
  float merge_begins = 0, merge_ends = 0;
};

struct CameraSettings {
  Affine to_world;  // rigid; looks along -Z; at the shutter's centre
  // The camera's matrix at steps of the shutter's opening; none: it stays where it is
  std::vector<Affine> motion;
  // Factor on left .. top when the shutter opens and when it closes, over that at its centre;
  // linear between
  float zoom_before = 1, zoom_after = 1;
  // Edges of the frame on z = -1 (perspective) or in metres
  float left = -1, right = 1, bottom = -1, top = 1;
  bool orthographic = false;
  // Where its kind is not kNone: left .. top are in (u, v) of its map of directions
  PanoramaSettings panorama;
  ApertureSettings aperture;
  StereoSettings stereo;
  float clip_start = 0, clip_end = INFINITY;
  int width = 1, height = 1;  // whole frame, pixels
  // What is rendered of it, origin bottom left
  int x0 = 0, y0 = 0, region_width = 1, region_height = 1;
  bool transparent = false;  // the camera does not see the world
  // nor through glass up to that roughness; negative: it does
  float transparent_glass = -1;
  float alpha_threshold = 0.5f;  // what is less opaque has no normal in the picture of normals
  float exposure = 1;            // of light in the picture
  FilterKind filter = FilterKind::kBlackmanHarris;
  float filter_width = 1.5f;  // pixels
};

struct CameraRay {
  Vec3 origin, direction;
  float near, far;
  float cosine;  // depth = cosine * distance; 1 for panoramas, whose depth is the distance
  // Width of a pixel at distance 1 (perspective, panorama) or everywhere (orthographic), m: the
  // mean of what a step to the next column and one to the next row make, as in Cycles
  float footprint;
};

class Camera {
 public:
  explicit Camera(const CameraSettings& settings);

  // A ray through pixel (x, y) of the region, its place in the pixel drawn from the filter's
  // density (u), its place on the lens from the aperture (lens). nullopt outside a panorama's image
  // circle.
  std::optional<CameraRay> ray(int x, int y, const Vec2& u, const Vec2& lens,
                               float time = kShutterCentre) const;
  // Width of a camera sample at a point, in view or not, m; and of one that comes there by way of
  // another surface, so far from it or as far as the camera is.
  float footprint_from(const Vec3& x) const { return footprint_by_way(x, 0); }
  float footprint_by_way(const Vec3& x, float way) const {
    if (s_.orthographic) return step_;
    const float straight = length(x - axes_.position);
    return step_ * (straight + std::min(way, straight));
  }
  float footprint_at(const CameraRay& ray, float distance) const {
    return s_.orthographic ? ray.footprint : ray.footprint * distance;
  }
  const CameraSettings& settings() const { return s_; }

 private:
  struct Axes {
    Vec3 right, up, back, position;
    explicit Axes(const Affine& m)
        : right(m.column(0)),
          up(m.column(1)),
          back(m.column(2)),
          position{m.m[3], m.m[7], m.m[11]} {}
    Vec3 to_world(const Vec3& v) const { return right * v.x + up * v.y + back * v.z; }
  };
  Axes axes_at(float time) const { return motion_ ? Axes(motion_->at(time)) : axes_; }
  float filter_offset(float u) const;
  Vec2 on_aperture(const Vec2& u) const;
  void to_eye(const Vec3& up, Vec3& origin, Vec3& direction) const;
  std::optional<CameraRay> panoramic(float u, float v, const Vec2& step, const Vec2& lens,
                                     const Axes& axes) const;

  CameraSettings s_;
  Axes axes_;
  std::optional<TransformMotion> motion_;
  float step_ = 0;                       // footprint of a ray in the middle
  std::vector<float> filter_quantiles_;  // offset in pixels at equal steps of probability
};

}  // namespace photon_splat
