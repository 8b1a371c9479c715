// Whether photon beams are to bring indirect light into media, or camera paths find it.
#include "integrators/camera_path.h"

namespace photon_splat {
namespace {

constexpr uint64_t kPixels = 2048;
constexpr uint32_t kSamples = 8;  // of each
constexpr size_t kPixelsAtOnce = 64;
constexpr double kDark = 1e-2;  // of the picture's mean squared light: darker pixels count for less

}  // namespace

// share: that of the variance of camera paths, relative to what pixels show, that is of light which
// beams of indirect light would bring in place of paths; 0 to 1, or more where the rest happens to
// make up for it. Light of gather points is left out. Pixels of the whole picture are tried with
// random numbers of their own: one in `each`, but not too many.
CameraTracer::MediaTrial CameraTracer::try_media(uint32_t seed, int max_bounces, uint64_t each,
                                                 const CancelFlag& cancel) {
  const CameraSettings& c = camera_.settings();
  const uint64_t width = static_cast<uint64_t>(c.region_width),
                 all_pixels = width * static_cast<uint64_t>(c.region_height),
                 count = std::clamp<uint64_t>(all_pixels / each, 1, kPixels);
  struct Seen {
    double light = 0, variance = 0, shallow_variance = 0;
  };
  std::vector<Seen> seen(count);
  scene_.pool().for_parts(count, kPixelsAtOnce, cancel, [&](size_t begin, size_t end) {
    Tile tile;
    for (size_t i = begin; i < end; ++i) {
      const uint64_t first = i * all_pixels / count, next = (i + 1) * all_pixels / count,
                     at = first + hash32(static_cast<uint32_t>(i)) % (next - first);
      const PixelRays rays(scene_, camera_, static_cast<int>(at % width),
                           static_cast<int>(at / width), seed);
      Moments all, shallow;
      for (uint32_t sample = 0; sample < kSamples; ++sample) {
        const float time = rays.time(sample);
        const auto ray = rays.ray(sample, time);
        if (!ray) continue;
        Pixel pixel{};
        tile.deep.assign(1, 0.0f);
        Path path(*ray, pixel, tile, 0, sample, rays.seed(), time);
        path.max_bounces = max_bounces;
        path.leaves_gather_points = path.tries_beams = true;
        trace_path(path);
        tile.gather_points.clear();
        const double light = luminance(pixel.combined());
        all.add(light);
        shallow.add(light - tile.deep[0]);
      }
      seen[i] = {all.sum / kSamples, all.variance(kSamples), shallow.variance(kSamples)};
    }
  });
  double square = 0;
  for (const Seen& s : seen) square += s.light * s.light / static_cast<double>(count);
  double all = 0, shallow = 0;
  for (const Seen& s : seen) {
    const double scale = s.light * s.light + kDark * square;
    if (!(scale > 0) || !std::isfinite(s.variance)) continue;
    all += s.variance / scale;
    shallow += s.shallow_variance / scale;
  }
  std::vector<double> variances;
  for (const Seen& s : seen) variances.push_back(std::isfinite(s.variance) ? s.variance : 0);
  const auto low = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 4);
  if (!variances.empty()) std::nth_element(variances.begin(), low, variances.end());
  return {all > 0 ? 1 - shallow / all : 0, variances.empty() ? 0 : *low};
}

}  // namespace photon_splat
