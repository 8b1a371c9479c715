// The paths of a chunk on their way: all advance by one ray at a time.
#include <bit>

#include "photons/photon_tracer.h"

namespace photon_splat {
namespace {

constexpr uint32_t kIdleStops = 8;   // of paths that bring nothing any more one is kept
constexpr size_t kPathsPerStop = 2;  // at the most, where all of them do

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

// How many of a chunk's paths carry anything.
uint32_t PhotonTracer::start_all(const Chunk& c) const {
  auto& [starts, paths, rest, more, brought, stops] = c.travellers;
  more.clear();
  stops.clear();
  if (c.useful) brought.assign(c.count, 0);
  starts.resize(c.count);
  const bool guesses_first = scene_.first_kinds_differ();
  uint32_t n = 0;
  for (uint32_t begin = 0; begin < c.count; begin += kStartsAtOnce) {
    const uint32_t end = std::min(begin + kStartsAtOnce, c.count);
    start(c.first + begin, end - begin, c.seed, &starts[begin]);
    SobolPair::Run ways;
    c.first_bounce.fill(static_cast<uint32_t>(c.first + begin), end - begin, ways);
    for (uint32_t place = begin; place < end; ++place) {
      PhotonStart& from = starts[place];
      Path path;
      path.power = from.power * static_cast<float>(1.0 / c.total);
      path.reference = max_component(path.power);
      path.random = Random(c.first + place, c.seed);
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
      c.travellers.put(n++, path, from.origin, from.direction,
                       !from.plain() || path.guessed || heavy(path));
    }
  }
  return n;
}

unsigned PhotonTracer::seen_by_all(const RayHits& hits, unsigned which) const {
  for (unsigned rest = which; rest; rest &= rest - 1) {
    const uint32_t k = static_cast<uint32_t>(std::countr_zero(rest));
    if (scene_.instances[hits.instance[k]].seen_by != kAllRays) which &= ~(1u << k);
  }
  return which;
}

// Of those that meet something the ones on plain surfaces, which bounce together.
unsigned PhotonTracer::bounce_together(const PhotonPaths& paths, uint32_t begin,
                                       const RayHits& hits, unsigned met,
                                       PlainSurfaces& surfaces) const {
  unsigned together = met;
  uint32_t any_alone = 0;
  for (uint32_t k = 0; k < kBounceLanes; ++k) any_alone |= paths.alone[begin + k];
  for (uint32_t k = 0; any_alone && k < kBounceLanes; ++k)
    together &= ~(paths.alone[begin + k] << k);
  if (scene_.limits_rays()) together = scene_.kinds_differ() ? 0 : seen_by_all(hits, together);
  if (scene_.media()) together = 0;
  if (scene_.moves()) together = scene_.still(hits, together);
  return scene_.plain_surfaces(hits, together, surfaces);
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

// The flight of path i through media to the next surface, if there is one.
void PhotonTracer::leave_beam(Chunk& c, uint32_t i, const Surface* hit) const {
  const PhotonPaths& paths = c.travellers.paths;
  const Rest& rest = c.travellers.rest[i];
  if (paths.bounces[i] == 0 || rest.media.empty()) return;
  if (rest.guessed && rest.kind != receiver_kind_) return;
  const Rgb power = Rgb{paths.red[i], paths.green[i], paths.blue[i]} * share_of(paths.caustic[i]);
  if (!(max_abs(power) > 0) || !is_finite(power)) return;
  if (beams_ == BeamLight::kIndirect && !scene_.media()->homogeneous(rest.media)) return;
  const Vec3 direction{paths.direction_x[i], paths.direction_y[i], paths.direction_z[i]};
  const PhotonStart& start = c.travellers.starts[rest.place];
  c.run.beams.push_back({{paths.origin_x[i], paths.origin_y[i], paths.origin_z[i]},
                         direction,
                         hit ? hit->distance : INFINITY,
                         power,
                         rest.media,
                         rest.left_normal,
                         encode_direction(hit ? hit->ng : -direction),
                         start.light_group,
                         rest.time});
  if (!c.useful) return;
  c.useful[rest.place] += use_of(c.run.beams.back(), start, c.total);
  c.travellers.brought[rest.place] += sqr(power_of_use(c.run.beams.back()));
}

// Path i, whose ray meets lane k of the hits or, where not `there`, nothing.
void PhotonTracer::advance_alone(Chunk& c, uint32_t i, const RayHits& hits, uint32_t k,
                                 bool there) const {
  Travellers& travellers = c.travellers;
  const PhotonPaths& paths = travellers.paths;
  Path path = travellers.take(i);
  const PhotonStart& start = travellers.starts[path.place];
  Vec3 direction{paths.direction_x[i], paths.direction_y[i], paths.direction_z[i]};
  Vec3 origin{paths.origin_x[i], paths.origin_y[i], paths.origin_z[i]};
  Surface surface;
  surface.distance = INFINITY;
  if (there) surface = scene_.surface_of(hits, k, direction, path.time);
  if (there && scene_.media())
    scene_.media()->meet_touched(surface, origin, direction, kAllRays, path.time);
  const bool leaves_beams = beams_ != BeamLight::kNone;
  if (leaves_beams && there) leave_beam(c, i, &surface);
  const Draws draws{c.first_bounce, static_cast<uint32_t>(c.first + path.place)};
  if (scene_.media()) {
    const InMedium way = pass_media(path, surface.distance, start, draws, origin, direction);
    if (way == InMedium::kScattered) {
      travellers.put(c.kept++, path, origin, direction, true);
      if (const float power = c.useful ? sqr(luminance(path.power)) : 0; power > 0)
        travellers.stops.push_back({origin, path.place, power, travellers.brought[path.place]});
    }
    if (way != InMedium::kPasses || !there) return;
  }
  c.run.shaded += surface.program != nullptr;
  if (leaves_beams) path.left_normal = encode_direction(surface.ng);
  // Those before this one that are left, it, those after it, and those that wait
  const size_t all = c.kept + (c.alive - i) + travellers.more.size();
  size_t room = PhotonPaths::kMost - all + 1;
  if (room > 1) {
    path.towards = towards_seen(path, surface);
    if (path.towards.chance > 0 && path.random.next() < path.towards.chance) {
      Travellers::Waiting way{path, origin, direction};
      way.path.random = Random(path.random.state(), 0);
      way.path.towards.drawn = true;
      // What does not scatter there goes on in the path's own way alone
      if (shade(way.path, surface, start, draws, c.visible, way.origin, way.direction,
                c.run.photons) &&
          way.path.homes)
        travellers.more.push_back(way), --room;
    }
  }
  for (uint32_t ways = split(path, surface, room); ways > 1; --ways) {
    Travellers::Waiting way{path, origin, direction};
    way.path.random = Random(path.random.state(), ways);
    if (shade(way.path, surface, start, draws, c.visible, way.origin, way.direction, c.run.photons))
      travellers.more.push_back(way);
  }
  if (shade(path, surface, start, draws, c.visible, origin, direction, c.run.photons))
    travellers.put(c.kept++, path, origin, direction, goes_alone(path, start));
}

// The lanes from `begin` on, of which those with bits in `met` meet something.
void PhotonTracer::advance(Chunk& c, uint32_t begin, const RayHits& hits, unsigned met,
                           const BounceSettings& settings) const {
  PhotonPaths& paths = c.travellers.paths;
  PlainSurfaces surfaces;
  Bounced bounced;
  const unsigned together = bounce_together(paths, begin, hits, met, surfaces);
  if (together) bounce_(paths, begin, hits, surfaces, settings, bounced);
  if (stream_ == PhotonStream::kCaustic) bounced.goes_on = 0;
  const uint32_t lanes = std::min(kBounceLanes, c.alive - begin);
  if (beams_ != BeamLight::kNone)  // of light that meets nothing more
    for (uint32_t k = 0; k < lanes; ++k)
      if (!(met >> k & 1) && paths.bounces[begin + k] > 0) leave_beam(c, begin + k, nullptr);
  // What meets nothing may scatter all the same.
  const unsigned awake = scatters_in_media() ? met | c.travellers.in_media(begin, lanes) : met;
  for (unsigned rest = awake; rest; rest &= rest - 1) {
    const uint32_t k = static_cast<uint32_t>(std::countr_zero(rest)), i = begin + k,
                   place = c.travellers.rest[i].place;
    Photons& photons = c.run.photons;
    const size_t stored = photons.size();
    if (together >> k & 1) {
      if (bounced.stores >> k & 1 && c.visible.contains(surfaces.key[k]))
        photons.push_back(
            {{hits.x[k], hits.y[k], hits.z[k]},
             surfaces.key[k],
             static_cast<uint16_t>(bounced.directions[k]),
             static_cast<uint16_t>(bounced.directions[k] >> 16),
             {bounced.stored_red[k], bounced.stored_green[k], bounced.stored_blue[k]}});
      // In vain where it ends, which a branch could not foresee
      keep_bounced(c.travellers, i, c.kept, bounced, k);
      c.kept += bounced.goes_on >> k & 1;
    } else {
      advance_alone(c, i, hits, k, met >> k & 1);
    }
    if (c.useful)
      for (size_t p = stored; p < photons.size(); ++p)
        if (c.filter->counts(photons[p])) {
          c.useful[place] += use_of(photons[p], c.travellers.starts[place], c.total);
          c.travellers.brought[place] += sqr(luminance(photons[p].power));
        }
    if (keeps_groups_) c.run.groups.resize(photons.size(), c.travellers.starts[place].light_group);
  }
}

// What is to be learnt of where paths have scattered in media, now that it is known what each has
// brought after that.
void PhotonTracer::keep_stops(Chunk& c) const {
  auto& [starts, paths, rest, more, brought, stops] = c.travellers;
  for (const float of_path : brought) c.run.brought += of_path;
  std::erase_if(stops, [&](PathWorth::Stop& stop) {
    stop.brought = brought[stop.path] - stop.brought;
    if (stop.brought > 0) return false;
    stop.weight = kIdleStops;
    return hash_of(stop.place) % kIdleStops != 0;
  });
  const size_t each = 1 + kPathsPerStop * stops.size() / c.count;
  for (size_t i = c.first % each; i < stops.size(); i += each) {
    stops[i].weight *= static_cast<float>(each);
    c.run.stops.push_back(stops[i]);
  }
}

void PhotonTracer::trace_chunk(Chunk& c) const {
  Travellers& travellers = c.travellers;
  c.alive = start_all(c);
  const BounceSettings settings{stream_ == PhotonStream::kCaustic ? 0.0f : 1.0f,
                                stream_ == PhotonStream::kAll       ? 0.0f
                                : stream_ == PhotonStream::kCaustic ? 1.0f
                                                                    : -1.0f,
                                static_cast<uint32_t>(max_bounces_)};
  // Two of each: while one is worked on, memory for the other is fetched
  RayHits found[2];
  unsigned met[2] = {};
  while (c.alive) {
    c.run.rays += c.alive;
    c.kept = 0;
    for (uint32_t next = 0, turn = 0; next < c.alive + kBounceLanes;
         next += kBounceLanes, turn ^= 1) {
      if (next < c.alive) {
        const Scene::Rays rays =
            rays_of(travellers.paths, next, scene_.moves(), scene_.has_strands());
        met[turn] = scene_.intersect(rays, std::min(kBounceLanes, c.alive - next), found[turn]);
      }
      if (next > 0) advance(c, next - kBounceLanes, found[turn ^ 1], met[turn ^ 1], settings);
    }
    for (const Travellers::Waiting& one : travellers.more)
      travellers.put(c.kept++, one.path, one.origin, one.direction,
                     goes_alone(one.path, travellers.starts[one.path.place]));
    travellers.more.clear();
    c.alive = c.kept;
  }
  if (c.useful) keep_stops(c);
}

}  // namespace photon_splat
