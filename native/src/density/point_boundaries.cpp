// What edges, walls and things mean for the discs of visible points.
#include <atomic>
#include <utility>

#include "density/bent_occlusion.h"
#include "density/visible_points.h"

namespace photon_splat {
namespace {

constexpr float kTrustedMass = 0.2f;  // of a curved patch
constexpr int kMostHalvings = 8;
constexpr float kWhole = 0.999f;      // mass of a disc that no edge cuts
constexpr float kClearOfWall = 0.9f;  // of the distance to it
// Closer to a wall a disc of this size is moved away from it: as far as the light's mean place in
// the half disc at an edge is from that (16 / (15 pi)), so that both are as blurred. Where there
// is no room for it, of the second size.
constexpr float kLeastOfWalledRadius[] = {0.34f, 0.15f};
constexpr float kLeastBetweenWalls = 0.5f;  // of that, where there is no room for it either
constexpr float kLeastUnhidden = 0.1f;      // of a kernel's mass, whatever the probes say
// Light below this share of what is beside it is faint, and its points' masses are found with a
// chance that falls with it, to the least
constexpr float kFaint = 0.02f, kLeastChance = 1.0f / 8;
constexpr uint32_t kMassDraw = 0x6d617373;

// Divides by the part of the kernel that lies on the surface and is not hidden there. Returns
// whether an edge cuts the disc.
bool divide_by_mass(PointBlock& block, uint32_t lane, KernelMass m, const DiscOcclusion& inside) {
  const bool cut = m.mass < kWhole;
  m.mass = std::max(m.mass - inside.hidden, kLeastUnhidden * m.mass);
  m.narrow = std::max(m.narrow - inside.narrow_hidden, kLeastUnhidden * m.narrow);
  if (!m.exact) {
    m.mass = std::max(m.mass, kTrustedMass);
    m.narrow = std::max(m.narrow, kTrustedMass);
  }
  block.scale[lane] /= m.mass;
  block.narrow_scale[lane] /= m.narrow;
  return cut;
}

}  // namespace

VisiblePoints::Look VisiblePoints::look(Scene& scene, const GatherPoint& r, float h) const {
  const uint32_t seed = hash_of(r.position);
  Look look;
  look.region = ClearRegions::region(r.key, r.position, h);
  look.done = scene.is_planar(r.instance, r.triangle) &&
              clear_regions_.to_look_at(look.region, hash32(seed));
  look.found = look.done
                   ? disc_occlusion(scene, r.instance, r.triangle, r.key, r.position, r.ng, h, seed)
                   : DiscOcclusion{0, 0, h};
  return look;
}

void VisiblePoints::split_at_walls(Scene& scene, const GatherPoints& gather_points,
                                   const CancelFlag& cancel) {
  looks_.resize(points_.size());
  scene.pool().for_parts(points_.size(), 64, cancel, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      looks_[i] = look(scene, gather_points[points_[i].gather_point], points_[i].h);
  });
  std::vector<std::vector<uint32_t>> behind(
      chunks_of(gather_points.size()));  // gather points, in their order
  scene.pool().for_each(behind.size(), cancel, [&](size_t c, int) {
    for (size_t i = c * kChunk; i < std::min(gather_points.size(), (c + 1) * kChunk); ++i) {
      const uint32_t p = point_of_[i];
      if (p == kNone) continue;
      const Point& point = points_[p];
      const Vec3& middle = gather_points[point.gather_point].position;
      const float clear = looks_[p].found.clear;
      if (clear < point.h && length2(gather_points[i].position - middle) > sqr(clear) &&
          wall_between(scene, gather_points[i].instance, gather_points[i].position, middle,
                       gather_points[point.gather_point].ng, point.h))
        behind[c].push_back(static_cast<uint32_t>(i));
    }
  });
  std::vector<uint32_t> second(points_.size(), kNone);  // the point behind the wall
  const size_t before = points_.size();
  for (const std::vector<uint32_t>& some : behind) {
    for (const uint32_t i : some) {
      uint32_t& p = second[point_of_[i]];
      if (p == kNone) {
        p = static_cast<uint32_t>(points_.size());
        points_.push_back({i, points_[point_of_[i]].h});
      } else if (cells_[i].rank < cells_[points_[p].gather_point].rank) {
        points_[p].gather_point = i;
      }
      point_of_[i] = p;
    }
  }
  looks_.resize(points_.size());
  scene.pool().for_parts(points_.size() - before, 64, cancel, [&](size_t begin, size_t end) {
    for (size_t i = before + begin; i < before + end; ++i)
      looks_[i] = look(scene, gather_points[points_[i].gather_point], points_[i].h);
  });
  for (size_t i = 0; i < looks_.size(); ++i)
    if (looks_[i].done) clear_regions_.learn(looks_[i].region, looks_[i].clear(points_[i].h));
}

