// What a photon finds at a surface with a program, and where that sends it.
#include "photons/photon_vertex.h"

namespace photon_splat {
namespace {

constexpr float kAsFlat = 0.9995f;     // cosine of normals as good as the surface's own
constexpr float kSentThrough = 0.25f;  // of photons at glass that one side sends nothing through

// Taken for those of deltas.
bool is_sharp(RayInfo::Kind kind) {
  return kind == RayInfo::kGlossy || kind == RayInfo::kTransmission;
}

}  // namespace

// Guesses the kind of ray and shades the surface.
void PhotonTracer::look_at(Path& path, Vertex& v) const {
  const Surface& hit = v.hit;
  v.asked = hit.program->asks_kind || scene_.kinds_differ();
  const bool decided = !v.asked && scatters_in_media() && scene_.volume_differs(hit.instance);
  v.told = v.asked || decided;
  v.ray.kind = v.asked   ? guess_kind(path.random, receiver_kind_, &v.chance)
               : decided ? kind_that_sees(hit.instance)
                         : receiver_kind_;
  v.ray.singular = is_sharp(v.ray.kind);
  v.ray.depth = path.bounces;
  v.ray.transparent_depth = path.passed;
  v.ray.time = path.time;
  // It is seen by way of where the photon goes next: about as far off as where it came from
  if (viewer_) v.ray.footprint = viewer_->footprint_by_way(hit.position, hit.distance);
  if (v.has(kProgramSubsurface) && !hit.on_strand()) v.bsdf.keep_subsurface(SubsurfaceUse::kWalks);
  scene_.shade(hit, -v.direction, v.ray, v.bsdf);
  v.asked_back = (hit.program->asks_view || hit.program->asks_length) && !hit.on_strand() &&
                 v.bsdf.lobe_count() > 0;
  if (v.asked_back) v.bsdf.send_back();
  v.sided = (hit.program->asks_side || hit.program->has_own_normals || hit.program->asks_length ||
             (hit.program->on_bent_normals && dot(hit.ns, hit.ng) < kAsFlat)) &&
            v.has(kProgramTransmits) && !hit.on_strand();
  if (!v.sided) return;
  Bsdf from_there(Transport::kFlux, -v.direction, hit.ng, hit.ns, hit.back);
  // Seen from where the light is bent to: straight on nothing may shine through
  const Vec3 viewer = v.bsdf.way_on().value_or(v.direction);
  const Surface other = Scene::other_side(hit);
  scene_.shade(other, viewer, v.ray, from_there);
  v.bsdf.send_through(from_there);
  if (from_there.has_smooth_glass())
    v.ways = seen_from(other, viewer, v.ray).smooth_ways(-v.direction);
}

PhotonTracer::Passing PhotonTracer::passing(Path& path, const Vertex& v) const {
  const Surface& hit = v.hit;
  Passing out;
  out.blocking = blocks(path, hit, v.start);
  out.transparency = out.blocking ? v.bsdf.transparency() : Rgb{1, 1, 1};
  if (!out.blocking || !scene_.may_be_transparent(hit)) return out;
  out.asked = v.by_shadow ? hit.program->asks_shadow : v.asked;
  out.ray = v.ray;
  if (out.asked) {
    out.ray.kind = path.kind;
    if (!path.guessed)
      out.ray.kind =
          guess_kind(path.random, v.by_shadow ? RayInfo::kShadow : receiver_kind_, &out.chance);
    out.ray.singular = is_sharp(out.ray.kind);
  }
  if (out.asked || hit.program->asks_side)
    out.transparency = scene_.lets_through(hit, v.direction, out.ray);
  return out;
}

std::optional<BsdfSample> PhotonTracer::sample_lobes(Path& path, const Vertex& v, float choice,
                                                     const Vec2& u) const {
  if (stream_ == PhotonStream::kCaustic) return v.bsdf.sample_sharp(choice, u);
  const auto s = v.bsdf.sample(choice, u, path.towards);
  path.homes = s && path.towards.drawn;
  return s;
}

// Where the surface sends the light, as who looks back from there sees it.
std::optional<BsdfSample> PhotonTracer::sample(Path& path, const Vertex& v, float choice,
                                               const Vec2& u) const {
  auto s = v.sided ? sample_sided(path, v, choice, u) : sample_lobes(path, v, choice, u);
  if (s && v.asked_back && !s->transmitted && (s->pdf > 0 || v.hit.program->asks_length)) {
    const Bsdf seen = seen_by_next(v, v.hit, s->direction);
    s->weight = (s->pdf > 0 ? seen.evaluate(-v.direction, nullptr) : seen.mirror_share(s->lobe)) *
                s->per_value;
    if (is_black(s->weight)) return {};
  }
  // No viewer sees that by the same normal: CameraTracer::look_for_turned_mirrors()
  if (s && s->by_turned_normal && v.hit.program->turns_mirrors()) return {};
  return s;
}

// What a surface with two sides scatters of light that comes along a photon's way: what goes
// through as a camera path that looks back along that way sees it, as its normals are others from
// there.
std::optional<BsdfSample> PhotonTracer::sample_sided(Path& path, const Vertex& v, float choice,
                                                     const Vec2& u) const {
  const bool sharp = stream_ == PhotonStream::kCaustic;
  // This side's chance of going through smooth glass may be none where the other side sees some
  const float own = v.bsdf.smooth_chance(sharp),
              forced = v.ways.count > 0 && own < kSentThrough ? kSentThrough : 0;
  std::optional<BsdfSample> s;
  bool smooth = forced > 0 && path.random.next() < forced;
  if (!smooth) {
    s = sample_lobes(path, v, choice, u);
    if (!s) return {};
    smooth = s->transmitted && s->pdf <= 0;
    s->weight *= 1 / (1 - forced);
    s->per_value *= 1 / (1 - forced);
  }
  if (smooth) {
    if (v.ways.count == 0) return {};
    const auto number = static_cast<int>(path.random.next() * static_cast<float>(v.ways.count));
    const Bsdf::SmoothWay& way = v.ways.ways[std::min(number, v.ways.count - 1)];
    const float chance = (forced + (1 - forced) * own) / static_cast<float>(v.ways.count);
    BsdfSample through;
    through.direction = way.to;
    through.transmitted = true;
    through.weight = through.rest =
        seen_by_next(v, Scene::other_side(v.hit), way.to).smooth_share(way.lobe) *
        (way.spread / chance);
    s = through;
  } else if (s->transmitted) {
    s->weight =
        seen_by_next(v, Scene::other_side(v.hit), s->direction).evaluate(-v.direction, nullptr) *
        s->per_value;
  }
  if (is_black(s->weight)) return {};
  return s;
}

// The closures of a surface, or of its other side, as a camera path sees them that comes from wo.
Bsdf PhotonTracer::seen_from(const Surface& side, const Vec3& wo, const RayInfo& ray) const {
  Bsdf bsdf(Transport::kRadiance, wo, side.ng, side.ns, side.back);
  if (side.program->features & kProgramSubsurface) bsdf.keep_subsurface(SubsurfaceUse::kWalks);
  scene_.shade(side, wo, ray, bsdf);
  return bsdf;
}

// The same, as seen from what the photon meets on that way.
Bsdf PhotonTracer::seen_by_next(const Vertex& v, Surface side, const Vec3& way) const {
  Surface next;
  if (side.program->asks_length &&
      scene_.intersect(leave(v.hit, way), way, 0, INFINITY, false, next, ray_bit(v.ray.kind),
                       v.ray.time, v.hit.mark))
    side.distance = next.distance;
  return seen_from(side, way, v.ray);
}

}  // namespace photon_splat
