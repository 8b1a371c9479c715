#include "density/splatter.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "density/splat_parts.h"
#include "math/morton.h"
#include "simd/dispatch.h"
#include "util/radix_sort.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace photon_splat {
namespace {

constexpr size_t kFanout = 4;
constexpr size_t kChunk = 4096;  // photons that one thread looks up at a time
constexpr uint32_t kFoundAtOnce = 64;
constexpr size_t kRun = 1 << 20;  // photons sorted at once
constexpr int kCurveBits = 10;    // of each axis
// Blocks are worked on one after another where there are more, so that the next can be fetched
constexpr size_t kFewTasks = 256;
constexpr size_t kMostInTask = 16;
constexpr size_t kGroupsPerChunk = kChunk / kGroupSize;
constexpr Photon kNoPhoton{{NAN, NAN, NAN}, 0, 0, 0, {}};
constexpr size_t kFetched = 16;  // photons ahead: in their own order they lie anywhere

// Has the memory of a block come while the one before is worked on: small discs make more blocks
// than caches hold.
void fetch_ahead(const PointBlock& block) {
  for (size_t at = 0; at < offsetof(PointBlock, scale); at += 64)
    prefetch(reinterpret_cast<const char*>(&block) + at);
}

}  // namespace

SplatKernel choose_kernel(const std::string& name, std::string* chosen) {
  if (const auto kernel =
          choose_variant<SplatKernel>(PHOTON_SPLAT_VARIANTS(splat_part), name, chosen))
    return kernel;
  throw std::invalid_argument("the splatting kernel '" + name + "' does not run on this machine");
}

Splatter::Node Splatter::make_node(const std::vector<Bounds>& bounds, size_t first) {
  Node node;
  for (size_t k = 0; k < kFanout; ++k) {
    // An empty one holds nothing
    const Bounds b = first + k < bounds.size() ? bounds[first + k] : Bounds{};
    node.lower_x[k] = b.lower.x;
    node.lower_y[k] = b.lower.y;
    node.lower_z[k] = b.lower.z;
    node.upper_x[k] = b.upper.x;
    node.upper_y[k] = b.upper.y;
    node.upper_z[k] = b.upper.z;
  }
  return node;
}

// Bounds that nodes are compared with, each value repeated in all lanes of a vector.
struct Splatter::Query {
#if defined(__SSE2__)
  __m128 lower_x, lower_y, lower_z, upper_x, upper_y, upper_z;
  explicit Query(const Bounds& b)
      : lower_x(_mm_set1_ps(b.lower.x)),
        lower_y(_mm_set1_ps(b.lower.y)),
        lower_z(_mm_set1_ps(b.lower.z)),
        upper_x(_mm_set1_ps(b.upper.x)),
        upper_y(_mm_set1_ps(b.upper.y)),
        upper_z(_mm_set1_ps(b.upper.z)) {}

  // Bit k tells whether child k meets the bounds.
  unsigned meets(const Node& n) const {
    const auto overlap = [](const float* lower, const float* upper, __m128 from, __m128 to) {
      return _mm_and_ps(_mm_cmpge_ps(to, _mm_load_ps(lower)),
                        _mm_cmple_ps(from, _mm_load_ps(upper)));
    };
    const __m128 x = overlap(n.lower_x, n.upper_x, lower_x, upper_x),
                 y = overlap(n.lower_y, n.upper_y, lower_y, upper_y);
    return static_cast<unsigned>(_mm_movemask_ps(
        _mm_and_ps(_mm_and_ps(x, y), overlap(n.lower_z, n.upper_z, lower_z, upper_z))));
  }
#else
  Bounds b;
  explicit Query(const Bounds& bounds) : b(bounds) {}

  unsigned meets(const Node& n) const {
    unsigned mask = 0;
    for (unsigned k = 0; k < kFanout; ++k)
      mask |= unsigned((b.upper.x >= n.lower_x[k]) & (b.lower.x <= n.upper_x[k]) &
                       (b.upper.y >= n.lower_y[k]) & (b.lower.y <= n.upper_y[k]) &
                       (b.upper.z >= n.lower_z[k]) & (b.lower.z <= n.upper_z[k]))
              << k;
    return mask;
  }
#endif
};

