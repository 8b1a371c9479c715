// Light groups: what each of them adds to the picture is kept apart. A photon knows its light's
// group by the number beside it; photons are splatted group by group, so that each is splatted
// once.
#include <stdexcept>

#include "render/renderer.h"

namespace photon_splat {

void Renderer::check_light_groups() const {
  const auto check = [&](int16_t group) {
    if (group < kNoLightGroup || group >= scene.light_groups)
      throw std::invalid_argument("a light is of a light group that does not exist");
  };
  for (const LampSettings& lamp : lamps) check(lamp.light_group);
  for (const Instance& instance : scene.instances) check(instance.light_group);
  check(scene.world_light_group);
}

// The sums in the points change places with those of a group.
void Renderer::swap_sums(Layer& layer, int group) {
  PointBlocks& blocks = layer.points.blocks();
  GroupSums* const sums = &layer.group_sums[group * blocks.size()];
  for (size_t b = 0; b < blocks.size(); ++b)
    for (uint32_t lane = 0; lane < kBlockSize; ++lane) {
      std::swap(blocks[b].r[lane], sums[b].r[lane]);
      std::swap(blocks[b].g[lane], sums[b].g[lane]);
      std::swap(blocks[b].b[lane], sums[b].b[lane]);
    }
}

void Renderer::splat_groups(Layer& layer) {
  PointBlocks& blocks = layer.points.blocks();
  if (blocks.empty()) return;
  for (int group = kNoLightGroup; group < scene.light_groups; ++group) {
    part_.clear();
    for (size_t i = 0; i < photons_->size(); ++i)
      if ((*photon_groups_)[i] == group) part_.push_back((*photons_)[i]);
    if (part_.empty()) continue;
    if (group != kNoLightGroup) swap_sums(layer, group);
    layer.splatter->splat(part_, blocks, scene.pool(), cancel_);
    if (group != kNoLightGroup) swap_sums(layer, group);
  }
}

// Adds the groups' sums to the rest that is in the points.
void Renderer::join_groups(Layer& layer) {
  PointBlocks& blocks = layer.points.blocks();
  for (size_t i = 0; i < layer.group_sums.size(); ++i) {
    PointBlock& block = blocks[i % blocks.size()];
    const GroupSums& sums = layer.group_sums[i];
    for (uint32_t lane = 0; lane < kBlockSize; ++lane) {
      block.r[lane] += sums.r[lane];
      block.g[lane] += sums.g[lane];
      block.b[lane] += sums.b[lane];
    }
  }
}

}  // namespace photon_splat
