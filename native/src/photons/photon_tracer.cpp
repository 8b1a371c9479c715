#include "photons/photon_tracer.h"

#include <bit>

#include "math/random_streams.h"
#include "photons/caustic_targets.h"
#include "photons/seen_places.h"
#include "simd/dispatch.h"

namespace photon_splat {
namespace {

constexpr uint64_t kPathsPerChunk = PhotonPaths::kMost;  // their state stays in the cache
constexpr uint32_t kStartsAtOnce = SobolPair::kMost;
constexpr double kMorePhotons = 1.1;  // memory is kept for, than the last paths have left
// Share of useful paths from which on emission stays unguided
constexpr double kUsefulShare = 0.3;
constexpr uint64_t kPilotsMore = 3;  // after the first, for emission that is guided
// Share of useful caustic paths below which targets are cut finer
constexpr double kFewArrive = 0.003;

Scene::Rays rays_of(const PhotonPaths& paths, uint32_t first, bool moves, bool strands) {
  return {paths.origin_x + first,
          paths.origin_y + first,
          paths.origin_z + first,
          paths.direction_x + first,
          paths.direction_y + first,
          paths.direction_z + first,
          nullptr,
          moves ? paths.time + first : nullptr,
          strands ? paths.left + first : nullptr};
}

}  // namespace

BounceKernel choose_bounce_kernel(const std::string& name) {
  return choose_variant<BounceKernel>(PHOTON_SPLAT_VARIANTS(bounce), name);
}

PhotonTracer::Path PhotonTracer::Travellers::take(uint32_t i) const {
  Path path;
  static_cast<Rest&>(path) = rest[i];
  path.power = {paths.red[i], paths.green[i], paths.blue[i]};
  path.reference = paths.reference[i];
  path.random = Random::at(paths.random[i]);
  path.bounces = static_cast<uint16_t>(paths.bounces[i]);
  path.caustic = paths.caustic[i];
  return path;
}

// Bits of those `count` from `begin` on that media are around.
unsigned PhotonTracer::Travellers::in_media(uint32_t begin, uint32_t count) const {
  unsigned bits = 0;
  for (uint32_t k = 0; k < count; ++k)
    bits |= static_cast<unsigned>(!rest[begin + k].media.empty()) << k;
  return bits;
}

void PhotonTracer::Travellers::put(uint32_t i, const Path& path, const Vec3& origin,
                                   const Vec3& direction, bool alone) {
  rest[i] = path;
  paths.red[i] = path.power.x, paths.green[i] = path.power.y, paths.blue[i] = path.power.z;
  paths.reference[i] = path.reference;
  paths.random[i] = path.random.state();
  paths.bounces[i] = path.bounces;
  paths.caustic[i] = path.caustic;
  paths.alone[i] = alone;
  paths.time[i] = path.time;
  paths.left[i] = path.left;
  paths.origin_x[i] = origin.x, paths.origin_y[i] = origin.y, paths.origin_z[i] = origin.z;
  paths.direction_x[i] = direction.x, paths.direction_y[i] = direction.y,
  paths.direction_z[i] = direction.z;
}

PhotonStart PhotonTracer::start(uint64_t index, uint32_t seed) const {
  if (targets_) return emitter_.emit_towards(*targets_, index, seed);
  return emitter_.emit(emitter_.primary(index, seed, guide_ ? &*guide_ : nullptr));
}

void PhotonTracer::start(uint64_t first, uint32_t count, uint32_t seed, PhotonStart* starts) const {
  if (targets_) {
    for (uint32_t i = 0; i < count; ++i) starts[i] = start(first + i, seed);
    return;
  }
  EmissionPrimary primaries[kStartsAtOnce];
  emitter_.primaries(first, count, seed, guide_ ? &*guide_ : nullptr, primaries);
  emitter_.emit(primaries, count, starts);
}

unsigned PhotonTracer::seen_by_all(const RayHits& hits, unsigned which) const {
  for (unsigned rest = which; rest; rest &= rest - 1) {
    const uint32_t k = static_cast<uint32_t>(std::countr_zero(rest));
    if (scene_.instances[hits.instance[k]].seen_by != kAllRays) which &= ~(1u << k);
  }
  return which;
}

// How many of a chunk's paths carry anything.
uint32_t PhotonTracer::start_all(uint64_t first, uint32_t count, double total, uint32_t seed,
                                 Travellers& travellers) const {
  auto& [starts, paths, rest, more] = travellers;
  more.clear();
  starts.resize(count);
  const SobolPair first_bounce = photon_numbers(PhotonDimension::kFirstBounce, seed);
  const bool guesses_first = scene_.first_kinds_differ();
  uint32_t n = 0;
  for (uint32_t begin = 0; begin < count; begin += kStartsAtOnce) {
    const uint32_t end = std::min(begin + kStartsAtOnce, count);
    start(first + begin, end - begin, seed, &starts[begin]);
    SobolPair::Run ways;
    first_bounce.fill(static_cast<uint32_t>(first + begin), end - begin, ways);
    for (uint32_t place = begin; place < end; ++place) {
      PhotonStart& from = starts[place];
      Path path;
      path.power = from.power * static_cast<float>(1.0 / total);
      path.reference = max_component(path.power);
      path.random = Random(first + place, seed);
      path.place = place;
      path.time = from.time;
      if (!(path.reference > 0) || !std::isfinite(path.reference)) continue;
      if (scene_.media() && !start_in_media(path, from)) continue;
      paths.first_u[n] = ways.x[place - begin], paths.first_v[n] = ways.y[place - begin];
      if (from.shares_with_rays) {
        from.by_rays = path.random.next() < 0.5f;
        path.power *= 2;
      }
      if (guesses_first || from.by_rays) {
        float chance;
        path.kind =
            guess_kind(path.random, from.by_rays ? RayInfo::kDiffuse : RayInfo::kShadow, &chance);
        path.guessed = true;
        path.power *= 1 / chance;
      }
      travellers.put(n++, path, from.origin, from.direction, !from.plain() || path.guessed);
    }
  }
  return n;
}

void PhotonTracer::keep_bounced(Travellers& travellers, uint32_t from, uint32_t to,
                                const Bounced& bounced, uint32_t k) const {
  PhotonPaths& paths = travellers.paths;
  paths.origin_x[to] = bounced.origin_x[k], paths.origin_y[to] = bounced.origin_y[k],
  paths.origin_z[to] = bounced.origin_z[k];
  paths.direction_x[to] = bounced.direction_x[k], paths.direction_y[to] = bounced.direction_y[k],
  paths.direction_z[to] = bounced.direction_z[k];
  paths.red[to] = bounced.red[k], paths.green[to] = bounced.green[k],
  paths.blue[to] = bounced.blue[k];
  paths.reference[to] = paths.reference[from];
  paths.caustic[to] = 0;
  paths.random[to] = bounced.random[k];
  paths.bounces[to] = paths.bounces[from] + 1;
  paths.alone[to] = 0;
  paths.time[to] = paths.time[from];
  paths.left[to] = 0;
  travellers.rest[to] = travellers.rest[from];
}

bool PhotonTracer::Usefulness::counts(const Photon& photon) const {
  return (!filter || filter->contains(photon.key)) &&
         (!places || places->contains(photon.key, photon.position));
}

float PhotonTracer::use_of(const Photon& photon, const PhotonStart& start, double total) const {
  if (stream_ != PhotonStream::kCaustic) {
    const float share = average(start.power) / static_cast<float>(lights_.total_power());
    return std::isfinite(share) ? share * share : 0;
  }
  const float own = luminance(start.power) * static_cast<float>(1 / total),
              share = own > 0 ? luminance(photon.power) / own : 0;
  return std::isfinite(share) ? share * share : 0;
}

// Use of a beam: the square of the power that a medium scatters of its path.
float PhotonTracer::use_of(const PhotonBeam& beam, const PhotonStart& start, double total) const {
  const float own = luminance(start.power) * static_cast<float>(1 / total);
  float share = own > 0 ? luminance(beam.power) / own : 0;
  if (const auto medium = scene_.media()->homogeneous(beam.media))
    share *= -std::expm1(-average(medium->scattering) * beam.length);
  return std::isfinite(share) ? share * share : 0;
}

// The flight of path i through media to the next surface, if there is one.
void PhotonTracer::leave_beam(const Travellers& travellers, uint32_t i, const Surface* hit,
                              double total, float* useful, std::vector<PhotonBeam>& beams) const {
  const PhotonPaths& paths = travellers.paths;
  const Rest& rest = travellers.rest[i];
  if (paths.bounces[i] == 0 || rest.media.empty()) return;
  if (rest.guessed && rest.kind != receiver_kind_) return;
  const Rgb power = Rgb{paths.red[i], paths.green[i], paths.blue[i]} * share_of(paths.caustic[i]);
  if (!(max_abs(power) > 0) || !is_finite(power)) return;
  if (beams_ == BeamLight::kIndirect && !scene_.media()->homogeneous(rest.media)) return;
  const Vec3 direction{paths.direction_x[i], paths.direction_y[i], paths.direction_z[i]};
  const PhotonStart& start = travellers.starts[rest.place];
  beams.push_back({{paths.origin_x[i], paths.origin_y[i], paths.origin_z[i]},
                   direction,
                   hit ? hit->distance : INFINITY,
                   power,
                   rest.media,
                   rest.left_normal,
                   encode_direction(hit ? hit->ng : -direction),
                   start.light_group,
                   rest.time});
  if (useful) useful[rest.place] += use_of(beams.back(), start, total);
}

// All paths of a chunk advance by one ray at a time.
void PhotonTracer::trace_chunk(uint64_t first, uint64_t count, double total, uint32_t seed,
                               const SurfaceFilter& visible, const Usefulness* filter,
                               float* useful, Travellers& travellers, PhotonRun& run) const {
  uint32_t alive = start_all(first, static_cast<uint32_t>(count), total, seed, travellers);
  PhotonPaths& paths = travellers.paths;
  const SobolPair first_bounce = photon_numbers(PhotonDimension::kFirstBounce, seed);
  const BounceSettings settings{stream_ == PhotonStream::kCaustic ? 0.0f : 1.0f,
                                stream_ == PhotonStream::kAll       ? 0.0f
                                : stream_ == PhotonStream::kCaustic ? 1.0f
                                                                    : -1.0f,
                                static_cast<uint32_t>(max_bounces_)};
  // Two of each: while one is worked on, memory for the other is fetched
  RayHits found[2];
  unsigned hit[2] = {};
  PlainSurfaces surfaces;
  Bounced bounced;
  const bool limited = scene_.limits_rays(), guesses = scene_.kinds_differ(),
             moves = scene_.moves(), in_media = scatters_in_media(),
             leaves_beams = beams_ != BeamLight::kNone;
  while (alive) {
    run.rays += alive;
    uint32_t kept = 0;
    for (uint32_t next = 0, turn = 0; next < alive + kBounceLanes;
         next += kBounceLanes, turn ^= 1) {
      if (next < alive) {
        const Scene::Rays rays = rays_of(paths, next, moves, scene_.has_strands());
        const uint32_t lanes = std::min(kBounceLanes, alive - next);
        hit[turn] = scene_.intersect(rays, lanes, found[turn]);
      }
      if (next == 0) continue;
      const uint32_t begin = next - kBounceLanes;
      const RayHits& hits = found[turn ^ 1];
      unsigned together = hit[turn ^ 1];
      uint32_t any_alone = 0;
      for (uint32_t k = 0; k < kBounceLanes; ++k) any_alone |= paths.alone[begin + k];
      for (uint32_t k = 0; any_alone && k < kBounceLanes; ++k)
        together &= ~(paths.alone[begin + k] << k);
      if (limited) together = guesses ? 0 : seen_by_all(hits, together);
      if (scene_.media()) together = 0;
      if (moves) together = scene_.still(hits, together);
      together = scene_.plain_surfaces(hits, together, surfaces);
      if (together) bounce_(paths, begin, hits, surfaces, settings, bounced);
      if (stream_ == PhotonStream::kCaustic) bounced.goes_on = 0;
      const unsigned met = hit[turn ^ 1];
      if (leaves_beams)  // of light that meets nothing more
        for (uint32_t k = 0; k < std::min(kBounceLanes, alive - begin); ++k)
          if (!(met >> k & 1) && paths.bounces[begin + k] > 0)
            leave_beam(travellers, begin + k, nullptr, total, useful, run.beams);
      // What meets nothing may scatter all the same.
      const unsigned awake =
          in_media ? met | travellers.in_media(begin, std::min(kBounceLanes, alive - begin)) : met;
      for (unsigned rest = awake; rest; rest &= rest - 1) {
        const uint32_t k = static_cast<uint32_t>(std::countr_zero(rest)), i = begin + k,
                       place = travellers.rest[i].place;
        const size_t stored = run.photons.size();
        if (together >> k & 1) {
          if (bounced.stores >> k & 1 && visible.contains(surfaces.key[k]))
            run.photons.push_back(
                {{hits.x[k], hits.y[k], hits.z[k]},
                 surfaces.key[k],
                 static_cast<uint16_t>(bounced.directions[k]),
                 static_cast<uint16_t>(bounced.directions[k] >> 16),
                 {bounced.stored_red[k], bounced.stored_green[k], bounced.stored_blue[k]}});
          // In vain where it ends, which a branch could not foresee
          keep_bounced(travellers, i, kept, bounced, k);
          kept += bounced.goes_on >> k & 1;
        } else {
          Path path = travellers.take(i);
          Vec3 direction{paths.direction_x[i], paths.direction_y[i], paths.direction_z[i]};
          Vec3 origin{paths.origin_x[i], paths.origin_y[i], paths.origin_z[i]};
          Surface surface;
          surface.distance = INFINITY;
          const bool there = met >> k & 1;
          if (there) surface = scene_.surface_of(hits, k, direction, path.time);
          if (there && scene_.media())
            scene_.media()->meet_touched(surface, origin, direction, kAllRays, path.time);
          if (leaves_beams && there) leave_beam(travellers, i, &surface, total, useful, run.beams);
          const Draws draws{first_bounce, static_cast<uint32_t>(first + place)};
          if (scene_.media()) {
            const InMedium way = pass_media(path, surface.distance, travellers.starts[place], draws,
                                            origin, direction);
            if (way == InMedium::kScattered) travellers.put(kept++, path, origin, direction, true);
            if (way != InMedium::kPasses || !there) continue;
          }
          run.shaded += surface.program != nullptr;
          if (leaves_beams) path.left_normal = encode_direction(surface.ng);
          const PhotonStart& start = travellers.starts[place];
          // Those before this one that are left, it, those after it, and those that wait
          const size_t all = kept + (alive - i) + travellers.more.size();
          for (uint32_t ways = split(path, surface, kPathsPerChunk - all + 1); ways > 1; --ways) {
            Travellers::Waiting way{path, origin, direction};
            way.path.random = Random(path.random.state(), ways);
            if (shade(way.path, surface, start, draws, visible, way.origin, way.direction,
                      run.photons))
              travellers.more.push_back(way);
          }
          if (shade(path, surface, start, draws, visible, origin, direction, run.photons))
            travellers.put(kept++, path, origin, direction, goes_alone(path, start));
        }
        if (useful)
          for (size_t p = stored; p < run.photons.size(); ++p)
            if (filter->counts(run.photons[p]))
              useful[place] += use_of(run.photons[p], travellers.starts[place], total);
        if (keeps_groups_)
          run.groups.resize(run.photons.size(), travellers.starts[place].light_group);
      }
    }
    for (const Travellers::Waiting& one : travellers.more)
      travellers.put(kept++, one.path, one.origin, one.direction,
                     goes_alone(one.path, travellers.starts[one.path.place]));
    travellers.more.clear();
    alive = kept;
  }
}

const Photons& PhotonTracer::trace(uint64_t first, uint64_t count, double total, uint32_t seed,
                                   const SurfaceFilter& visible, const CancelFlag& cancel) {
  return trace(first, count, total, seed, visible, cancel, nullptr);
}

const Photons& PhotonTracer::trace(uint64_t first, uint64_t count, double total, uint32_t seed,
                                   const SurfaceFilter& visible, const CancelFlag& cancel,
                                   Usefulness* useful) {
  join_.clear();
  if (useful) useful->of_path.assign(count, 0);
  if (lights_.total_power() <= 0 || max_bounces_ < 1) return join_.photons();
  const size_t chunk_count = (count + kPathsPerChunk - 1) / kPathsPerChunk;
  travellers_.resize(scene_.pool().size());
  const double per_path = last_counts_.traced ? static_cast<double>(last_counts_.stored) /
                                                    static_cast<double>(last_counts_.traced)
                                              : 0;
  join_.begin(chunk_count,
              static_cast<size_t>(per_path * kMorePhotons * static_cast<double>(count)),
              keeps_groups_);
  try {
    scene_.pool().for_each(chunk_count, cancel, [&](size_t c, int worker) {
      const uint64_t begin = c * kPathsPerChunk;
      std::unique_ptr<PhotonRun> run = join_.take();
      trace_chunk(first + begin, std::min(kPathsPerChunk, count - begin), total, seed, visible,
                  useful, useful ? &useful->of_path[begin] : nullptr, travellers_[worker], *run);
      join_.add(c, std::move(run));
    });
    join_.finish(scene_.pool(), cancel);
  } catch (...) {
    join_.clear();
    throw;
  }
  last_counts_ = {count, beams_ != BeamLight::kNone ? join_.beams().size() : join_.photons().size(),
                  join_.rays(), join_.shaded()};
  counts_ = {counts_.traced + count, counts_.stored + last_counts_.stored,
             counts_.rays + last_counts_.rays, counts_.shaded + last_counts_.shaded};
  return join_.photons();
}

// Of paths that leave photons those that do; of those that leave beams, which are long or short,
// how many as useful as each other would do as well.
double PhotonTracer::useful_share(std::span<const float> use) const {
  double sum = 0, squares = 0;
  for (const float u : use) {
    sum += beams_ == BeamLight::kNone ? u > 0 : std::sqrt(static_cast<double>(u));
    squares += beams_ == BeamLight::kNone ? u > 0 : u;
  }
  return squares > 0 ? sum * sum / (squares * static_cast<double>(use.size())) : 0;
}

double PhotonTracer::aim(std::vector<EmissionTargets::Sphere> spheres, uint64_t paths,
                         uint32_t seed, const SurfaceFilter& visible, const SeenPlaces* places,
                         const CancelFlag& cancel) {
  targets_ = emitter_.aim_at(std::move(spheres));
  Usefulness useful{nullptr, places, {}};
  trace(0, paths, static_cast<double>(paths), seed, visible, cancel, &useful);
  for (uint64_t i = 0; i < paths; ++i) emitter_.learn(*targets_, i, seed, useful.of_path[i]);
  targets_->finish();
  return useful_share(useful.of_path);
}

// Of paths from `first` on, which `drawn_by` has chosen.
void PhotonTracer::teach(EmissionGuide& guide, const EmissionGuide* drawn_by, uint64_t first,
                         uint32_t seed, std::span<const float> useful) const {
  EmissionPrimary primaries[kStartsAtOnce];
  for (size_t begin = 0; begin < useful.size(); begin += kStartsAtOnce) {
    const uint32_t count =
        static_cast<uint32_t>(std::min<size_t>(kStartsAtOnce, useful.size() - begin));
    emitter_.primaries(first + begin, count, seed, drawn_by, primaries);
    for (uint32_t k = 0; k < count; ++k) guide.learn(primaries[k], useful[begin + k]);
  }
  guide.finish();
}

const Photons* PhotonTracer::learn_emission(uint64_t paths, uint32_t seed,
                                            const SurfaceFilter& visible,
                                            const SurfaceFilter& stored, const SeenPlaces* places,
                                            const CancelFlag& cancel) {
  guide_.reset();
  targets_.reset();
  if (lights_.total_power() <= 0 || max_bounces_ < 1) return nullptr;
  if (stream_ == PhotonStream::kCaustic) {
    const double share = aim(caustic_targets(scene_), paths, seed, visible, places, cancel);
    if (share >= kFewArrive) return nullptr;
    EmissionTargets coarse = std::move(*targets_);
    const EmissionDiscs& discs = lights_.discs();
    const double fine = aim(fine_caustic_targets(scene_, discs.seen_center(), discs.seen_radius()),
                            paths, seed, visible, places, cancel);
    if (fine < share) targets_ = std::move(coarse);
    return nullptr;
  }
  Usefulness useful{&visible, places, {}};
  const Photons& photons =
      trace(0, paths, static_cast<double>(paths), seed, stored, cancel, &useful);
  const double share = useful_share(useful.of_path);
  if (share > kUsefulShare || share == 0) return &photons;
  EmissionGuide guide = emitter_.make_guide();
  teach(guide, nullptr, 0, seed, useful.of_path);
  guide_ = std::move(guide);
  // Where few were of use, those of further pilots tell more
  for (uint64_t first = paths; first <= kPilotsMore * paths; first += paths) {
    trace(first, paths, static_cast<double>(paths), seed, stored, cancel, &useful);
    teach(*guide_, &*guide_, first, seed, useful.of_path);
  }
  return nullptr;
}

}  // namespace photon_splat
