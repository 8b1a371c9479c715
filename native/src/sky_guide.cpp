#include "sky_guide.h"

#include <algorithm>

namespace photon_splat {
namespace {

constexpr float kCells = 16;               // along the longest side of what the camera sees
constexpr float kCoarser = 4;              // from level to level
constexpr uint32_t kEnough = 24;           // sightings of the world before a histogram is believed
constexpr float kFree = 0.5f;              // of a surface's rays meet the world: their own sampling is good enough
constexpr float kOwn = 0.5f;               // of a sighting's weight goes to its bin, the rest to the four around it

// The octahedral map of the sphere onto the unit square.
Vec2 to_square(const Vec3& d) {
  const float scale = 1 / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  float u = d.x * scale, v = d.y * scale;
  if (d.z < 0) {
    const float fold = (1 - std::abs(v)) * std::copysign(1.0f, u);
    v = (1 - std::abs(u)) * std::copysign(1.0f, v);
    u = fold;
  }
  return {0.5f * (u + 1), 0.5f * (v + 1)};
}

// Its inverse, not normalised: of L1 norm 1. A square's area dA is the solid angle 4 dA / length^3.
Vec3 from_square(const Vec2& s) {
  Vec3 d{2 * s.x - 1, 2 * s.y - 1, 0};
  d.z = 1 - std::abs(d.x) - std::abs(d.y);
  if (d.z < 0) {
    const float fold = (1 - std::abs(d.y)) * std::copysign(1.0f, d.x);
    d.y = (1 - std::abs(d.x)) * std::copysign(1.0f, d.y);
    d.x = fold;
  }
  return d;
}

int bin_of(float s) { return std::clamp(static_cast<int>(s * SkyGuide::kSide), 0, SkyGuide::kSide - 1); }

}  // namespace

Vec3 SkyGuide::Cell::sample(const Vec2& u) const {
  const size_t bin = std::min<size_t>(std::upper_bound(cdf.begin(), cdf.end(), u.x) - cdf.begin(), kBins - 1);
  const float low = bin ? cdf[bin - 1] : 0, share = cdf[bin] - low;
  const float again = share > 0 ? std::clamp((u.x - low) / share, 0.0f, 0x1.fffffep-1f) : 0.5f;
  const Vec2 s{(static_cast<float>(bin % kSide) + again) / kSide, (static_cast<float>(bin / kSide) + u.y) / kSide};
  return normalize(from_square(s));
}

float SkyGuide::Cell::pdf(const Vec3& d) const {
  const Vec2 s = to_square(d);
  const size_t bin = static_cast<size_t>(bin_of(s.y)) * kSide + bin_of(s.x);
  const float share = cdf[bin] - (bin ? cdf[bin - 1] : 0);
  const float size = length(d) / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  return share * kBins * size * size * size / 4;
}

void SkyGuide::learn(const std::vector<Sighting>& sightings) { waiting_.insert(waiting_.end(), sightings.begin(), sightings.end()); }

uint64_t SkyGuide::key(int level, const Vec3& x, const Vec3& n) const {
  const float edge = edge_ * std::pow(kCoarser, static_cast<float>(level));
  const auto along = [&](float at, float low) {
    const float cells = (at - low) / edge;
    return cells >= 0 ? 1 + static_cast<uint64_t>(std::min(cells, 65000.0f)) : uint64_t{0};
  };
  uint64_t side = 6;  // the axis that the normal lies nearest to
  if (length2(n) > 0) {
    const float ax = std::abs(n.x), ay = std::abs(n.y), az = std::abs(n.z);
    side = ax >= ay && ax >= az ? (n.x < 0) : ay >= az ? 2 + (n.y < 0) : 4 + (n.z < 0);
  }
  return along(x.x, low_.x) | along(x.y, low_.y) << 16 | along(x.z, low_.z) << 32 | side << 48 | static_cast<uint64_t>(level) << 56;
}

void SkyGuide::add(Cell& cell, const Sighting& s) const {
  cell.rays += s.ray;
  if (!(s.weight > 0)) return;
  cell.seen += s.ray;
  ++cell.found;
  if (cell.sums.empty()) cell.sums.assign(kBins, 0.0f);
  const Vec2 at = to_square(s.direction);
  const int x = bin_of(at.x), y = bin_of(at.y);
  const auto give = [&](int column, int row, float share) {
    cell.sums[std::clamp(row, 0, kSide - 1) * kSide + std::clamp(column, 0, kSide - 1)] += s.weight * share;
  };
  give(x, y, kOwn);
  for (const int step : {-1, 1}) {
    give(x + step, y, (1 - kOwn) / 4);
    give(x, y + step, (1 - kOwn) / 4);
  }
}

void SkyGuide::end_pass() {
  if (!learning()) return;
  ++passes_;
  if (edge_ <= 0 && !waiting_.empty()) {  // cells fit what the first pass has seen; what lies outside shares the outermost ones
    low_ = waiting_.front().x;
    Vec3 high = low_;
    for (const Sighting& s : waiting_) {
      low_ = {std::min(low_.x, s.x.x), std::min(low_.y, s.x.y), std::min(low_.z, s.x.z)};
      high = {std::max(high.x, s.x.x), std::max(high.y, s.x.y), std::max(high.z, s.x.z)};
    }
    edge_ = std::max(max_abs(high - low_) / kCells, 1e-30f);
  }
  for (const Sighting& s : waiting_)
    for (int level = 0; level < kLevels; ++level) add(cells_[key(level, s.x, s.n)], s);
  waiting_.clear();
  for (auto& [_, cell] : cells_) {
    double total = 0;
    for (const float sum : cell.sums) total += sum;
    cell.useful = cell.found >= kEnough && total > 0 && static_cast<float>(cell.seen) < kFree * static_cast<float>(cell.rays);
    if (!cell.useful) continue;
    cell.cdf.resize(kBins);
    double sum = 0;
    for (int i = 0; i < kBins; ++i) cell.cdf[i] = static_cast<float>((sum += cell.sums[i]) / total);
  }
}

const SkyGuide::Cell* SkyGuide::find(const Vec3& x, const Vec3& n) const {
  if (edge_ <= 0) return nullptr;
  for (int level = 0; level < kLevels; ++level) {
    const auto at = cells_.find(key(level, x, n));
    if (at == cells_.end()) continue;
    if (at->second.useful) return &at->second;
    if (at->second.found >= kEnough) return nullptr;
  }
  return nullptr;
}

}  // namespace photon_splat
