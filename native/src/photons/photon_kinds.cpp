// By which kind of ray a photon's way is looked back along.
#include "photons/photon_tracer.h"

namespace photon_splat {

// A kind of ray, most often `first`, which is of shadows straight from a lamp alone; *chance: its
// probability. What media scatter is seen by a kind of its own.
RayInfo::Kind PhotonTracer::guess_kind(Random& random, RayInfo::Kind first, float* chance) const {
  const float u = random.next();
  if (first == RayInfo::kDiffuse && scatters_in_media()) {
    *chance = u < 0.4f ? 0.4f : 0.2f;
    return u < 0.4f   ? first
           : u < 0.6f ? RayInfo::kGlossy
           : u < 0.8f ? RayInfo::kTransmission
                      : RayInfo::kVolume;
  }
  *chance = u < 0.5f ? 0.5f : 0.25f;
  return u < 0.5f ? first : u < 0.75f ? RayInfo::kGlossy : RayInfo::kTransmission;
}

// The kind of ray, scattered by a medium or diffusely, that sees the instance, where only one of
// them does.
RayInfo::Kind PhotonTracer::kind_that_sees(uint32_t instance) const {
  return scene_.instances[instance].seen_by & ray_bit(RayInfo::kVolume) ? RayInfo::kVolume
                                                                        : RayInfo::kDiffuse;
}

// Where nothing has asked yet by which of these two the path is looked back along, a surface does
// that only one of them sees.
void PhotonTracer::choose_kind(Path& path, const Surface& hit) const {
  if (path.guessed || path.bounces == 0 || !scatters_in_media() ||
      !scene_.volume_differs(hit.instance))
    return;
  path.kind = path.random.next() < 0.5f ? RayInfo::kVolume : RayInfo::kDiffuse;
  path.guessed = true;
  path.power *= 2;
}

// Guesses, for a path that a surface without a program is about to scatter, by which kind of ray
// that will be seen, where it matters; false where such rays do not see the surface.
bool PhotonTracer::sends_on(Path& path, const Surface& hit) const {
  path.kind = RayInfo::kDiffuse;
  path.guessed = scene_.kinds_differ();
  if (!scene_.limits_rays()) return true;
  if (path.guessed) {
    float chance;
    path.kind = guess_kind(path.random, RayInfo::kDiffuse, &chance);
    path.power *= 1 / chance;
  } else if (scatters_in_media() && scene_.volume_differs(hit.instance)) {
    path.kind = kind_that_sees(hit.instance);
    path.guessed = true;
  }
  return scene_.instances[hit.instance].seen_by & ray_bit(path.kind);
}

}  // namespace photon_splat
