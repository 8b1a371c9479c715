// Photons below surfaces. A camera path enters by its closure and leaves by a white diffuse lobe; a
// photon goes the other way: it enters as by that lobe, and leaves in the directions from which a
// camera path would take its way up.
#include "photons/photon_tracer.h"
#include "subsurface/entry.h"
#include "subsurface/walk.h"

namespace photon_splat {
namespace {

constexpr float kMostWays = 16;

}  // namespace

// How many ways the path goes from there, each with its part of the power; `room`: most. Of photons
// that go below surfaces half come up where no camera path goes down, and the others bring twice
// the light: after many such surfaces few of them would have all of it.
uint32_t PhotonTracer::split(Path& path, const Surface& hit, size_t room) const {
  const float times = max_abs(path.power) / path.reference;
  if (!(times >= 2) || path.bounces == 0 || stream_ == PhotonStream::kCaustic || !hit.program ||
      !(hit.program->features & kProgramSubsurface))
    return 1;
  const float ways = std::floor(std::min({times, kMostWays, static_cast<float>(room)}));
  path.power *= 1 / ways;
  return static_cast<uint32_t>(ways);
}

// Sends the path on from where it leaves; false where it ends. The body is taken for one of what
// the closure says where the photon enters, while camera paths ask where they do.
bool PhotonTracer::go_below(Path& path, const Surface& hit, const Bsdf& bsdf, const RayInfo& ray,
                            const Draws& draws, Vec3& origin, Vec3& direction) const {
  const float cos_shading = -dot(direction, hit.ns), cos_geometric = -dot(direction, hit.ng);
  if (cos_shading <= 0 || cos_geometric <= 0) return false;
  float all = 0;
  for (int i = 0; i < bsdf.below_count(); ++i) all += average(bsdf.below(i).weight);
  float left = path.random.next() * all;
  int own = 0;
  for (; own < bsdf.below_count() - 1 && left >= average(bsdf.below(own).weight); ++own)
    left -= average(bsdf.below(own).weight);
  const Subsurface& entered = bsdf.below(own);
  const float chance = average(entered.weight) / all;
  if (!(chance > 0)) return false;

  const Vec3 way = Basis(-hit.ng).to_world(sample_cosine_hemisphere(draws.next(path)));
  WalkNumbers numbers(path.random);
  const auto exit =
      walk_below(scene_, hit, entered, way, path.power * entered.albedo, numbers, path.time);
  if (!exit) return false;
  const Surface& s = exit->surface;
  const float choice = path.random.next();
  const auto leaving = sample_leaving(entered, s.ns, s.ng, -exit->way, choice, path.random.next2());
  if (!leaving || !s.program) return false;
  Bsdf there(Transport::kRadiance, leaving->wo, s.ng, s.ns, s.back);
  there.keep_subsurface(SubsurfaceUse::kWalks);
  scene_.shade(s, leaving->wo, ray, there);
  if (own >= there.below_count()) return false;
  const Subsurface& left_by = there.below(own);
  // The density of facets about the normal that the direction was drawn by: other densities may
  // have their peak where none is drawn.
  Subsurface drawn_by = entered;
  drawn_by.n = s.ns;
  const float density = entry_pdf(drawn_by, leaving->wo, -exit->way) * dot(leaving->wo, s.ng) /
                        std::max(dot(exit->way, s.ng), 1e-6f);
  path.power *= exit->weight * entered.albedo * divided(left_by.weight, left_by.albedo) *
                (cos_shading / cos_geometric / chance * density / leaving->pdf);
  const float survival = std::min(1.0f, max_abs(path.power) / path.reference);
  if (!(survival > 0) || path.random.next() >= survival || !is_finite(path.power)) return false;
  path.power *= 1 / survival;
  path.caustic = 0;
  ++path.bounces;
  path.travelled = 0;
  path.left_normal = encode_direction(s.ng);
  origin = s.position + s.ng * std::max(ray_offset(s.position, hit.distance), s.rounding);
  direction = leaving->wo;
  return true;
}

}  // namespace photon_splat
