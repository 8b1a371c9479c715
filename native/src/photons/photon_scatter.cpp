// What happens to a photon path where it meets a surface that is not bounced off with others.
#include "math/bumps.h"
#include "photons/photon_tracer.h"

namespace photon_splat {

// What lands after a bounce is indirect light, or caustic light, or a share of each.
void PhotonTracer::store(const Path& path, const Surface& hit, const Vec3& direction,
                         const SurfaceFilter& visible, Photons& photons) const {
  if (path.bounces == 0 || path.towards.drawn || hit.on_strand() || !visible.contains(hit.key))
    return;
  // What is stored stands for a diffuse ray from here
  if (path.guessed && path.kind != receiver_kind_) return;
  const float share = share_of(path.caustic);
  const float cos_shading = -dot(direction, hit.ns), cos_geometric = -dot(direction, hit.ng);
  if (!(share > 0) || cos_shading <= 0 || cos_geometric <= 0) return;
  // Density on the surface measures the geometric cosine; the BSDF wants the shading one (Veach
  // 1997, section 5.3).
  const Rgb power = path.power * (share * cos_shading / cos_geometric);
  const Vec3 way = way_for_smooth(-direction, hit.ng, hit.ns);
  if (scene_.moves(hit.instance)) {
    const PlaceAtRest rest = scene_.at_rest(hit, path.time);
    if (!(rest.area > 0) || !is_finite(rest.ng)) return;  // there is nothing of it
    photons.push_back({rest.position, hit.key, encode_direction(rest.ng),
                       encode_direction(rest.turn(way)), power * rest.area});
    return;
  }
  photons.push_back(
      {hit.position, hit.key, encode_direction(hit.ng), encode_direction(way), power});
}

// A way from a Lambertian surface, in proportion to the cosine, or to what is seen; its weight.
float PhotonTracer::scatter_diffuse(Path& path, const Vec3& n, const Vec2& u,
                                    Vec3& direction) const {
  const Towards& towards = path.towards;
  path.homes = towards.drawn;
  direction =
      towards.drawn ? towards.cone.sample(u) : Basis(n).to_world(sample_cosine_hemisphere(u));
  if (!(towards.chance > 0)) return 1;
  const float own = std::max(dot(direction, n), 0.0f) * (1 / kPi);
  return own / (own + towards.pdf(direction));
}

// Stores a photon where one belongs and sends the path on; false where it ends.
bool PhotonTracer::shade(Path& path, const Surface& hit, const PhotonStart& start,
                         const Draws& draws, const SurfaceFilter& visible, Vec3& origin,
                         Vec3& direction, Photons& photons) const {
  path.left = hit.mark;
  choose_kind(path, hit);
  if (path.bounces == 0 && path.travelled + hit.distance < start.soft_nearest)
    return pass_before_lamp(path, hit, direction, start, origin);
  if (hit.program)
    return scatter_by_program(path, hit, start, draws, visible, origin, direction, photons);
  const bool accepted = lit(path, hit, start);
  if (!blocks(path, hit, start)) {  // the light goes on and is scattered: either, by chance
    const bool passes = !accepted || path.random.next() < 0.5f;
    if (accepted) path.power *= 2;
    if (passes) {
      path.unshadowed |= path.bounces == 0 && !start.casts_shadows;
      if (const auto twin = seen_twin(path, hit, direction))
        return shade(path, *twin, start, draws, visible, origin, direction, photons);
      return go_straight_on(path, hit, {1, 1, 1}, origin);
    }
  }
  if (!accepted) return false;
  store(path, hit, direction, visible, photons);
  path.power *= std::exchange(path.painted, Rgb{1, 1, 1});
  if (!light_up(path, hit.position, path.travelled + hit.distance, start) ||
      !light_up_by_ray(path, start, {1, 1, 1}, false, false))
    return false;
  const float cos_shading = -dot(direction, hit.ns), cos_geometric = -dot(direction, hit.ng);
  if (cos_shading <= 0 || cos_geometric <= 0) return false;
  if (path.bounces == max_bounces_ || path.bounces >= start.max_bounces ||
      stream_ == PhotonStream::kCaustic)
    return false;
  if (!scatters_for(start, path, ray_bit(RayInfo::kDiffuse))) return false;
  if (path.guessed && path.kind != (straight(path, start) ? RayInfo::kShadow : RayInfo::kDiffuse))
    return false;
  if (!sends_on(path, hit)) return false;
  const Receiver at{hit.position, hit.ng, false, scene_.instances[hit.instance].group};
  path.power *= scene_.albedo(hit) * (cos_shading / cos_geometric *
                                      share_of_way(path, start, at, cos_shading * (1 / kPi)));
  const float survival = std::min(1.0f, max_component(path.power) / path.reference);
  if (!(survival > 0) || path.random.next() >= survival) return false;
  path.power *= 1 / survival;
  origin = leave(hit, hit.ng);
  const float weight = scatter_diffuse(path, hit.ng, draws.next(path), direction);
  if (!(weight > 0)) return false;
  path.power *= weight;
  path.reference *= weight;
  ++path.bounces;
  path.caustic = 0;
  return true;
}

}  // namespace photon_splat
