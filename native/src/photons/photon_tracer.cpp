#include "photons/photon_tracer.h"

#include "math/random_streams.h"
#include "simd/dispatch.h"

namespace photon_splat {
namespace {

constexpr uint64_t kPathsPerChunk = PhotonPaths::kMost;  // their state stays in the cache
constexpr double kMorePhotons = 1.1;  // memory is kept for, than the last paths have left

}  // namespace

BounceKernel choose_bounce_kernel(const std::string& name) {
  return choose_variant<BounceKernel>(PHOTON_SPLAT_VARIANTS(bounce), name);
}

PhotonStart PhotonTracer::start(uint64_t index, uint32_t seed) const {
  if (targets_) return emitter_.emit_towards(*targets_, index, seed);
  return emitter_.emit(emitter_.primary(index, seed, guide_ ? &*guide_ : nullptr));
}

void PhotonTracer::start(uint64_t first, uint32_t count, uint32_t seed, PhotonStart* starts) const {
  if (targets_) {
    for (uint32_t i = 0; i < count; ++i) starts[i] = start(first + i, seed);
    return;
  }
  EmissionPrimary primaries[kStartsAtOnce];
  emitter_.primaries(first, count, seed, guide_ ? &*guide_ : nullptr, primaries);
  emitter_.emit(primaries, count, starts);
}

const Photons& PhotonTracer::trace(uint64_t first, uint64_t count, double total, uint32_t seed,
                                   const SurfaceFilter& visible, const CancelFlag& cancel) {
  return trace(first, count, total, seed, visible, cancel, nullptr);
}

const Photons& PhotonTracer::trace(uint64_t first, uint64_t count, double total, uint32_t seed,
                                   const SurfaceFilter& visible, const CancelFlag& cancel,
                                   Usefulness* useful) {
  join_.clear();
  total_ = total;
  if (useful) useful->of_path.assign(count, 0);
  if (lights_.total_power() <= 0 || max_bounces_ < 1) return join_.photons();
  const size_t chunk_count = (count + kPathsPerChunk - 1) / kPathsPerChunk;
  travellers_.resize(scene_.pool().size());
  const double per_path = last_counts_.traced ? static_cast<double>(last_counts_.stored) /
                                                    static_cast<double>(last_counts_.traced)
                                              : 0;
  join_.begin(chunk_count,
              static_cast<size_t>(per_path * kMorePhotons * static_cast<double>(count)),
              keeps_groups_);
  try {
    scene_.pool().for_each(chunk_count, cancel, [&](size_t c, int worker) {
      const uint64_t begin = c * kPathsPerChunk;
      std::unique_ptr<PhotonRun> run = join_.take();
      Chunk chunk{first + begin,
                  static_cast<uint32_t>(std::min(kPathsPerChunk, count - begin)),
                  total,
                  seed,
                  visible,
                  useful,
                  useful ? &useful->of_path[begin] : nullptr,
                  travellers_[worker],
                  *run,
                  photon_numbers(PhotonDimension::kFirstBounce, seed)};
      trace_chunk(chunk);
      join_.add(c, std::move(run));
    });
    join_.finish(scene_.pool(), cancel);
  } catch (...) {
    join_.clear();
    throw;
  }
  last_counts_ = {count, beams_ != BeamLight::kNone ? join_.beams().size() : join_.photons().size(),
                  join_.rays(), join_.shaded()};
  counts_ = {counts_.traced + count, counts_.stored + last_counts_.stored,
             counts_.rays + last_counts_.rays, counts_.shaded + last_counts_.shaded};
  return join_.photons();
}

}  // namespace photon_splat
