#include "density/visible_points.h"

#include <atomic>
#include <bit>
#include <numeric>

#include "math/morton.h"
#include "math/random_streams.h"
#include "util/radix_sort.h"

namespace photon_splat {
namespace {

constexpr size_t kShards = 64;
// Smallest factor on the radius: a fifth of its photons remain, since the strip is narrower than
// both
constexpr float kLeastOnStrips = 0.2f;
// Curvature takes no more than this: 1/25 of the photons remain
constexpr float kLeastOfDensityRadius = 0.2f;
// Smallest kernel radius in the first pass, in footprints of camera samples
constexpr float kFootprintFloor = 2.0f;

// Radii come in steps of 2^(1/4), so that neighbours share cells.
float quantized(float h) { return std::exp2(std::round(std::log2(h) * 4) / 4); }

}  // namespace

void VisiblePoints::build(Scene& scene, const GatherPoints& gather_points, const RadiusMap& radii,
                          const PointSettings& settings, uint32_t pass, uint32_t seed,
                          const CancelFlag& cancel) {
  find_cells(scene, gather_points, radii, settings, pass, seed, cancel);
  pick_points(scene, cancel);
  looks_.clear();
  if (settings.occlusion) split_at_walls(scene, gather_points, cancel);
  fill_blocks(scene, gather_points, cancel);
}

void VisiblePoints::find_cells(Scene& scene, const GatherPoints& gather_points,
                               const RadiusMap& radii, const PointSettings& s, uint32_t pass,
                               uint32_t seed, const CancelFlag& cancel) {
  cells_.resize(gather_points.size());
  Random random(pass, stream_seed(seed, RandomStream::kPointGrid));
  const Vec3 shift{random.next(), random.next(), random.next()};
  // Rounding takes part of a disc's place; of things far off the disc's own footprint is larger.
  const float magnitude = scene.has_far_things() ? scene.near
                                                 : std::max(max_abs(scene.bounds().lower),
                                                            max_abs(scene.bounds().upper));
  const float smallest = std::max(1e-6f * (std::isfinite(magnitude) ? magnitude : 1.0f), 1e-30f);
  scene.pool().for_each(chunks_of(gather_points.size()), cancel, [&](size_t c, int) {
    const size_t end = std::min(gather_points.size(), (c + 1) * kChunk);
    RadiusMap::Memory near;
    for (size_t i = c * kChunk; i < end; ++i) {
      const GatherPoint& r = gather_points[i];
      if (r.caustics_only && !s.caustics) {
        cells_[i] = {};
        continue;
      }
      const float factor =
          s.radius_factor * (s.pixel_factors && !r.after_gather ? s.pixel_factors[r.pixel] : 1.0f);
      float whole = radii.radius(r.key, r.position, s.photons_per_disc, s.paths_per_pass, near);
      // Discs of any size that reach across a strip agree with each other, however the light
      // changes across it: passes begin with such as do not, and widen them where nothing is seen
      // to change.
      whole = std::max(std::min(whole, patch_width(scene, r.instance, r.triangle)),
                       kLeastOnStrips * whole);
      float h = factor * whole;
      h = std::min(std::max(h, kFootprintFloor * std::min(factor, 1.0f) * r.footprint),
                   radii.largest());
      // Where the surface bends a disc blurs over its normals; where photons are few that is the
      // lesser evil.
      h = std::max(std::min(h, curvature_radius_limit(scene, r.instance, r.triangle)),
                   kLeastOfDensityRadius * h);
      h = s.fixed_radius > 0 ? s.fixed_radius : quantized(std::max(h, smallest));
      uint64_t hash = i;
      uint32_t rank = hash_combine(static_cast<uint32_t>(i), pass);
      if (s.spacing > 0) {
        const bool sparse = r.after_gather && s.after_gather_spacing > s.spacing;
        const float inverse = 1 / ((sparse ? s.after_gather_spacing : s.spacing) * h);
        const auto index = [&](float p, float d) {
          return static_cast<uint64_t>(static_cast<int64_t>(std::floor(p * inverse + d)));
        };
        if (s.steady) {
          const auto off = [&](float p, float d) {
            return p * inverse + d - std::floor(p * inverse + d) - 0.5f;
          };
          const Vec3 from_middle{off(r.position.x, shift.x), off(r.position.y, shift.y),
                                 off(r.position.z, shift.z)};
          // Bits of floats that are not negative are in the floats' order
          rank = std::bit_cast<uint32_t>(length2(from_middle));
        }
        const uint64_t place = hash64(index(r.position.x, shift.x)) ^
                               hash64(index(r.position.y, shift.y) + 0x51ed27ull) * 3 ^
                               hash64(index(r.position.z, shift.z) + 0xa0761dull) * 5;
        const auto size = static_cast<uint32_t>(std::lround(std::log2(h) * 4));
        hash = hash64(place ^ (uint64_t{r.key} << 32 | (sparse ? ~size : size)));
      }
      cells_[i] = {hash, static_cast<uint32_t>(i), h, rank};
    }
  });
}

// The gather point of lowest rank gives each cell's point its place. Cells are dealt to shards by
// their hash and each shard is worked off in gather point order, so that the outcome does not
// depend on threads.
void VisiblePoints::pick_points(Scene& scene, const CancelFlag& cancel) {
  const size_t count = cells_.size(), chunk_count = chunks_of(count);
  std::vector<uint32_t> dealt(chunk_count * kShards);
  const auto shard_of = [](uint64_t hash) { return hash >> 58; };
  scene.pool().for_each(chunk_count, cancel, [&](size_t c, int) {
    for (size_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i)
      if (cells_[i].h > 0) ++dealt[c * kShards + shard_of(cells_[i].hash)];
  });
  std::vector<uint32_t> first(kShards + 1);
  uint32_t at = 0;
  for (size_t shard = 0; shard < kShards; ++shard) {
    first[shard] = at;
    for (size_t c = 0; c < chunk_count; ++c) {
      const uint32_t n = dealt[c * kShards + shard];
      dealt[c * kShards + shard] = at;
      at += n;
    }
  }
  first[kShards] = at;
  std::vector<uint32_t> order(at);
  scene.pool().for_each(chunk_count, cancel, [&](size_t c, int) {
    for (size_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i)
      if (cells_[i].h > 0)
        order[dealt[c * kShards + shard_of(cells_[i].hash)]++] = static_cast<uint32_t>(i);
  });

  point_of_.assign(count, kNone);
  std::vector<std::vector<Point>> shard_points(kShards);
  scene.pool().for_each(kShards, cancel, [&](size_t shard, int) {
    const uint32_t begin = first[shard], end = first[shard + 1];
    uint32_t capacity = 16;
    while (capacity < 2 * (end - begin)) capacity *= 2;
    std::vector<uint32_t> table(capacity, ~0u);  // point number in this shard
    std::vector<Point>& points = shard_points[shard];
    std::vector<uint32_t> rank;
    for (uint32_t k = begin; k < end; ++k) {
      const uint32_t i = order[k];
      uint32_t slot = static_cast<uint32_t>(cells_[i].hash) & (capacity - 1);
      while (table[slot] != ~0u && cells_[points[table[slot]].gather_point].hash != cells_[i].hash)
        slot = (slot + 1) & (capacity - 1);
      const uint32_t draw = cells_[i].rank;
      if (table[slot] == ~0u) {
        table[slot] = static_cast<uint32_t>(points.size());
        points.push_back({i, cells_[i].h});
        rank.push_back(draw);
      } else if (draw < rank[table[slot]]) {
        points[table[slot]].gather_point = i;
        rank[table[slot]] = draw;
      }
      point_of_[i] = table[slot];
    }
  });
  std::vector<uint32_t> offset(kShards + 1);
  for (size_t shard = 0; shard < kShards; ++shard)
    offset[shard + 1] = offset[shard] + static_cast<uint32_t>(shard_points[shard].size());
  points_.resize(offset[kShards]);
  scene.pool().for_each(kShards, cancel, [&](size_t shard, int) {
    std::copy(shard_points[shard].begin(), shard_points[shard].end(),
              points_.begin() + offset[shard]);
    for (uint32_t k = first[shard]; k < first[shard + 1]; ++k) point_of_[order[k]] += offset[shard];
  });
}

void VisiblePoints::fill_blocks(Scene& scene, const GatherPoints& gather_points,
                                const CancelFlag& cancel) {
  // Morton order makes blocks compact.
  Bounds all;
  for (const Point& p : points_) all.add(gather_points[p.gather_point].position);
  const Vec3 size = points_.empty() ? Vec3{} : all.upper - all.lower;
  const float extent = std::max(max_component(size), 1e-30f);
  std::vector<std::pair<uint64_t, uint32_t>> order(points_.size());
  for (uint32_t i = 0; i < order.size(); ++i) {
    const Vec3 q =
        (gather_points[points_[i].gather_point].position - all.lower) * (2097151.0f / extent);
    order[i] = {
        morton(static_cast<uint64_t>(q.x), static_cast<uint64_t>(q.y), static_cast<uint64_t>(q.z)),
        i};
  }
  decltype(order) scratch;
  radix_sort(order, scratch, 0, 63, &scene.pool(), [](const auto& placed) { return placed.first; });
  // The points of a block by surface: a photon is looked at with those of one.
  scene.pool().for_parts(order.size(), kBlockSize, cancel, [&](size_t begin, size_t end) {
    std::stable_sort(order.begin() + begin, order.begin() + end, [&](const auto& a, const auto& b) {
      return gather_points[points_[a.second].gather_point].key <
             gather_points[points_[b.second].gather_point].key;
    });
  });
  std::vector<uint32_t> place(order.size());
  for (uint32_t i = 0; i < order.size(); ++i) place[order[i].second] = i;
  scene.pool().for_each(chunks_of(point_of_.size()), cancel, [&](size_t c, int) {
    for (size_t i = c * kChunk; i < std::min(point_of_.size(), (c + 1) * kChunk); ++i)
      if (point_of_[i] != kNone) point_of_[i] = place[point_of_[i]];
  });

  std::vector<Look> found(looks_.size());
  for (size_t i = 0; i < found.size(); ++i) found[i] = looks_[order[i].second];
  looks_ = std::move(found);
  const size_t block_count = (points_.size() + kBlockSize - 1) / kBlockSize;
  blocks_.resize(block_count);
  bounds_.resize(block_count);
  places_.resize(points_.size());
  want_ways(scene, gather_points, cancel);
  keys_.clear();
  for (const Point& p : points_) keys_.add(gather_points[p.gather_point].key);
  scene.pool().for_each(block_count, cancel, [&](size_t b, int) {
    PointBlock& block = blocks_[b];
    Bounds bounds;
    for (uint32_t lane = 0; lane < kBlockSize; ++lane) {
      const size_t at = b * kBlockSize + lane;
      block.r[lane] = block.g[lane] = block.b[lane] = block.count[lane] = block.narrow[lane] = 0;
      if (at >= order.size()) {
        block.x[lane] = block.y[lane] = block.z[lane] = block.nx[lane] = block.ny[lane] =
            block.nz[lane] = 0;
        block.key[lane] = 0;
        block.inverse_h2[lane] = INFINITY;
        block.scale[lane] = block.narrow_scale[lane] = 0;
        continue;
      }
      const Point& point = points_[order[at].second];
      const GatherPoint& r = gather_points[point.gather_point];
      const float h = point.h;
      places_[at] = {r.instance, r.triangle};
      block.x[lane] = r.position.x;
      block.y[lane] = r.position.y;
      block.z[lane] = r.position.z;
      block.nx[lane] = r.ng.x;
      block.ny[lane] = r.ng.y;
      block.nz[lane] = r.ng.z;
      block.key[lane] = r.key;
      block.inverse_h2[lane] = 1 / (h * h);
      block.scale[lane] = 2 / (kPi * h * h);
      block.narrow_scale[lane] = 2 * block.scale[lane];
      bounds.add(r.position - Vec3{h, h, h});
      bounds.add(r.position + Vec3{h, h, h});
    }
    bounds_[b] = bounds;
  });
}

// Of blocks around bumps.
void VisiblePoints::want_ways(Scene& scene, const GatherPoints& gather_points,
                              const CancelFlag& cancel) {
  ways_.reset(blocks_.size());
  std::atomic<bool> bumps{false};
  scene.pool().for_each(chunks_of(gather_points.size()), cancel, [&](size_t c, int) {
    for (size_t i = c * kChunk; i < std::min(gather_points.size(), (c + 1) * kChunk); ++i)
      if (gather_points[i].offset) return bumps.store(true, std::memory_order_relaxed);
  });
  if (!bumps) return;
  for (size_t i = 0; i < gather_points.size(); ++i)
    if (gather_points[i].offset && point_of_[i] != kNone) ways_.want(point_of_[i] / kBlockSize);
  ways_.set_up();
}

}  // namespace photon_splat
