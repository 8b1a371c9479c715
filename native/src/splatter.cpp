#include "splatter.h"

#include <bit>
#include <stdexcept>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace photon_splat {
namespace {

constexpr size_t kFanout = 4;
constexpr size_t kChunk = 4096;
constexpr double kMostPairs = 8e6;  // in memory at once, as long as one chunk does not exceed it

}  // namespace

SplatKernel choose_kernel(const std::string& name, std::string* chosen) {
  const auto take = [&](const char* kernel_name, SplatKernel kernel) {
    if (chosen) *chosen = kernel_name;
    return kernel;
  };
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (avx512 && (name.empty() || name == "avx512")) return take("avx512", splat_block_avx512);
  if (avx2 && (name.empty() || name == "avx2")) return take("avx2", splat_block_avx2);
  if (__builtin_cpu_supports("sse4.2") && (name.empty() || name == "sse42")) return take("sse42", splat_block_sse42);
#endif
  if (name.empty() || name == "generic") return take("generic", splat_block_generic);
  throw std::invalid_argument("the splatting kernel '" + name + "' does not run on this machine");
}

Splatter::Node Splatter::make_node(const std::vector<Bounds>& bounds, size_t first) {
  Node node;
  for (size_t k = 0; k < kFanout; ++k) {
    const Bounds b = first + k < bounds.size() ? bounds[first + k] : Bounds{};  // an empty one holds nothing
    node.lower_x[k] = b.lower.x; node.lower_y[k] = b.lower.y; node.lower_z[k] = b.lower.z;
    node.upper_x[k] = b.upper.x; node.upper_y[k] = b.upper.y; node.upper_z[k] = b.upper.z;
  }
  return node;
}

// Bit k tells whether child k holds p.
unsigned Splatter::holding(const Node& n, const Vec3& p) {
#if defined(__SSE2__)
  const __m128 x = _mm_set1_ps(p.x), y = _mm_set1_ps(p.y), z = _mm_set1_ps(p.z);
  const __m128 in_x = _mm_and_ps(_mm_cmpge_ps(x, _mm_load_ps(n.lower_x)), _mm_cmple_ps(x, _mm_load_ps(n.upper_x)));
  const __m128 in_y = _mm_and_ps(_mm_cmpge_ps(y, _mm_load_ps(n.lower_y)), _mm_cmple_ps(y, _mm_load_ps(n.upper_y)));
  const __m128 in_z = _mm_and_ps(_mm_cmpge_ps(z, _mm_load_ps(n.lower_z)), _mm_cmple_ps(z, _mm_load_ps(n.upper_z)));
  return static_cast<unsigned>(_mm_movemask_ps(_mm_and_ps(in_x, _mm_and_ps(in_y, in_z))));
#else
  unsigned mask = 0;
  for (unsigned k = 0; k < kFanout; ++k)
    mask |= unsigned((p.x >= n.lower_x[k]) & (p.x <= n.upper_x[k]) & (p.y >= n.lower_y[k]) & (p.y <= n.upper_y[k]) &
                     (p.z >= n.lower_z[k]) & (p.z <= n.upper_z[k])) << k;
  return mask;
#endif
}

void Splatter::set_blocks(const std::vector<Bounds>& bounds) {
  levels_.clear();
  std::vector<Bounds> below = bounds;
  do {
    std::vector<Node> level;
    std::vector<Bounds> around((below.size() + kFanout - 1) / kFanout);
    for (size_t i = 0; i < below.size(); ++i) around[i / kFanout].add(below[i]);
    for (size_t i = 0; i < below.size(); i += kFanout) level.push_back(make_node(below, i));
    levels_.push_back(std::move(level));
    below = std::move(around);
  } while (below.size() > 1);
}

void Splatter::find_blocks(const Vec3& p, uint32_t photon, std::vector<Pair>& out) const {
  struct Entry {
    uint32_t level, node;
  };
  Entry stack[64];  // at most 3 entries wait on each of the 16 levels that 2^32 blocks would have
  int top = 0;
  stack[top++] = {static_cast<uint32_t>(levels_.size()) - 1, 0};
  while (top) {
    const Entry e = stack[--top];
    for (unsigned mask = holding(levels_[e.level][e.node], p); mask; mask &= mask - 1) {
      const uint32_t child = e.node * kFanout + static_cast<uint32_t>(std::countr_zero(mask));
      if (e.level == 0) out.push_back({child, photon});
      else stack[top++] = {e.level - 1, child};
    }
  }
}

void Splatter::find_pairs(const Photon* photons, size_t count, size_t block_count, ThreadPool& pool,
                          const CancelFlag& cancel) {
  const size_t chunk_count = (count + kChunk - 1) / kChunk;
  if (chunk_pairs_.size() < chunk_count) chunk_pairs_.resize(chunk_count);
  pool.for_each(chunk_count, cancel, [&](size_t c, int) {
    std::vector<Pair>& pairs = chunk_pairs_[c];
    pairs.clear();
    const size_t end = std::min(count, (c + 1) * kChunk);
    for (size_t i = c * kChunk; i < end; ++i) find_blocks(photons[i].position, static_cast<uint32_t>(i), pairs);
  });

  // Deals the pairs to their blocks, photons staying in order.
  first_.assign(block_count + 1, 0);
  for (size_t c = 0; c < chunk_count; ++c)
    for (const Pair& pair : chunk_pairs_[c]) ++first_[pair.block + 1];
  for (size_t b = 0; b < block_count; ++b) first_[b + 1] += first_[b];
  order_.resize(first_.back());
  pairs_ += order_.size();
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (size_t c = 0; c < chunk_count; ++c)
    for (const Pair& pair : chunk_pairs_[c]) order_[next[pair.block]++] = pair.photon;
}

void Splatter::splat(const std::vector<Photon>& photons, std::vector<PointBlock>& blocks, ThreadPool& pool,
                     const CancelFlag& cancel) {
  if (blocks.empty()) return;
  // In runs whose pairs fit a bounded memory; how many photons that are is learnt from the run before.
  for (size_t first = 0; first < photons.size();) {
    const size_t fitting = static_cast<size_t>(kMostPairs / std::max(pairs_per_photon_, 1.0));
    const size_t count = std::min(photons.size() - first, std::max(kChunk, fitting));
    find_pairs(photons.data() + first, count, blocks.size(), pool, cancel);
    pairs_per_photon_ = std::max(1.0, static_cast<double>(order_.size()) / static_cast<double>(count));
    splat_pairs(photons.data() + first, blocks, pool, cancel);
    first += count;
  }
}

void Splatter::splat_pairs(const Photon* photons, std::vector<PointBlock>& blocks, ThreadPool& pool,
                           const CancelFlag& cancel) const {
  pool.for_each(blocks.size(), cancel, [&](size_t b, int) {
    constexpr uint32_t kBatch = 512;
    SplatPhoton batch[kBatch];
    for (uint32_t begin = first_[b]; begin < first_[b + 1]; begin += kBatch) {
      const uint32_t count = std::min(kBatch, first_[b + 1] - begin);
      for (uint32_t i = 0; i < count; ++i) {
        const Photon& p = photons[order_[begin + i]];
        const Vec3 n = decode_direction(p.normal);
        batch[i] = {p.position.x, p.position.y, p.position.z, p.key, n.x, n.y, n.z, p.power.x, p.power.y, p.power.z, luminance(p.power)};
      }
      kernel_(blocks[b], batch, count);
    }
  });
}

}  // namespace photon_splat
