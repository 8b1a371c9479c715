#include "renderer.h"

#include <chrono>

namespace photon_splat {
namespace {

constexpr uint64_t kPilotPaths = 65536;
constexpr double kPhotonsPerDisc = 100;  // from one pass, before radii shrink
constexpr double kShrinkExponent = -1.0 / 6.0;  // h ~ pass^(-1/6): variance and squared bias fall alike (Knaus & Zwicker 2011)

class Timer {
 public:
  explicit Timer(double& sum) : sum_(sum) {}
  ~Timer() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& sum_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

void Renderer::build() {
  Timer timer(seconds_.acceleration);
  camera_ = std::make_unique<Camera>(camera_settings);
  splatter_ = std::make_unique<Splatter>(options.kernel);
  scene.build(cancel_);
  lights_ = std::make_unique<Lights>(scene, lamps);
  camera_tracer_ = std::make_unique<CameraTracer>(scene, *lights_, *camera_, hash_combine(options.seed, 2));
  photon_tracer_ = std::make_unique<PhotonTracer>(scene, *lights_, options.max_bounces);
  film_.reset(camera_settings.region_width, camera_settings.region_height);
  pass_film_.reset(film_.width, film_.height);
  errors_.reset(film_.width, film_.height);
}

void Renderer::require_built() const {
  if (!camera_tracer_) throw std::logic_error("build() comes before the other stages");
}

void Renderer::trace_camera(uint32_t pass) {
  require_built();
  Timer timer(seconds_.camera);
  records_ = &camera_tracer_->trace(pass, pass_film_, cancel_);
}

void Renderer::make_points(uint32_t pass) {
  if (!records_) throw std::logic_error("trace_camera() comes before make_points()");
  if (!radii_) {
    Timer timer(seconds_.photons);
    KeyFilter keys;
    for (const Record& r : *records_) keys.add(r.key);
    const uint64_t paths = std::max<uint64_t>(1, std::min(options.photons_per_pass, kPilotPaths));
    photon_tracer_->learn_emission(paths, hash_combine(options.seed, 4), keys, cancel_);
    const auto& pilot = photon_tracer_->trace(0, paths, static_cast<double>(paths), hash_combine(options.seed, 3), keys, cancel_);
    radii_ = std::make_unique<RadiusMap>(scene, pilot, static_cast<double>(paths));
    pilot_ = photon_tracer_->counts();
  }
  {
    Timer timer(seconds_.camera);
    PointSettings s;
    s.photons_per_disc = kPhotonsPerDisc;
    s.paths_per_pass = static_cast<double>(std::max<uint64_t>(1, options.photons_per_pass));
    s.radius_factor = options.radius_scale * static_cast<float>(std::pow(pass + 1.0, kShrinkExponent));
    s.spacing = options.point_spacing;
    points_.build(scene, *records_, *radii_, s, pass, options.seed, cancel_);
  }
  if (options.boundary_correction) {
    Timer timer(seconds_.boundary);
    points_.correct_boundaries(scene, cancel_);
  }
  Timer timer(seconds_.splat);
  splatter_->set_blocks(points_.block_bounds());
}

void Renderer::trace_photons(uint32_t pass, uint64_t first, uint64_t count) {
  require_built();
  Timer timer(seconds_.photons);
  photons_ = &photon_tracer_->trace(pass * options.photons_per_pass + first, count,
                                    static_cast<double>(options.photons_per_pass), hash_combine(options.seed, 1),
                                    points_.keys(), cancel_);
}

void Renderer::splat() {
  require_built();
  Timer timer(seconds_.splat);
  splatter_->splat(*photons_, points_.blocks(), scene.pool(), cancel_);
}

const Splatter& Renderer::find_pairs(size_t first, size_t count) {
  require_built();
  if (first > photons_->size() || count > photons_->size() - first) throw std::out_of_range("there are not so many photons");
  Timer timer(seconds_.splat);
  splatter_->find_pairs(photons_->data() + first, count, points_.blocks().size(), scene.pool(), cancel_);
  return *splatter_;
}

void Renderer::set_photons(std::vector<Photon> photons) {
  require_built();
  given_photons_ = std::move(photons);
  photons_ = &given_photons_;
}

void Renderer::resolve() {
  require_built();
  Timer timer(seconds_.splat);
  const std::vector<Record>& records = *records_;
  const std::vector<PointBlock>& blocks = points_.blocks();
  const std::vector<size_t>& ranges = camera_tracer_->tile_ranges();
  scene.pool().for_each(ranges.size() - 1, cancel_, [&](size_t tile, int) {
    for (size_t i = ranges[tile]; i < ranges[tile + 1]; ++i) {
      const uint32_t point = points_.point_of_record(i), lane = point % kBlockSize;
      const PointBlock& block = blocks[point / kBlockSize];
      const Rgb irradiance = Rgb{block.r[lane], block.g[lane], block.b[lane]} * block.scale[lane];
      Pixel& pixel = pass_film_.pixels[records[i].pixel];
      const Rgb light = records[i].throughput * irradiance;
      pixel.diffuse_indirect += light;
      const float wide = luminance(irradiance);
      if (wide > 0) pixel.detail += luminance(light) * (1 - block.narrow[lane] * block.narrow_scale[lane] / wide);
      // Photons per square metre: the kernel disc holds `count` of them.
      pixel.photon_density += block.count[lane] * block.inverse_h2[lane] / kPi;
    }
  });
  finish_pass();
}

void Renderer::finish_pass() {
  add_sample(film_, pass_film_, scene.pool());
  Timer timer(seconds_.error);
  errors_.add(pass_film_, scene.pool());
}

void Renderer::make_error_estimate() {
  require_built();
  Timer timer(seconds_.error);
  errors_.update(scene.pool());
}

void Renderer::trace_reference(uint32_t sample) {
  require_built();
  Timer timer(seconds_.camera);
  camera_tracer_->trace_reference(sample, options.max_bounces, pass_film_, cancel_);
  finish_pass();
}

PhotonCounts Renderer::photon_counts() const {
  if (!photon_tracer_) return {};
  const PhotonCounts all = photon_tracer_->counts();
  return {all.traced - pilot_.traced, all.stored - pilot_.stored, all.rays};
}

uint64_t Renderer::rays() const {
  return (camera_tracer_ ? camera_tracer_->rays() : 0) + photon_counts().rays;
}

}  // namespace photon_splat
