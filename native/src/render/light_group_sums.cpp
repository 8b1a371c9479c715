#include "render/light_group_sums.h"

#include "scene/scene.h"

namespace photon_splat {

// The sums in the blocks change places with those of a group.
void LightGroupSums::swap(PointBlocks& blocks, int group) {
  Sums* const sums = &sums_[group * blocks.size()];
  for (size_t b = 0; b < blocks.size(); ++b)
    for (uint32_t lane = 0; lane < kBlockSize; ++lane) {
      std::swap(blocks[b].r[lane], sums[b].r[lane]);
      std::swap(blocks[b].g[lane], sums[b].g[lane]);
      std::swap(blocks[b].b[lane], sums[b].b[lane]);
    }
}

void LightGroupSums::splat(Splatter& splatter, const Photons& photons,
                           const std::vector<int16_t>& groups, PointBlocks& blocks, WaySums& ways,
                           ThreadPool& pool, const CancelFlag& cancel) {
  if (blocks.empty()) return;
  for (int group = kNoLightGroup; group < groups_; ++group) {
    of_group_.clear();
    for (size_t i = 0; i < photons.size(); ++i)
      if (groups[i] == group) of_group_.push_back(photons[i]);
    if (of_group_.empty()) continue;
    if (group != kNoLightGroup) swap(blocks, group);
    splatter.splat(of_group_, blocks, ways, pool, cancel);
    if (group != kNoLightGroup) swap(blocks, group);
  }
}

void LightGroupSums::join(PointBlocks& blocks) const {
  for (size_t i = 0; i < sums_.size(); ++i) {
    PointBlock& block = blocks[i % blocks.size()];
    const Sums& sums = sums_[i];
    for (uint32_t lane = 0; lane < kBlockSize; ++lane) {
      block.r[lane] += sums.r[lane];
      block.g[lane] += sums.g[lane];
      block.b[lane] += sums.b[lane];
    }
  }
}

}  // namespace photon_splat
