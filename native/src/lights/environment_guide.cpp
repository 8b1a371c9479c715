#include "lights/environment_guide.h"

#include <algorithm>
#include <bit>

namespace photon_splat {
namespace {

constexpr float kCells = 16;      // along the longest side of what the camera sees
constexpr uint64_t kCoarser = 4;  // from level to level
constexpr uint32_t kEnough = 24;  // sightings of the world before a histogram is believed
// Share of a surface's rays that meet the world from which on their own sampling is good enough
constexpr float kFree = 0.5f;
constexpr float kContrast = 0.3f;  // of a world: from here on a guide helps there, too
// Share of a sighting's weight that goes to its own cell, the rest to the four around it
constexpr float kOwn = 0.5f;
// sightings' worth of what the environment alone would draw
constexpr double kDoubt = 32;

}  // namespace

Environment::Sample EnvironmentGuide::Cell::sample(const Environment& environment,
                                                   const Vec2& u) const {
  constexpr int kSectors = DirectionTable::kSectors;
  const float patches = band_cdf_[DirectionTable::kBands - 1];
  if (u.x >= patches && environment.part_share(Environment::kDiscs) > 0)
    return environment.sample_part(Environment::kDiscs, {within(patches, 1, u.x), u.y});
  const int band = pick(band_cdf_, DirectionTable::kBands, u.x);
  const int part = band * kSectors + pick(cdf_ + band * kSectors, kSectors, u.x);
  return environment.sample_part(part, {within(part ? cdf_[part - 1] : 0, cdf_[part], u.x), u.y});
}

float EnvironmentGuide::Cell::pdf(const Environment& environment,
                                  const Environment::Density& density) const {
  return environment.pdf_by_parts(
      [this](int part) {
        return part == Environment::kDiscs ? 1 - cdf_[part - 1]
                                           : cdf_[part] - (part ? cdf_[part - 1] : 0);
      },
      density);
}

void EnvironmentGuide::learn(const std::vector<Sighting>& sightings) {
  waiting_.insert(waiting_.end(), sightings.begin(), sightings.end());
}

uint64_t EnvironmentGuide::key(int level, const Vec3& x, const Vec3& n) const {
  const auto along = [&](float at, float low) {
    const float cells = (at - low) * scale_[level];
    return cells >= 0 ? 1 + static_cast<uint64_t>(std::min(cells, 65000.0f)) : uint64_t{0};
  };
  uint64_t side = 6;  // the axis that the normal lies nearest to
  if (length2(n) > 0) {
    const float ax = std::abs(n.x), ay = std::abs(n.y), az = std::abs(n.z);
    side = ax >= ay && ax >= az ? (n.x < 0) : ay >= az ? 2 + (n.y < 0) : 4 + (n.z < 0);
  }
  return along(x.x, low_.x) | along(x.y, low_.y) << 16 | along(x.z, low_.z) << 32 | side << 48;
}

uint64_t EnvironmentGuide::parent_of(uint64_t key) {
  const auto along = [&](int shift) {
    const uint64_t cell = key >> shift & 0xffff;
    return (cell ? 1 + (cell - 1) / kCoarser : 0) << shift;
  };
  return along(0) | along(16) | along(32) | key >> 48 << 48;
}

// The coarser cells hold what the finest have found.
void EnvironmentGuide::join_levels() {
  for (int level = 1; level < kLevels; ++level) {
    found_[level].clear();
    for (const auto& [key, cell] : found_[level - 1]) {
      Found& parent = found_[level][parent_of(key)];
      parent.rays += cell.rays;
      parent.seen += cell.seen;
      parent.found += cell.found;
      if (cell.sums.empty()) continue;
      parent.sums.resize(Environment::kParts);
      for (int i = 0; i < Environment::kParts; ++i) parent.sums[i] += cell.sums[i];
    }
  }
}

void EnvironmentGuide::add(Found& cell, const Sighting& s) const {
  cell.rays += s.ray;
  if (!(s.weight > 0)) return;
  cell.seen += s.ray;
  ++cell.found;
  if (cell.sums.empty()) cell.sums.assign(Environment::kParts, 0.0f);
  const int part = environment_->part_of(s.direction);
  if (part == Environment::kDiscs) {
    cell.sums[part] += s.weight;
    return;
  }
  // What is seen beside the sun says nothing of the sun, and what is seen of the sun little of the
  // sky beside it.
  const float share = environment_->part_share(part);
  cell.sums[part] += s.weight * kOwn;
  const auto give = [&](int band, int sector) {
    const int other = std::clamp(band, 0, DirectionTable::kBands - 1) * DirectionTable::kSectors +
                      (sector + DirectionTable::kSectors) % DirectionTable::kSectors;
    const float given = s.weight * (1 - kOwn) / 4,
                kept = share > 0 ? std::min(1.0f, environment_->part_share(other) / share) : 1;
    cell.sums[other] += given * kept;
    cell.sums[part] += given * (1 - kept);
  };
  const int band = part / DirectionTable::kSectors, sector = part % DirectionTable::kSectors;
  for (const int step : {-1, 1}) {
    give(band + step, sector);
    give(band, sector + step);
  }
}

void EnvironmentGuide::end_pass() {
  if (!learning()) return;
  ++passes_;
  // Cells fit what the first pass has seen; what lies outside shares the outermost ones
  if (!(scale_[0] > 0) && !waiting_.empty()) {
    low_ = waiting_.front().x;
    Vec3 high = low_;
    for (const Sighting& s : waiting_) {
      low_ = {std::min(low_.x, s.x.x), std::min(low_.y, s.x.y), std::min(low_.z, s.x.z)};
      high = {std::max(high.x, s.x.x), std::max(high.y, s.x.y), std::max(high.z, s.x.z)};
    }
    float edge = std::max(max_abs(high - low_) / kCells, 1e-30f);
    for (float& scale : scale_) {
      scale = 1 / edge;
      edge *= static_cast<float>(kCoarser);
    }
  }
  for (const Sighting& s : waiting_) add(found_[0][key(0, s.x, s.n)], s);
  waiting_.clear();
  join_levels();
  const bool uneven = environment_->contrast() > kContrast;
  cells_.clear();
  for (int level = kLevels - 1; level >= 0; --level) {
    slots_[level].assign(2 * std::bit_ceil(found_[level].size() + 1), {});
    for (const auto& [key, found] : found_[level]) {
      int32_t cell = believe(found, uneven);
      if (cell == kUnknown && level + 1 < kLevels) cell = look_up(level + 1, parent_of(key));
      if (cell != kUnknown) keep(level, key, cell);
    }
  }
}

int32_t EnvironmentGuide::believe(const Found& cell, bool uneven) {
  if (cell.found < kEnough) return kUnknown;
  double total = 0;
  for (const float sum : cell.sums) total += sum;
  const bool hidden = static_cast<float>(cell.seen) < kFree * static_cast<float>(cell.rays);
  if (!(total > 0) || !(uneven || hidden)) return kNoGuide;
  const double doubt = kDoubt / (kDoubt + cell.found);
  const auto share = [&](int part) {
    return (1 - doubt) * cell.sums[part] / total + doubt * environment_->part_share(part);
  };
  const double discs = share(Environment::kDiscs);
  Cell& made = cells_.emplace_back();
  double sum = 0;
  for (int i = 0; i < DirectionTable::kPatches; ++i) {
    made.cdf_[i] = static_cast<float>(std::min(sum += share(i), 1 - discs));
    made.band_cdf_[i / DirectionTable::kSectors] = made.cdf_[i];
  }
  return static_cast<int32_t>(cells_.size() - 1);
}

void EnvironmentGuide::keep(int level, uint64_t key, int32_t cell) {
  std::vector<Slot>& slots = slots_[level];
  size_t at = hash64(key);
  while (slots[at & (slots.size() - 1)].cell != kUnknown) ++at;
  slots[at & (slots.size() - 1)] = {key, cell};
}

int32_t EnvironmentGuide::look_up(int level, uint64_t key) const {
  const std::vector<Slot>& slots = slots_[level];
  for (size_t at = hash64(key);; ++at) {
    const Slot& slot = slots[at & (slots.size() - 1)];
    if (slot.key == key || slot.cell == kUnknown) return slot.cell;
  }
}

const EnvironmentGuide::Cell* EnvironmentGuide::find(const Vec3& x, const Vec3& n) const {
  if (cells_.empty()) return nullptr;
  for (int level = 0; level < kLevels; ++level)
    if (const int32_t cell = look_up(level, key(level, x, n)); cell != kUnknown)
      return cell >= 0 ? &cells_[cell] : nullptr;
  return nullptr;
}

}  // namespace photon_splat
