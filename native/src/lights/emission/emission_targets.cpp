#include "lights/emission/emission_targets.h"

#include "lights/lights.h"

namespace photon_splat {

void EmissionTargets::distribute(const std::vector<double>& wishes) {
  double sum = 0, running = 0;
  for (double w : wishes) sum += w;
  pair_cdf_.resize(pairs_.size());
  for (size_t i = 0; i < pairs_.size(); ++i) {
    pairs_[i].probability = static_cast<float>((1 - natural_share_) * wishes[i] / sum);
    pair_cdf_[i] = running += wishes[i] / sum;
  }
}

void EmissionTargets::learn(const PhotonStart& start, const Vec2& way, double useful) {
  if (start.of_world) world_ways_.learn(way, useful);
  if (start.aim < 0) return;
  Pair& pair = pairs_[start.aim];
  pair.paths += 1;
  pair.useful += static_cast<float>(useful);
}

void EmissionTargets::finish() {
  world_ways_.finish();
  double paths = 0, useful = 0;
  for (const Pair& pair : pairs_) {
    paths += pair.paths;
    useful += pair.useful;
  }
  if (!(useful > 0)) return;
  constexpr double kLeast = 0.01;
  const double mean = useful / paths;
  std::vector<double> wishes;
  for (const Pair& pair : pairs_)  // drawn towards the mean of all by as much as one path weighs
    wishes.push_back(pair.flux * std::max(kLeast, std::sqrt((pair.useful + mean) /
                                                            ((pair.paths + 1.0) * mean))));
  distribute(wishes);
}

}  // namespace photon_splat
