// Where camera paths go on, and the gather points that they leave for photons.
#include "integrators/camera_path.h"
#include "math/bumps.h"

namespace photon_splat {

// Where photons on the surface are found.
Vec3 CameraTracer::place_of(const Path& path, const Surface& hit) const {
  return scene_.moves(hit.instance) ? scene_.at_rest(hit, path.info.time).position : hit.position;
}

bool CameraTracer::continues(Path& path, const Surface& hit, const Bsdf& bsdf) const {
  const bool here = !is_black(bsdf.gather());
  if (!here && is_black(bsdf.gather_through())) return false;
  if (follows_motion_ && !scene_.moves(hit.instance) && scene_.moves_near(hit.position))
    return true;
  if (follows_translucence_ && !is_black(bsdf.gather_through())) return true;
  if (!strategy_) return false;
  if (strategy_->kind() == IndirectStrategy::Kind::kPathTraced) return true;
  if (strategy_->kind() == IndirectStrategy::Kind::kFinalGather && path.gather_bounces == 0)
    return true;
  ++path.tile.places;
  const uint32_t key = here ? hit.key : hit.key ^ 1u;
  const Vec3 place = place_of(path, hit);
  const bool close = strategy_->kind() == IndirectStrategy::Kind::kFinalGather &&
                     strategy_->too_close(hit.distance, key, place, hit.instance, hit.triangle,
                                          radius_factor_, path.tile.near);
  if (!close && !(path.badly_served && !strategy_->knows(key)) &&
      !strategy_->at(key, place, hit.instance, hit.triangle, radius_factor_, path.tile.near))
    return false;
  ++path.tile.continued;
  path.badly_served = true;
  return true;
}

void CameraTracer::leave_gather_points(Path& path, const Surface& hit, const Bsdf& bsdf,
                                       bool caustics_only) const {
  std::optional<PlaceAtRest> rest;
  if (scene_.moves(hit.instance)) rest = scene_.at_rest(hit, path.info.time);
  const Vec3 position = rest ? rest->position : hit.position, normal = rest ? rest->ng : hit.ng;
  const auto leave = [&](const Rgb& albedo, bool through, uint32_t offset) {
    const Rgb throughput = path.throughput * albedo * (1 / kPi);
    if (is_zero(throughput)) return;
    if (!is_finite(throughput))
      ++path.tile.bad_samples;
    else
      path.tile.gather_points.push_back(
          {position, through ? hit.key ^ 1u : hit.key, through ? -normal : normal,
           path.info.footprint, throughput, path.pixel_index, hit.instance, hit.triangle, offset,
           path.category, caustics_only, path.gather_bounces > 0});
  };
  for (const Bsdf::Part& part : bsdf.gather_parts())
    leave(part.albedo, part.through, encode_offset(rest ? rest->turn(part.offset) : part.offset));
  if (!bsdf.gather_parts().empty()) return;
  leave(bsdf.gather(), false, 0);
  leave(bsdf.gather_through(), true, 0);
}

// Sends the path on for light that gather points do not bring; false where it ends.
bool CameraTracer::scatter(Path& path, const Surface& hit, const Bsdf& bsdf,
                           const Receiver& receiver, bool continued) const {
  const bool last = path.vertex >= path.max_bounces,
             whole = !path.leaves_gather_points || continued;
  const bool goes_on = !last && (whole || bsdf.has_rest());
  if (!goes_on && !bsdf.has_rest() && !lights_.wants_bsdf_ray(receiver)) return false;
  const Vec2 lobe = path.numbers(kLobePair), way = path.way();
  const auto s = bsdf.sample(lobe.x, way);
  if (!s) return false;
  path.only_turned &= !s->by_turned_normal;
  if (path.only_turned && last) return false;
  Rgb diffuse = s->diffuse ? s->weight : Rgb{};
  if ((path.vertex == 0 || path.only_mirrored) && bsdf.has_rest() && s->pdf > 0) {
    float pdf;
    bsdf.evaluate(s->direction, &pdf, nullptr, &diffuse);
    diffuse = diffuse / s->pdf;
  }
  const Rgb weight = path.only_mirrored ? s->weight - diffuse : s->weight;
  const bool shares = lights_.environment().asks_ray() || lights_.hide_from_some();
  if (shares) path.before = path.info;
  const Rgb before = path.throughput, world_before = path.world_throughput;
  path.throughput = !goes_on                      ? Rgb{}
                    : whole || path.only_mirrored ? before * weight
                                                  : before * s->rest;
  const auto still_covered = [&](const Rgb& covered) {
    return s->diffuse || s->by_turned_normal ? Rgb{} : covered * weight * sharpness(s->roughness);
  };
  path.withheld = path.covered = still_covered(path.covered);
  path.withheld_diffuse = path.covered_diffuse = still_covered(path.covered_diffuse);
  path.emission_throughput = before * weight - path.withheld;
  path.world_emission = world_before * weight;
  path.world_throughput = last || !lights_.world_by_paths()
                              ? Rgb{}
                              : (before + world_before) * weight - path.throughput;
  path.deep = path.is_beyond();
  path.gather_bounces += continued;
  path.diffuse_bounces += continued && s->diffuse;
  if (continued && caustic_photons_) {
    const Rgb gathered = before * (s->weight - s->rest);
    path.covered += gathered;
    path.covered_diffuse += path.vertex == 0 ? gathered : gathered * path.diffuse_part;
  }
  path.diffuse_emission = path.only_mirrored ? Rgb{} : before * diffuse;
  if (!is_finite(path.emission_throughput) || !is_finite(path.throughput) ||
      !is_finite(path.diffuse_emission) || !is_finite(path.world_throughput) ||
      !is_finite(path.world_emission)) {
    ++path.tile.bad_samples;
    return false;
  }
  // What photons leave to diffuse lobes on bumps is mostly next to nothing: the path then goes on
  // to look for lights, if at all.
  const bool leftover = s->diffuse && !whole;
  if (leftover && !bsdf.gather_parts().empty()) {
    const float worth = path.survival(max_abs(path.throughput));
    if (worth < 1) path.throughput = path.random.next() < worth ? path.throughput / worth : Rgb{};
  }
  float strength = max_abs(path.throughput + path.world_throughput);
  if (!leftover || receiver.sharp || lights_.wants_bsdf_ray(receiver))
    strength = std::max(strength, max_abs(path.emission_throughput + path.world_emission));
  const float survival =
      path.vertex == 0 ? std::min(1.0f, strength * kFirstRoulette) : path.survival(strength);
  const bool narrow = !(s->pdf > 0) || s->pdf > kNarrow;
  const float looks = narrow ? std::min(1.0f, survival * kSights) : survival;
  if (path.ends(looks)) return false;
  path.survives = survival / looks;

  if (path.vertex == 0) {
    const Rgb left_out = whole ? Rgb{} : s->weight - s->rest;  // by photons, all diffuse
    path.diffuse_part =
        path.only_mirrored ? Rgb{} : divided(max(diffuse - left_out, {}), s->weight - left_out);
    path.beside = s->transmitted ? LobeCategory::kTransmission : LobeCategory::kGlossy;
    const float part = average(path.diffuse_part);
    path.category =
        part > 0 && (part >= 1 || path.random.next() < part) ? LobeCategory::kDiffuse : path.beside;
  }
  path.clear &=
      s->transmitted && !s->diffuse && s->roughness <= camera_.settings().transparent_glass;
  path.info = path.info.scattered(s->diffuse, s->transmitted, s->pdf <= 0);
  if (dot(s->direction, hit.ng) < 0 && scene_.media())
    scene_.media()->cross(path.media, hit, gap_beside(hit, s->direction), path.info.time);
  path.travelled += hit.distance;
  path.origin = leave(hit, s->direction);
  path.direction = s->direction;
  path.near = 0;
  path.far = INFINITY;
  path.from = receiver;
  path.from.ray = static_cast<uint8_t>(lobe_rays(false, s->transmitted));
  if (lights_.world_shares() && s->pdf > 0) path.from.ray_pdf = bsdf.ray_pdf(s->direction);
  if (shares) {
    path.from.diffuse_ray = static_cast<uint8_t>(lobe_rays(true, s->transmitted));
    path.from.diffuse_share = bsdf.diffuse_share(*s, INFINITY);
    path.from.diffuse_share_of_world =
        lights_.world_asks() ? bsdf.diffuse_share(*s, lights_.world_density(s->direction))
                             : path.from.diffuse_share;
  }
  path.pdf = s->pdf > 0 ? s->pdf : INFINITY;
  ++path.vertex;
  return true;
}

}  // namespace photon_splat