void Splatter::set_blocks(const std::vector<Bounds>& bounds) {
  levels_.clear();
  parts_.clear();
  bounds_ = {};
  for (const Bounds& b : bounds) bounds_.add(b);
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

void Splatter::find_blocks(const Bounds& bounds, uint32_t index, std::vector<Pair>& out) const {
  struct Entry {
    uint32_t level, node;
  };
  const Query query(bounds);
  const Node* const leaves = levels_[0].data();
  // At most 3 entries wait on each of the 16 levels that 2^32 blocks would have
  Entry stack[64 + kFanout];
  Pair found[kFoundAtOnce + kFanout];
  uint32_t top = 0, n = 0;
  stack[top++] = {static_cast<uint32_t>(levels_.size()) - 1, 0};
  while (top) {
    const Entry e = stack[--top];
    const unsigned mask = query.meets((e.level ? levels_[e.level].data() : leaves)[e.node]);
    const uint32_t child = e.node * kFanout;
    // Which children are met cannot be foreseen: all are written, and those that are not are
    // overwritten.
    if (e.level > 0) {
      for (uint32_t k = 0; k < kFanout; top += mask >> k++ & 1)
        stack[top] = {e.level - 1, child + k};
      continue;
    }
    for (uint32_t k = 0; k < kFanout; n += mask >> k++ & 1) found[n] = {child + k, index};
    if (n < kFoundAtOnce) continue;
    out.insert(out.end(), found, found + n);
    n = 0;
  }
  out.insert(out.end(), found, found + n);
}

void Splatter::find_pairs(const Photon* photons, size_t count, size_t block_count, ThreadPool& pool,
                          const CancelFlag& cancel) {
  const size_t chunk_count = (count + kChunk - 1) / kChunk;
  if (chunk_pairs_.size() < chunk_count) chunk_pairs_.resize(chunk_count);
  pool.for_each(chunk_count, cancel, [&](size_t c, int) {
    std::vector<Pair>& pairs = chunk_pairs_[c];
    pairs.clear();
    const size_t end = std::min(count, (c + 1) * kChunk);
    for (size_t i = c * kChunk; i < end; ++i)
      find_blocks({photons[i].position, photons[i].position}, static_cast<uint32_t>(i), pairs);
  });

  deal_pairs(chunk_count, block_count);
}

// Deals the pairs to their blocks, photons staying in order.
void Splatter::deal_pairs(size_t chunk_count, size_t block_count) {
  first_.assign(block_count + 1, 0);
  for (size_t c = 0; c < chunk_count; ++c)
    for (const Pair& pair : chunk_pairs_[c]) ++first_[pair.block + 1];
  for (size_t b = 0; b < block_count; ++b) first_[b + 1] += first_[b];
  order_.resize(first_.back());
  pairs_ += order_.size();
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (size_t c = 0; c < chunk_count; ++c)
    for (const Pair& pair : chunk_pairs_[c]) order_[next[pair.block]++] = pair.index;
}

// Along a Morton curve through these bounds, equal places in the order given; with the bounds of
// each group.
void Splatter::sort_photons(const Photon* photons, size_t count, const Bounds& within,
                            ThreadPool& pool) {
  constexpr float kMost = (1 << kCurveBits) - 1;
  const float scale = kMost / std::max(max_component(within.upper - within.lower), 1e-30f);
  const size_t group_count = (count + kGroupSize - 1) / kGroupSize;
  curve_.resize(count);
  groups_.resize(group_count);
  group_bounds_.resize(group_count);
  const CancelFlag never;
  pool.for_parts(count, kChunk, never, [&](size_t begin, size_t end) {
    const auto cell = [&](float x, float lower) {
      return static_cast<uint32_t>(std::clamp((x - lower) * scale, 0.0f, kMost));
    };
    for (size_t i = begin; i < end; ++i) {
      const Vec3 p = photons[i].position;
      const uint64_t place =
          morton(cell(p.x, within.lower.x), cell(p.y, within.lower.y), cell(p.z, within.lower.z));
      curve_[i] = place << 32 | static_cast<uint32_t>(i);
    }
  });
  radix_sort(curve_, curve_scratch_, 32, 32 + 3 * kCurveBits, &pool,
             [](uint64_t value) { return value; });
  pool.for_parts(group_count, kGroupsPerChunk, never, [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g) {
      group_bounds_[g] = {};
      for (size_t k = 0, i = g * kGroupSize; k < kGroupSize; ++k, ++i) {
        prefetch(&photons[static_cast<uint32_t>(curve_[std::min(i + kFetched, count - 1)])]);
        const Photon& p = i < count ? photons[static_cast<uint32_t>(curve_[i])] : kNoPhoton;
        const Vec3 n = decode_direction(p.normal);
        SplatGroup& to = groups_[g];
        to.x[k] = p.position.x, to.y[k] = p.position.y, to.z[k] = p.position.z;
        to.nx[k] = n.x, to.ny[k] = n.y, to.nz[k] = n.z;
        to.key[k] = p.key;
        to.r[k] = p.power.x, to.g[k] = p.power.y, to.b[k] = p.power.z,
        to.luminance[k] = luminance(p.power);
        if (i < count) group_bounds_[g].add(p.position);
      }
    }
  });
}

