// The tiles of a pass: which are traced when, what they tell, and how their gather points come
// together.
#include "integrators/camera_tracer.h"

namespace photon_splat {
namespace {

constexpr size_t kFewTiles = 256;             // all of them are scouts
constexpr uint32_t kLearningPaths = 1 << 16;  // at most about so many of a pass

// Scouts: one tile in so many of a row, in the next row so many on
struct Pattern {
  size_t every, shift;
};
constexpr Pattern kPatterns[] = {{8, 3}, {16, 7}, {32, 13}, {64, 23}};

size_t tiles_along(int pixels) { return static_cast<size_t>((pixels + kTileSize - 1) / kTileSize); }

// The thinnest with about kFewTiles / 2 scouts or more: what they tell does not grow with the
// picture.
const Pattern& pattern_of(size_t tiles) {
  size_t i = 0;
  while (i + 1 < std::size(kPatterns) && tiles >= kFewTiles / 2 * kPatterns[i + 1].every) ++i;
  return kPatterns[i];
}

// The place in the picture alone decides.
bool is_scout(const Pattern& pattern, size_t tile, size_t across) {
  return (tile % across + pattern.shift * (tile / across)) % pattern.every == 0;
}

}  // namespace

bool CameraTracer::scouts(const PackedFilm& film, size_t tile) {
  return is_scout(pattern_of(film.tiles()), tile, tiles_along(film.width));
}

bool CameraTracer::sends_scouts(const PackedFilm& film) {
  return tiles_along(film.width) * tiles_along(film.height) >= kFewTiles;
}

void CameraTracer::Tile::clear() {
  rays = bad_samples = places = continued = deep_rays = 0;
  trial = {};
  deep.clear();
  near = {};
  again = false;
  readings.clear();
  cache_samples.clear();
  cache_samples_wanted = 0;
}

void CameraTracer::trace_tiles(const Job& job, PackedFilm& film, const CancelFlag& cancel) {
  const size_t across = tiles_along(film.width);
  const bool scouts = job.tiles == Tiles::kScouts, rest = job.tiles == Tiles::kRest;
  tiles_.resize(across * tiles_along(film.height));
  const Pattern& pattern = pattern_of(tiles_.size());
  scene_.pool().for_each(tiles_.size(), cancel, [&](size_t t, int) {
    Tile& tile = tiles_[t];
    const bool scout = (scouts || rest) && is_scout(pattern, t, across);
    tile.clear();
    if (scouts && !scout) {
      tile.gather_points.clear();
      return;
    }
    if (job.tiles == Tiles::kAgain || (rest && scout)) {
      tile.again = find_changed(tile);
      if (!tile.again) return;
    } else {
      tile.sightings.clear();
    }
    trace_tile(job, t, film);
  });
  if (job.tiles == Tiles::kAll || scouts) last_rays_ = 0;
  last_continued_ = 0;
  for (const Tile& tile : tiles_) {
    last_rays_ += tile.rays;
    rays_ += tile.rays;
    bad_samples_ += tile.bad_samples;
    places_ += tile.places;
    last_continued_ += tile.continued;
  }
  continued_ += last_continued_;
}

void CameraTracer::trace_tile(const Job& job, size_t t, PackedFilm& film) {
  Tile& tile = tiles_[t];
  tile.gather_points.clear();
  tile.gather_points.reserve(kTileSize * kTileSize);  // of most
  const size_t across = tiles_along(film.width);
  const int x_begin = static_cast<int>(t % across) * kTileSize,
            y_begin = static_cast<int>(t / across) * kTileSize;
  const int x_end = std::min(x_begin + kTileSize, film.width),
            y_end = std::min(y_begin + kTileSize, film.height);
  tile.variances.clear();
  if (trial_ != Trial::kNone) tile.deep.assign(kTileSize * kTileSize, 0.0f);
  PackedFilm::Tile pixels;
  if (tile.again)
    film.get(t, pixels);
  else
    pixels.fill({});
  size_t next = 0;  // of those kept, which are in the order of pixels
  for (int y = y_begin; y < y_end; ++y)
    for (int x = x_begin; x < x_end; ++x) {
      if (tile.again) {
        const uint32_t pixel = static_cast<uint32_t>(y) * film.width + x;
        const size_t first = next;
        while (next < tile.kept.size() && tile.kept[next].pixel == pixel) ++next;
        if (first == next || !tile.changed[first]) {
          tile.gather_points.insert(tile.gather_points.end(), tile.kept.begin() + first,
                                    tile.kept.begin() + next);
          continue;
        }
      }
      trace_pixel(job, x, y, film,
                  pixels[static_cast<size_t>(y - y_begin) * kTileSize + (x - x_begin)], tile);
    }
  film.put(t, pixels);
  if (trial_ != Trial::kNone) see_trial(tile, pixels, x_end - x_begin, y_end - y_begin);
  tile.kept = std::vector<GatherPoint>();  // once in a render: not worth keeping the memory
  tile.changed = std::vector<uint8_t>();
}

void CameraTracer::see_trial(Tile& tile, const PackedFilm::Tile& pixels, int width, int height) {
  const auto pixel = [&](int x, int y) -> const Pixel& {
    return pixels[static_cast<size_t>(y) * kTileSize + x];
  };
  const auto light = [&](int x, int y) {
    return luminance(pixel(x, y).combined()) * pixel(x, y).share();
  };
  const auto deep = [&](int x, int y) {
    return tile.deep[static_cast<size_t>(y) * kTileSize + x] * pixel(x, y).share();
  };
  double paths = 0, all = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) all += light(x, y);
  tile.trial.begin_tile(all / (static_cast<double>(width) * height));
  for (const auto& [variance, shallow] : tile.variances) tile.trial.add_pixel(variance, shallow);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      paths += pixel(x, y).samples;
      if (x > 0) tile.trial.add_pair(light(x, y), deep(x, y), light(x - 1, y), deep(x - 1, y));
      if (y > 0) tile.trial.add_pair(light(x, y), deep(x, y), light(x, y - 1), deep(x, y - 1));
    }
  tile.trial.add_rays(static_cast<uint64_t>(paths), tile.rays, tile.deep_rays);
}

