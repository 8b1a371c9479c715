#include "integrators/light_cache.h"

#include "math/sampling.h"

namespace photon_splat {
namespace {

constexpr float kEnough = 32;  // samples for which no wider cells are asked
constexpr float kMost = 128;   // that a cell remembers, about
// Cells are of so many widths, each by 2^kWider
constexpr int kWidths = 3;
constexpr int32_t kWider = 2;
// So much of the variance among a wider cell's samples passes for that of one within it: few
// samples tell little of their own, rare bright ones least of all
constexpr float kOfWider = 0.25f;
constexpr int32_t kSlab = 2;      // a slab is so many levels wider than its cells
constexpr uint32_t kRecent = 64;  // pictures
constexpr float kDark = 0.02f;    // a colour of an albedo, over its brightest: it tells nothing

int32_t cell_index(double x) {  // NaN too has one
  constexpr double kFar = 1e15;
  return static_cast<int32_t>(
      static_cast<int64_t>(x > -kFar ? std::floor(std::min(x, kFar)) : -kFar));
}

// Of the way to the next cell.
float beyond(double x) {
  const double part = x - std::floor(x);
  return part >= 0 ? static_cast<float>(part) : 0;
}

Rgb divided_by_albedo(const Rgb& light, const Rgb& albedo) {
  const float least = kDark * max_component(albedo);
  const auto known = [&](float of) { return of > least; };
  const Rgb ratio{known(albedo.x) ? light.x / albedo.x : 0,
                  known(albedo.y) ? light.y / albedo.y : 0,
                  known(albedo.z) ? light.z / albedo.z : 0};
  const int count = known(albedo.x) + known(albedo.y) + known(albedo.z);
  const float mean = count ? (ratio.x + ratio.y + ratio.z) / static_cast<float>(count) : 0;
  return {known(albedo.x) ? ratio.x : mean, known(albedo.y) ? ratio.y : mean,
          known(albedo.z) ? ratio.z : mean};
}

}  // namespace

CacheLight light_over_albedo(const CacheLight& light, const CacheLight& albedo) {
  return {divided_by_albedo(light.diffuse, albedo.diffuse),
          divided_by_albedo(light.reflected, albedo.reflected)};
}

LightCache::Place LightCache::place(uint32_t key, const Vec3& position, const Vec3& normal,
                                    float width) {
  const Vec3 n = absolute(normal);
  const int axis = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
  Place out;
  out.surface = hash64(uint64_t{key} << 3 | static_cast<uint64_t>(axis) << 1 | (normal[axis] < 0));
  const float wide = width > 0 ? std::clamp(width, 1e-30f, 1e30f) : 1e-30f;
  out.level = static_cast<int32_t>(std::lround(std::log2(wide)));
  const double inverse = std::ldexp(1.0, -out.level);
  out.slab = cell_index(position[axis] * std::ldexp(inverse, -kSlab));
  const double u = position[axis == 0 ? 1 : 0] * inverse - 0.5,
               v = position[axis == 2 ? 1 : 2] * inverse - 0.5;
  out.u = cell_index(u);
  out.v = cell_index(v);
  out.fu = beyond(u);
  out.fv = beyond(v);
  return out;
}

void LightCache::set_mirror(Place& place, const Vec3& direction, int32_t directions) {
  const auto [u, v] = octahedral(direction);
  place.mirror_u = saturate(0.5f * (u + 1));
  place.mirror_v = saturate(0.5f * (v + 1));
  place.directions = directions;
}

LightCache::Place LightCache::wider(const Place& place) {
  constexpr float kShare = 1.0f / (1 << kWider);
  Place out = place;
  out.level += kWider;
  out.slab >>= kWider;
  const auto widen = [](int32_t& index, float& f) {
    const double x = (static_cast<double>(index) + f + 0.5) * kShare - 0.5;
    index = cell_index(x);
    f = beyond(x);
  };
  widen(out.u, out.fu);
  widen(out.v, out.fv);
  out.directions = (place.directions + 1) / 2;
  return out;
}

uint64_t LightCache::key_of(const Place& place, int32_t u, int32_t v, Kind kind) {
  uint64_t hash =
      hash64(place.surface ^ (static_cast<uint64_t>(static_cast<uint32_t>(place.level)) << 32 |
                              static_cast<uint32_t>(place.slab)));
  hash = hash64(hash ^
                (static_cast<uint64_t>(static_cast<uint32_t>(u)) << 32 | static_cast<uint32_t>(v)));
  if (kind == Kind::kDiffuse) return hash;
  // Steps of each cell begin elsewhere, so that they do not all change over at once.
  const auto step = [&](float x, uint64_t random) {
    return static_cast<uint64_t>(x * static_cast<float>(place.directions) +
                                 static_cast<float>(random & 0xffff) * (1 / 65536.0f));
  };
  return hash64(hash + 1 + (step(place.mirror_u, hash) << 16 | step(place.mirror_v, hash >> 16)) +
                (static_cast<uint64_t>(place.directions) << 40));
}

uint64_t LightCache::key_of(const Place& place, Kind kind) {
  return key_of(place, place.u + (place.fu >= 0.5f), place.v + (place.fv >= 0.5f), kind);
}

float LightCache::samples(const Place& place, Kind kind) const {
  const Cell* cell = cells_.find(key_of(place, kind));
  return cell ? cell->count : 0;
}

LightCache::Estimate LightCache::around(const Place& place, Kind kind) const {
  Estimate out;
  float weights = 0, squares = 0;
  for (int i = 0; i < 4; ++i) {
    const int du = i & 1, dv = i >> 1;
    const float near = (du ? place.fu : 1 - place.fu) * (dv ? place.fv : 1 - place.fv);
    const Cell* cell = cells_.find(key_of(place, place.u + du, place.v + dv, kind));
    if (!cell) continue;
    const float weight = near * std::min(cell->count, kEnough), share = weight / cell->count;
    out.light += cell->light * share;
    squares += cell->squares * share;
    out.samples += near * cell->count;
    weights += weight;
  }
  if (!(weights > 0)) return {};
  out.light *= 1 / weights;
  out.variance = std::max(squares / weights - sqr(luminance(out.light)), 0.0f);
  return out;
}

// Of cells of that width, 0 the place's own, and wider ones.
LightCache::Estimate LightCache::estimate(const Place& place, Kind kind, int width) const {
  Estimate here = around(place, kind);
  if (here.samples >= kEnough || width + 1 == kWidths) return here;
  const Estimate wide = estimate(wider(place), kind, width + 1);
  if (!(here.samples > 0)) return wide;
  const float noise = (here.variance + kOfWider * wide.variance) / here.samples,
              difference = sqr(luminance(here.light) - luminance(wide.light));
  if (noise > 0) here.light += (wide.light - here.light) * (noise / std::max(noise, difference));
  return here;
}

bool LightCache::knows(const Place& place, Kind kind) const {
  return estimate(place, kind, 0).samples > 0;
}

Rgb LightCache::light(const Place& place, Kind kind) const {
  return estimate(place, kind, 0).light;
}

void LightCache::add_to(uint64_t key, const Rgb& light, float samples) {
  Cell& cell = cells_[key];
  if (cell.count >= kMost) {  // older samples fade
    cell.light *= 0.5f;
    cell.squares *= 0.5f;
    cell.count *= 0.5f;
  }
  cell.light += light * samples;
  cell.squares += sqr(luminance(light)) * samples;
  cell.count += samples;
  cell.picture = picture_;
}

void LightCache::add(const Place& place, Kind kind, const Rgb& light, float samples) {
  Place at = place;
  for (int wide = 0; wide < kWidths; ++wide) {
    if (wide) at = wider(at);
    add_to(key_of(at, kind), light, std::min(samples, kMost));
  }
}

void LightCache::begin_picture() {
  ++picture_;
  for (uint32_t recent = kRecent; cells_.size() > most_cells_ && recent > 0; recent /= 2)
    cells_.keep_if([&](const Cell& cell) { return picture_ - cell.picture <= recent; });
}

}  // namespace photon_splat
