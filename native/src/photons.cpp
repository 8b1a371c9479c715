#include "photons.h"

#include <cstring>

namespace photon_splat {
namespace {
constexpr uint64_t kPathsPerChunk = 2048;
}

void PhotonTracer::trace_path(uint64_t index, double total, uint32_t seed, const KeyFilter& visible, Chunk& out) const {
  PhotonStart start = lights_.emit(index, seed);
  Rgb power = start.power * static_cast<float>(1.0 / total);
  const float reference = max_component(power);  // survivors keep this power: Russian roulette takes the rest
  if (!(reference > 0) || !std::isfinite(reference)) return;
  Random random(index, seed);
  Vec3 origin = start.origin, direction = start.direction;
  Surface hit;
  for (int bounce = 0; bounce <= max_bounces_; ++bounce) {
    ++out.rays;
    if (ray_log) {
      const float ray[8] = {origin.x, origin.y, origin.z, 0, direction.x, direction.y, direction.z, INFINITY};
      out.ray_log.insert(out.ray_log.end(), ray, ray + 8);
    }
    if (!scene_.intersect(origin, direction, 0, INFINITY, false, hit)) return;
    if (bounce == 0 && !start.accepts(hit.position)) return;
    const float cos_shading = -dot(direction, hit.ns), cos_geometric = -dot(direction, hit.ng);
    if (cos_shading <= 0 || cos_geometric <= 0) return;
    // Density on the surface measures the geometric cosine; the BSDF wants the shading one (Veach 1997, section 5.3).
    power *= cos_shading / cos_geometric;
    if (bounce > 0 && visible.contains(hit.key))
      out.photons.push_back({hit.position, hit.key, encode_direction(-direction), power});
    power *= scene_.albedo(hit);
    const float survival = std::min(1.0f, max_component(power) / reference);
    if (!(survival > 0) || random.next() >= survival) return;
    power *= 1 / survival;
    const Vec3 local = sample_cosine_hemisphere(bounce == 0 ? sobol_2d(static_cast<uint32_t>(index), 3, seed)
                                                            : random.next2());
    if (!(local.z > 0)) return;
    origin = hit.position + hit.ng * ray_epsilon(hit.position, hit.distance);
    direction = Basis(hit.ng).to_world(local);
  }
}

const std::vector<Photon>& PhotonTracer::trace(uint64_t first, uint64_t count, double total, uint32_t seed,
                                               const KeyFilter& visible, const CancelFlag& cancel) {
  photons_.clear();
  if (lights_.total_power() <= 0 || max_bounces_ < 1) return photons_;
  const size_t chunk_count = (count + kPathsPerChunk - 1) / kPathsPerChunk;
  if (chunks_.size() < chunk_count) chunks_.resize(chunk_count);
  scene_.pool().for_each(chunk_count, cancel, [&](size_t c, int) {
    Chunk& chunk = chunks_[c];
    chunk.photons.clear();
    chunk.ray_log.clear();
    chunk.rays = 0;
    const uint64_t end = std::min(count, (c + 1) * kPathsPerChunk);
    for (uint64_t i = c * kPathsPerChunk; i < end; ++i) trace_path(first + i, total, seed, visible, chunk);
  });
  std::vector<size_t> offset(chunk_count + 1);
  for (size_t c = 0; c < chunk_count; ++c) {
    offset[c + 1] = offset[c] + chunks_[c].photons.size();
    counts_.rays += chunks_[c].rays;
    if (ray_log) ray_log->insert(ray_log->end(), chunks_[c].ray_log.begin(), chunks_[c].ray_log.end());
  }
  photons_.resize(offset.back());
  scene_.pool().for_each(chunk_count, cancel, [&](size_t c, int) {
    std::copy(chunks_[c].photons.begin(), chunks_[c].photons.end(), photons_.begin() + offset[c]);
  });
  counts_.traced += count;
  counts_.stored += photons_.size();
  return photons_;
}

}  // namespace photon_splat