GatherTrial CameraTracer::trial() const {
  GatherTrial sum;
  for (const Tile& tile : tiles_) sum.add(tile.trial);
  return sum;
}

// Whether paths go on by now at gather points of a tile, and at those of which pixels.
bool CameraTracer::find_changed(Tile& tile) const {
  tile.changed.assign(tile.gather_points.size(), 0);
  bool any = false;
  for (size_t first = 0, end; first < tile.gather_points.size(); first = end) {
    bool changed = false;
    for (end = first; end < tile.gather_points.size() &&
                      tile.gather_points[end].pixel == tile.gather_points[first].pixel;
         ++end) {
      const GatherPoint& r = tile.gather_points[end];
      changed =
          changed || (!r.caustics_only && strategy_->at(r.key, r.position, r.instance, r.triangle,
                                                        radius_factor_, tile.near));
    }
    tile.changed[first] = changed;
    any |= changed;
  }
  if (any) tile.kept.swap(tile.gather_points);
  return any;
}

const GatherPoints& CameraTracer::trace(uint32_t pass, const AdaptiveSampler& choice,
                                        EnvironmentGuide& guide, int max_bounces, PackedFilm& film,
                                        const CancelFlag& cancel, Tiles tiles) {
  const bool learns = guide.learning() && !lights_.environment().black();
  const size_t pixels =
      tiles == Tiles::kScouts ? film.size() / pattern_of(film.tiles()).every : film.size();
  const size_t paths = trial_ == Trial::kDensity ? pixels * choice.count(0) : pixels;
  const auto share = static_cast<uint32_t>(1 + paths / kLearningPaths);
  trace_tiles({pass, &choice, max_bounces, true, tiles, learns, share}, film, cancel);
  if (learns) {
    for (Tile& tile : tiles_) {
      guide.learn(tile.sightings);
      tile.sightings.clear();
    }
    guide.end_pass();
  }
  return join_gather_points(cancel);
}

// Those of all tiles, in the tiles' order.
const GatherPoints& CameraTracer::join_gather_points(const CancelFlag& cancel) {
  ranges_.assign(tiles_.size() + 1, 0);
  for (size_t t = 0; t < tiles_.size(); ++t)
    ranges_[t + 1] = ranges_[t] + tiles_[t].gather_points.size();
  gather_points_.clear();
  gather_points_.resize(ranges_.back());
  scene_.pool().for_each(tiles_.size(), cancel, [&](size_t t, int) {
    std::copy(tiles_[t].gather_points.begin(), tiles_[t].gather_points.end(),
              gather_points_.begin() + ranges_[t]);
  });
  return gather_points_;
}

void CameraTracer::trace_reference(uint32_t sample, int max_bounces, PackedFilm& film,
                                   const CancelFlag& cancel) {
  trace_tiles({sample, nullptr, max_bounces, false}, film, cancel);
}

void CameraTracer::forget_gather_points() {
  gather_points_ = {};
  ranges_ = {};
  tiles_ = {};
}

}  // namespace photon_splat
