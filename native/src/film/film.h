// Sums over camera samples, per pixel of the rendered region; not all pixels get as many. Row 0 is
// the bottom row.
#pragma once

#include <vector>

#include "film/lobe_category.h"
#include "math/vec.h"
#include "util/large_pages.h"

namespace photon_splat {

struct Pixel {
  // Light by the lobe that sent it to the camera; its colour included.
  Rgb diffuse_direct, diffuse_indirect, glossy_direct, glossy_indirect, transmission_direct,
      transmission_indirect, volume_direct, volume_indirect;
  Rgb diffuse_color, glossy_color, transmission_color;  // what lobes of a kind reflect, about
  Rgb emission, environment, normal;
  Rgb ambient_occlusion;  // what is open of the hemisphere above what is seen, if it is wanted
  // For a denoiser, of the first surface that is no mirror and no clear glass: see
  // CameraTracer::show_features(). Albedo is of all lobes: what diffuse_color calls black may be
  // copper
  Rgb albedo, feature_normal;
  // Light of shadow catchers, which none of the above holds: among all things, and as if there were
  // nothing but catchers; the world behind them
  Rgb caught, caught_alone, backdrop;
  float alpha = 0, photon_density = 0;
  float caught_alpha = 0;           // of catchers, beside `alpha`
  float samples = 0;                // camera samples in the sums
  float detail = 0;                 // luminance that discs of half the area would take away
  float depth = 0, surface_id = 0;  // of the first sample

  // What the sums are to be multiplied by for means.
  float share() const { return samples > 0 ? 1 / samples : 0; }
  // All of the light.
  Rgb combined() const {
    return diffuse_direct + diffuse_indirect + glossy_direct + glossy_indirect +
           transmission_direct + transmission_indirect + emission + environment + volume_direct +
           volume_indirect;
  }
};

inline Rgb& direct_of(Pixel& pixel, LobeCategory category) {
  return category == LobeCategory::kDiffuse  ? pixel.diffuse_direct
         : category == LobeCategory::kGlossy ? pixel.glossy_direct
         : category == LobeCategory::kVolume ? pixel.volume_direct
                                             : pixel.transmission_direct;
}
inline Rgb& indirect_of(Pixel& pixel, LobeCategory category) {
  return category == LobeCategory::kDiffuse  ? pixel.diffuse_indirect
         : category == LobeCategory::kGlossy ? pixel.glossy_indirect
         : category == LobeCategory::kVolume ? pixel.volume_indirect
                                             : pixel.transmission_indirect;
}

inline constexpr float kBackgroundDepth = 1e10f;

struct Film {
  int width = 0, height = 0;
  uint32_t passes = 0;  // in it so far
  LargeArray<Pixel> pixels;
  int light_groups = 0;
  LargeArray<Rgb> by_group;  // of each pixel its light by group, sums like those of the pixel

  // Pixels are then to be written before they are read; of a sum of no passes there need not be
  // any.
  void reset(int new_width, int new_height, int groups = 0) {
    width = new_width;
    height = new_height;
    passes = 0;
    light_groups = groups;
    pixels.clear();
    pixels.resize(static_cast<size_t>(width) * height);
    by_group.clear();
    by_group.resize(pixels.size() * groups);
  }
  // The light of one pixel by group; nullptr where light is not kept by group.
  Rgb* groups_of(size_t pixel) { return light_groups ? &by_group[pixel * light_groups] : nullptr; }
};

}  // namespace photon_splat