void VisiblePoints::correct_boundaries(Scene& scene, const CancelFlag& cancel) {
  std::atomic<uint64_t> obstructed{0}, cut{0}, measured{0};
  waiting_.assign(places_.size(), 0);
  const bool looks = !looks_.empty();  // at what stands in discs
  scene.pool().for_each(blocks_.size(), cancel, [&](size_t b, int) {
    PointBlock& block = blocks_[b];
    const size_t first = b * kBlockSize, last = std::min(first + kBlockSize, places_.size());
    for (size_t i = first; i < last; ++i) {
      const uint32_t lane = static_cast<uint32_t>(i - first);
      const auto [instance, triangle] = places_[i];
      Vec3 x{block.x[lane], block.y[lane], block.z[lane]};
      const Vec3 n{block.nx[lane], block.ny[lane], block.nz[lane]};
      float h = 1 / std::sqrt(block.inverse_h2[lane]);
      DiscOcclusion inside{0, 0, h};
      if (looks) inside = looks_[i].found;
      obstructed.fetch_add(inside.hidden > 0 || inside.clear < h, std::memory_order_relaxed);
      if (looks && !scene.is_planar(instance, triangle)) waiting_[i] = kLook;
      if (inside.clear >= h && has_exact_mass(scene, instance, triangle, h)) {
        waiting_[i] |= kMass;
        continue;
      }
      if (inside.clear < h) {
        const uint32_t seed = hash_of(x), key = block.key[lane];
        const float whole = h;
        bool found = false;
        for (const float share : kLeastOfWalledRadius) {
          h = share * whole;
          if (kClearOfWall * inside.clear >= h) break;
          found = step_clear_of_walls(scene, instance, triangle, key, x, n, h, seed, inside);
          if (found) break;
        }
        if (!found) {
          h = std::max(kClearOfWall * inside.clear, kLeastBetweenWalls * h);
          inside = disc_occlusion(scene, instance, triangle, key, x, n, h, seed);
        }
        block.x[lane] = x.x;
        block.y[lane] = x.y;
        block.z[lane] = x.z;
      }
      KernelMass m = kernel_mass(scene, instance, triangle, x, n, h);
      // Where the mass is a guess because edges crowd, a smaller disc sees less of the trouble.
      for (int halving = 0; !m.exact && m.mass < kTrustedMass && halving < kMostHalvings;
           ++halving) {
        h *= 0.5f;
        m = kernel_mass(scene, instance, triangle, x, n, h);
      }
      block.inverse_h2[lane] = 1 / (h * h);
      block.scale[lane] = 2 / (kPi * h * h);
      block.narrow_scale[lane] = 2 * block.scale[lane];
      cut.fetch_add(divide_by_mass(block, lane, m, inside), std::memory_order_relaxed);
      measured.fetch_add(1, std::memory_order_relaxed);
    }
  });
  counts_.points += points_.size();
  counts_.measured += measured;
  counts_.cut += cut;
  counts_.obstructed += obstructed;
}

// Of a point's mass to be found. What its photons add to a pixel, over the pixel's other light, is
// how much an error of theirs matters.
float VisiblePoints::chance_of_mass(size_t point, const LightBeside& beside) const {
  if (beside.luminance.empty()) return 1;
  const GatherPoint& at = (*beside.gather_points)[points_[point].gather_point];
  const PointBlock& block = blocks_[point / kBlockSize];
  const size_t lane = point % kBlockSize;
  const Rgb sum{block.r[lane], block.g[lane], block.b[lane]};
  const float own = luminance(at.throughput * sum) * block.scale[lane] * beside.more,
              faint = kFaint * beside.luminance[at.pixel];
  return own < faint ? std::max(own / faint, kLeastChance) : 1;
}

void VisiblePoints::find_masses(Scene& scene, const LightBeside& beside, const CancelFlag& cancel) {
  std::atomic<uint64_t> cut{0}, measured{0}, obstructed{0};
  bent_looks_.resize(blocks_.size());
  scene.pool().for_each(blocks_.size(), cancel, [&](size_t b, int) {
    PointBlock& block = blocks_[b];
    bent_looks_[b].clear();
    const size_t first = b * kBlockSize, last = std::min(first + kBlockSize, waiting_.size());
    for (size_t i = first; i < last; ++i) {
      const uint32_t lane = static_cast<uint32_t>(i - first);
      if (!waiting_[i] || !(block.count[lane] > 0)) continue;
      const auto waits = std::exchange(waiting_[i], uint8_t{0});
      const auto [instance, triangle] = places_[i];
      const Vec3 x{block.x[lane], block.y[lane], block.z[lane]},
          n{block.nx[lane], block.ny[lane], block.nz[lane]};
      const uint32_t seed = hash_of(x), key = block.key[lane];
      const float chance = chance_of_mass(i, beside);
      if (chance < 1 && to_unit_float(hash_combine(seed, kMassDraw)) >= chance) continue;
      const float h = 1 / std::sqrt(block.inverse_h2[lane]);
      const float scale = block.scale[lane], narrow_scale = block.narrow_scale[lane];
      if (waits & kMass) {
        const KernelMass m = kernel_mass(scene, instance, triangle, x, n, h);
        const DiscOcclusion inside = looks_.empty() ? DiscOcclusion{0, 0, h} : looks_[i].found;
        cut.fetch_add(divide_by_mass(block, lane, m, inside), std::memory_order_relaxed);
        measured.fetch_add(1, std::memory_order_relaxed);
      }
      const uint64_t region = ClearRegions::region(key, x, h);
      if (waits & kLook && clear_regions_.to_look_at(region, hash32(seed))) {
        const OverOpen over = over_open_share(scene, instance, triangle, key, x, n, h, seed);
        const bool clear = !(over.whole > 1);
        block.scale[lane] *= over.whole;
        block.narrow_scale[lane] *= over.narrow;
        obstructed.fetch_add(!clear, std::memory_order_relaxed);
        bent_looks_[b].push_back({region, clear});
      }
      // For those as well that were not drawn
      block.scale[lane] = scale + (block.scale[lane] - scale) / chance;
      block.narrow_scale[lane] = narrow_scale + (block.narrow_scale[lane] - narrow_scale) / chance;
    }
  });
  for (const auto& looks : bent_looks_)
    for (const BentLook& look : looks) clear_regions_.learn(look.region, look.clear);
  counts_.measured += measured;
  counts_.cut += cut;
  counts_.obstructed += obstructed;
}

}  // namespace photon_splat
