#include "splatter.h"

#include <stdexcept>

namespace photon_splat {
namespace {

constexpr size_t kFanout = 4;
constexpr size_t kChunk = 4096;

bool contains(const Bounds& b, const Vec3& p) {
  // Bitwise: the branches of a logical chain would be mispredicted.
  return (p.x >= b.lower.x) & (p.x <= b.upper.x) & (p.y >= b.lower.y) & (p.y <= b.upper.y) & (p.z >= b.lower.z) &
         (p.z <= b.upper.z);
}

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

void Splatter::set_blocks(const std::vector<Bounds>& bounds) {
  levels_.assign(1, bounds);
  while (levels_.back().size() > kFanout) {
    const std::vector<Bounds>& below = levels_.back();
    std::vector<Bounds> level((below.size() + kFanout - 1) / kFanout);
    for (size_t i = 0; i < below.size(); ++i) level[i / kFanout].add(below[i]);
    levels_.push_back(std::move(level));
  }
}

void Splatter::find_blocks(const Vec3& p, uint32_t photon, std::vector<Pair>& out) const {
  struct Entry {
    uint32_t level, first, end;
  };
  Entry stack[64];
  int top = 0;
  const uint32_t root = static_cast<uint32_t>(levels_.size()) - 1;
  stack[top++] = {root, 0, static_cast<uint32_t>(levels_[root].size())};
  while (top) {
    const Entry e = stack[--top];
    const Bounds* bounds = levels_[e.level].data();
    for (uint32_t i = e.first; i < e.end; ++i) {
      if (!contains(bounds[i], p)) continue;
      if (e.level == 0) {
        out.push_back({i, photon});
      } else {
        const uint32_t first = i * kFanout;
        stack[top++] = {e.level - 1, first,
                        std::min<uint32_t>(first + kFanout, static_cast<uint32_t>(levels_[e.level - 1].size()))};
      }
    }
  }
}

void Splatter::splat(const std::vector<Photon>& photons, std::vector<PointBlock>& blocks, ThreadPool& pool,
                     const CancelFlag& cancel) {
  if (photons.empty() || blocks.empty()) return;
  const size_t chunk_count = (photons.size() + kChunk - 1) / kChunk;
  if (chunk_pairs_.size() < chunk_count) chunk_pairs_.resize(chunk_count);
  pool.for_each(chunk_count, cancel, [&](size_t c, int) {
    std::vector<Pair>& pairs = chunk_pairs_[c];
    pairs.clear();
    const size_t end = std::min(photons.size(), (c + 1) * kChunk);
    for (size_t i = c * kChunk; i < end; ++i) find_blocks(photons[i].position, static_cast<uint32_t>(i), pairs);
  });

  // Deals the pairs to their blocks, photons staying in order.
  first_.assign(blocks.size() + 1, 0);
  for (size_t c = 0; c < chunk_count; ++c)
    for (const Pair& pair : chunk_pairs_[c]) ++first_[pair.block + 1];
  for (size_t b = 0; b < blocks.size(); ++b) first_[b + 1] += first_[b];
  order_.resize(first_.back());
  pairs_ += order_.size();
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (size_t c = 0; c < chunk_count; ++c)
    for (const Pair& pair : chunk_pairs_[c]) order_[next[pair.block]++] = pair.photon;

  static_assert(sizeof(Photon) == sizeof(SplatPhoton));
  pool.for_each(blocks.size(), cancel, [&](size_t b, int) {
    constexpr uint32_t kBatch = 512;
    SplatPhoton batch[kBatch];
    for (uint32_t begin = first_[b]; begin < first_[b + 1]; begin += kBatch) {
      const uint32_t count = std::min(kBatch, first_[b + 1] - begin);
      for (uint32_t i = 0; i < count; ++i) {
        const Photon& p = photons[order_[begin + i]];
        batch[i] = {p.position.x, p.position.y, p.position.z, p.key, p.from, p.power.x, p.power.y, p.power.z};
      }
      kernel_(blocks[b], batch, count);
    }
  });
}

}  // namespace photon_splat