// Of the photons sorted last.
void Splatter::find_ways(const Photon* photons, size_t count, ThreadPool& pool) {
  way_groups_.resize(groups_.size());
  pool.for_parts(groups_.size(), kGroupsPerChunk, CancelFlag(), [&](size_t begin, size_t end) {
    for (size_t g = begin; g < end; ++g)
      for (size_t k = 0, i = g * kGroupSize; k < kGroupSize; ++k, ++i) {
        prefetch(&photons[static_cast<uint32_t>(curve_[std::min(i + kFetched, count - 1)])]);
        const Photon& p = i < count ? photons[static_cast<uint32_t>(curve_[i])] : kNoPhoton;
        const Vec3 way = way_over_cosine(decode_direction(p.from), decode_direction(p.normal));
        WayGroup& to = way_groups_[g];
        to.x[k] = way.x, to.y[k] = way.y, to.z[k] = way.z;
      }
  });
}

void Splatter::make_parts(const PointBlocks& blocks, ThreadPool& pool) {
  parts_.resize(blocks.size());
  pool.for_each(blocks.size(), CancelFlag(), [&](size_t b, int) {
    Parts& to = parts_[b];
    to.parts = parts_of(blocks[b]);
    std::vector<Bounds> bounds;
    for (const SplatPart& p : to.parts)
      bounds.push_back({{p.lower_x, p.lower_y, p.lower_z}, {p.upper_x, p.upper_y, p.upper_z}});
    for (size_t i = 0; i < bounds.size(); i += kFanout) to.bounds.push_back(make_node(bounds, i));
  });
}

void Splatter::splat(const Photons& photons, PointBlocks& blocks, WaySums& ways, ThreadPool& pool,
                     const CancelFlag& cancel) {
  if (blocks.empty()) return;
  for (size_t first = 0; first < photons.size(); first += kRun) {
    const size_t count = std::min(photons.size() - first, kRun);
    sort_photons(photons.data() + first, count, bounds_, pool);
    if (!ways.empty()) find_ways(photons.data() + first, count, pool);
    splat_sorted(blocks, ways, pool, cancel);
  }
}

void Splatter::splat_kept(const Photons& photons, PointBlocks& blocks, WaySums& ways,
                          ThreadPool& pool, const CancelFlag& cancel) {
  if (photons.size() > kRun) return splat(photons, blocks, ways, pool, cancel);
  if (blocks.empty() || photons.empty()) return;
  if (kept_ != photons.size()) {
    Bounds all;
    for (const Photon& photon : photons) all.add(photon.position);
    sort_photons(photons.data(), photons.size(), all, pool);
    kept_ = photons.size();
  }
  if (!ways.empty() && kept_ways_ != kept_) {
    find_ways(photons.data(), photons.size(), pool);
    kept_ways_ = kept_;
  }
  splat_sorted(blocks, ways, pool, cancel);
}

// The photons sorted last.
void Splatter::splat_sorted(PointBlocks& blocks, WaySums& ways, ThreadPool& pool,
                            const CancelFlag& cancel) {
  if (parts_.size() != blocks.size()) make_parts(blocks, pool);
  const size_t chunk_count = (groups_.size() + kGroupsPerChunk - 1) / kGroupsPerChunk;
  if (chunk_pairs_.size() < chunk_count) chunk_pairs_.resize(chunk_count);
  pool.for_each(chunk_count, cancel, [&](size_t c, int) {
    chunk_pairs_[c].clear();
    for (size_t g = c * kGroupsPerChunk; g < std::min(groups_.size(), (c + 1) * kGroupsPerChunk);
         ++g)
      find_blocks(group_bounds_[g], static_cast<uint32_t>(g), chunk_pairs_[c]);
  });
  deal_pairs(chunk_count, blocks.size());
  const size_t task = std::clamp<size_t>(blocks.size() / kFewTasks, 1, kMostInTask);
  pool.for_each((blocks.size() + task - 1) / task, cancel, [&](size_t t, int) {
    const size_t last = std::min(blocks.size(), (t + 1) * task);
    // Numbers of groups, as many places for each part as groups may meet the block
    std::vector<uint32_t> met;
    std::vector<uint32_t> count;
    for (size_t b = t * task; b < last; ++b) {
      if (b + 1 < last && first_[b + 1] < first_[b + 2]) fetch_ahead(blocks[b + 1]);
      const auto& [parts, bounds] = parts_[b];
      const size_t most = first_[b + 1] - first_[b];
      met.resize(std::max(met.size(), bounds.size() * kFanout * most));
      count.assign(bounds.size() * kFanout, 0);
      for (uint32_t i = first_[b]; i < first_[b + 1]; ++i) {
        const Query query(group_bounds_[order_[i]]);
        for (size_t node = 0; node < bounds.size(); ++node) {
          const unsigned mask = query.meets(bounds[node]);
          for (size_t k = 0, part = node * kFanout; k < kFanout; count[part++] += mask >> k++ & 1)
            met[part * most + count[part]] = order_[i];
        }
      }
      const Splatted photons{groups_.data(), way_groups_.data(), ways.of(b)};
      for (size_t part = 0; part < parts.size(); ++part)
        if (count[part]) kernel_(blocks[b], parts[part], photons, &met[part * most], count[part]);
    }
  });
}

}  // namespace photon_splat
