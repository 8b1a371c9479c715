#include "density/enclosure.h"

#include <bit>

namespace photon_splat {
namespace {

constexpr uint32_t kLooks = 24;  // by which a closed thing is told from a sheet

}  // namespace

std::optional<bool> shines(const Scene& scene, const Surface& hit, const Vec3& wo) {
  if (!hit.program) return !is_black(hit.side->emission);
  if (!(hit.program->features & (kProgramEmits | kProgramTransparent | kProgramTransmits)))
    return false;
  Bsdf bsdf(Transport::kRadiance, wo, hit.ng, hit.ns, hit.back);
  scene.shade(hit, wo, {}, bsdf);
  if (!is_black(bsdf.transparency()) || bsdf.transmits()) return {};
  return !is_black(bsdf.emission());
}

unsigned Enclosures::hold(const Vec3* points, uint32_t count, unsigned which) {
  if (!which) return 0;
  Vec3 origins[Scene::kPacket], ways[Scene::kPacket];
  for (uint32_t k = 0; k < count; ++k) {
    origins[k] = points[k] + basis_.normal * height_;
    ways[k] = basis_.normal;
  }
  Surface above[Scene::kPacket];
  unsigned inside = 0;
  for (unsigned met = which & scene_.intersect_packet(origins, ways, count, above, kinds_); met;
       met &= met - 1) {
    const int k = std::countr_zero(met);
    if (above[k].back && above[k].key != key_ && holds_under(above[k], origins[k]))
      inside |= 1u << k;
  }
  return inside;
}

// Whether the thing is closed whose back `above` is, as seen from `origin`.
bool Enclosures::holds_under(const Surface& above, const Vec3& origin) {
  for (int i = 0; i < known_; ++i)
    if (keys_[i] == above.key) return closed_[i];
  const bool closed = is_dark(scene_, above, -basis_.normal) && backs_all_around(origin);
  if (known_ < kKnown) {
    keys_[known_] = above.key;
    closed_[known_++] = closed;
  }
  return closed;
}

bool Enclosures::backs_all_around(const Vec3& origin) {
  constexpr uint32_t kTogether = Scene::kPacket;
  static_assert(kLooks % kTogether == 0);
  Surface hits[kTogether];
  Vec3 origins[kTogether], ways[kTogether];
  for (uint32_t look = 0; look < kLooks; look += kTogether) {
    for (uint32_t i = 0; i < kTogether; ++i) {
      origins[i] = origin;
      ways[i] = basis_.to_world(sample_cosine_hemisphere(random_.next2()));
    }
    if (scene_.intersect_packet(origins, ways, kTogether, hits, kinds_) != (1u << kTogether) - 1)
      return false;
    if (!std::all_of(hits, hits + kTogether,
                     [&](const Surface& hit) { return hit.back && hit.key != key_; }))
      return false;
  }
  return true;
}

}  // namespace photon_splat
