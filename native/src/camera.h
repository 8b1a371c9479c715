// Perspective and orthographic cameras, and the pixel filter.
#pragma once

#include "sampling.h"

#include <vector>

namespace photon_splat {

enum class FilterKind { kBox, kGaussian, kBlackmanHarris };

struct CameraSettings {
  Affine to_world;                       // rigid; looks along -Z
  float left = -1, right = 1, bottom = -1, top = 1;  // of the frame on z = -1 (perspective) or in metres
  bool orthographic = false;
  float clip_start = 0, clip_end = INFINITY;
  int width = 1, height = 1;             // whole frame, pixels
  int x0 = 0, y0 = 0, region_width = 1, region_height = 1;  // what is rendered of it, origin bottom left
  bool transparent = false;
  FilterKind filter = FilterKind::kBlackmanHarris;
  float filter_width = 1.5f;             // pixels
};

struct CameraRay {
  Vec3 origin, direction;
  float near, far;
  float cosine;      // between the ray and the viewing axis: depth = cosine * distance
  float footprint;   // width of a pixel at distance 1 (perspective) or everywhere (orthographic), m
};

class Camera {
 public:
  explicit Camera(const CameraSettings& settings);

  // A ray through pixel (x, y) of the region, its place in the pixel drawn from the filter's density.
  CameraRay ray(int x, int y, const Vec2& u) const;
  float footprint_at(const CameraRay& ray, float distance) const {
    return s_.orthographic ? ray.footprint : ray.footprint * distance;
  }
  const CameraSettings& settings() const { return s_; }

 private:
  float filter_offset(float u) const;

  CameraSettings s_;
  Vec3 right_, up_, back_, position_;
  std::vector<float> filter_quantiles_;  // offset in pixels at equal steps of probability
};

}  // namespace photon_splat
