// How far paths and light get in the media around them.
#include "media/media.h"

namespace photon_splat {
namespace {

constexpr int kMostCollisions = 20000;  // on one way; then it ends there
constexpr float kRounded = 1e-4f;       // of a distance in the coordinates of a grid
constexpr float kFaint = 0.02f;         // transmittance below which ways are broken off by chance

}  // namespace

// The tentative collisions of one region along a ray, in the order of their distance.
class Media::Walk {
 public:
  Walk(const Scene& scene, const Region& region, const Vec3& origin, const Vec3& direction,
       float near, float far, float time)
      : grid_(region.grid.get()),
        origin_(origin),
        direction_(direction),
        density_(region.density),
        at_(near),
        far_(far) {
    if (region.homogeneous) {
      bound_ = max_component(region.point.extinction());
      end_ = far;
    } else {
      if (grid_->from_object) place(scene, region.instance, time);
      if (grid_->closed) far_ = std::max(std::min(far_, way_out_of(*grid_->closed)), near);
      enter_cell();
    }
    homogeneous_ = region.homogeneous;
  }

  float bound() const { return bound_; }  // at the last collision, 1/m
  // Distance of the next one; infinity: none before `far`.
  float next(float u) {
    float depth = -std::log(1 - u);
    for (;;) {
      const float there = bound_ > 0 ? at_ + depth / bound_ : INFINITY;
      if (there < end_) return at_ = there;
      if (end_ >= far_ || homogeneous_) return at_ = INFINITY;
      depth -= bound_ * (end_ - at_);
      at_ = end_;
      enter_cell();
    }
  }

 private:
  // Into the coordinates of the grid; distances stay those along the ray.
  void place(const Scene& scene, uint32_t instance, float time) {
    const bool moves = scene.moves(instance) && scene.instances[instance].motion >= 0;
    const Affine to_object =
        moves ? scene.pose_at(instance, time).to_local : scene.world_to_object[instance];
    origin_ = grid_->from_object->point(to_object.point(origin_));
    direction_ = grid_->from_object->vector(to_object.vector(direction_));
  }

  // The distance at which the ray is beyond a box, for good.
  float way_out_of(const Bounds& box) const {
    const float lower[3] = {box.lower.x, box.lower.y, box.lower.z},
                upper[3] = {box.upper.x, box.upper.y, box.upper.z},
                from[3] = {origin_.x, origin_.y, origin_.z},
                way[3] = {direction_.x, direction_.y, direction_.z};
    float out = INFINITY;
    for (int a = 0; a < 3; ++a)
      if (way[a] != 0) out = std::min(out, ((way[a] > 0 ? upper : lower)[a] - from[a]) / way[a]);
    return out + kRounded * std::abs(out);
  }

  // Where the ray is: a cell of the grid, or what lies before or behind it.
  void enter_cell() {
    const Vec3 p = origin_ + direction_ * at_, cell = grid_->cell();
    const float lower[3] = {grid_->bounds.lower.x, grid_->bounds.lower.y, grid_->bounds.lower.z};
    const float size[3] = {cell.x, cell.y, cell.z}, place[3] = {p.x, p.y, p.z},
                way[3] = {direction_.x, direction_.y, direction_.z};
    int i[3];
    bool outside = false;
    float end = INFINITY, until = INFINITY;
    for (int a = 0; a < 3; ++a) {
      const float high = lower[a] + size[a] * static_cast<float>(grid_->size[a]);
      const float x = size[a] > 0 ? (place[a] - lower[a]) / size[a] : 0;
      // On the border between two cells it is in the one it goes to.
      i[a] = static_cast<int>(std::floor(x + (way[a] > 0 ? 1e-4f : -1e-4f)));
      // What is flat has no inside: within it a ray would go on by no distance at all, for ever.
      if (i[a] < 0 || i[a] >= grid_->size[a] || !(size[a] > 0)) outside = true;
      if (way[a] == 0) continue;
      const float border = way[a] > 0 ? lower[a] + size[a] * static_cast<float>(i[a] + 1)
                                      : lower[a] + size[a] * static_cast<float>(i[a]);
      end = std::min(end, (border - origin_[a]) / way[a]);
      // Beyond the grid: as far as its next side
      for (const float side : {lower[a], high}) {
        const float t = (side - origin_[a]) / way[a];
        if (t > at_) until = std::min(until, t);
      }
    }
    const float most =
        outside ? grid_->outside
                : grid_->most[(static_cast<size_t>(i[2]) * grid_->size[1] + i[1]) * grid_->size[0] +
                              i[0]];
    bound_ = most * density_;
    const float least = std::nextafter(at_ + 1e-6f * std::abs(at_), INFINITY);
    end_ = std::min(std::max(outside ? until : end, least), far_);
  }

  const Grid* grid_;
  Vec3 origin_, direction_;
  float density_, at_, far_, end_ = 0, bound_ = 0;
  bool homogeneous_ = false;
};

Rgb Media::transmittance(const MediumStack& stack, const Vec3& origin, const Vec3& direction,
                         float near, float far, const RayInfo& ray, Random& random) const {
  Rgb through{1, 1, 1};
  if (!(far > near)) return through;
  for (const uint16_t r : stack) {
    const Region& region = regions_[r];
    if (region.homogeneous) {
      through *= attenuation(region.point.extinction(), far - near);
      continue;
    }
    Walk walk(scene_, region, origin, direction, near, far, ray.time);
    for (int i = 0;; ++i) {
      const float t = walk.next(random.next());
      if (!(t < far)) break;
      if (i == kMostCollisions) return {};
      const Rgb extinction = run(region, origin + direction * t, -direction, ray).extinction();
      through *= Rgb{1, 1, 1} - extinction / walk.bound();
      const float left = max_abs(through);
      if (left >= kFaint) continue;
      if (random.next() >= 0.5f || left == 0) return {};
      through *= 2;
    }
  }
  return through;
}

Rgb Fading::at(float distance) const {
  const auto after = std::upper_bound(steps.begin(), steps.end(), distance,
                                      [](float t, const Step& step) { return t < step.from; });
  const Rgb left = after == steps.begin() ? Rgb{1, 1, 1} : std::prev(after)->left;
  return left * attenuation(extinction, distance - near);
}

Fading Media::fading(const MediumStack& stack, const Vec3& origin, const Vec3& direction,
                     float near, float far, const RayInfo& ray, Random& random) const {
  Fading out;
  out.near = near;
  std::vector<Fading::Step> factors;
  for (const uint16_t r : stack) {
    const Region& region = regions_[r];
    if (region.homogeneous) {
      out.extinction += region.point.extinction();
      continue;
    }
    Walk walk(scene_, region, origin, direction, near, far, ray.time);
    Rgb own{1, 1, 1};
    for (int i = 0; max_abs(own) > 0; ++i) {
      const float t = walk.next(random.next());
      if (!(t < far)) break;
      const Rgb extinction = run(region, origin + direction * t, -direction, ray).extinction();
      Rgb factor = Rgb{1, 1, 1} - extinction / walk.bound();
      if (i == kMostCollisions) factor = {};
      if (max_abs(own * factor) < kFaint) factor *= random.next() < 0.5f ? 2.0f : 0.0f;
      own *= factor;
      factors.push_back({t, factor});
    }
  }
  std::sort(factors.begin(), factors.end(),
            [](const Fading::Step& a, const Fading::Step& b) { return a.from < b.from; });
  Rgb left{1, 1, 1};
  out.steps.push_back({near, left});
  for (const Fading::Step& step : factors) {
    left *= step.left;
    out.steps.push_back({step.from, left});
    if (!(max_abs(left) > 0)) break;
  }
  return out;
}

StraightWay Media::straight_way(const MediumPoint& medium, float length, const Rgb& scattered) {
  StraightWay way;
  const Rgb extinction = medium.extinction();
  way.through = attenuation(extinction, length);
  if (!is_black(medium.emission)) {
    const auto emitted = [&](float e, float c, float t) {
      return e <= 0                  ? 0
             : c * length > 1e-4f    ? e * (1 - t) / c
             : std::isfinite(length) ? e * length
                                     : 0;
    };
    way.emission = {emitted(medium.emission.x, extinction.x, way.through.x),
                    emitted(medium.emission.y, extinction.y, way.through.y),
                    emitted(medium.emission.z, extinction.z, way.through.z)};
  }
  const Rgb may = absolute(scattered) * medium.scattering;
  const float all = may.x + may.y + may.z;
  if (!(all > 0)) return way;
  way.chance = may / all;
  way.scatters = Rgb{1, 1, 1} - way.through;
  return way;
}

namespace {

// Where a path scatters that does so for sure, drawn by one channel and weighted as drawn by any of
// them; chances: of each channel to draw, and that it scatters at all.
Flight scatter_by(int channel, const Rgb& chances, const MediumPoint& medium, const Rgb& through,
                  float near, float far, FlightNumbers numbers) {
  const Rgb extinction = medium.extinction();
  const float c = extinction[channel], inside = 1 - through[channel];
  const float t = std::min(-std::log1p(-numbers.rest() * inside) / c, far - near);
  const Rgb there = attenuation(extinction, t);
  float p = 0;
  for (int k = 0; k < 3; ++k)
    if (extinction[k] > 0 && through[k] < 1)
      p += chances[k] * extinction[k] * there[k] / (1 - through[k]);
  Flight flight;
  flight.scatters = true;
  flight.distance = near + t;
  flight.weight = p > 0 && std::isfinite(p) ? there / p : Rgb{};
  flight.point = medium;
  return flight;
}

int drawn(const Rgb& chance, float u) {
  int channel = 0;
  for (; channel < 2 && u >= chance[channel]; ++channel) u -= chance[channel];
  return channel;
}

}  // namespace

Flight Media::scatter_on(const StraightWay& way, const MediumPoint& medium, float near, float far,
                         FlightNumbers numbers) {
  const Rgb all = way.chance * way.scatters, chance = all / (all.x + all.y + all.z);
  return scatter_by(drawn(chance, numbers.random.next()), chance, medium, way.through, near, far,
                    numbers);
}

// One distance for all of a medium that is the same everywhere.
Flight Media::fly_straight(const MediumPoint& medium, float near, float far, const Rgb& scattered,
                           FlightNumbers numbers) const {
  const StraightWay way = straight_way(medium, far - near, scattered);
  Flight flight;
  flight.emission = way.emission;
  if (is_black(way.chance)) {
    flight.weight = way.through;
    return flight;
  }
  const int channel = drawn(way.chance, numbers.random.next());
  if (!numbers.decide(way.scatters[channel])) {
    const float p = dot(way.chance, Rgb{1, 1, 1} - way.scatters);
    flight.weight = p > 0 ? way.through / p : Rgb{};
    return flight;
  }
  Flight found =
      scatter_by(channel, way.chance * way.scatters, medium, way.through, near, far, numbers);
  found.emission = flight.emission;
  return found;
}

Flight Media::fly(const MediumStack& stack, const Vec3& origin, const Vec3& direction, float near,
                  float far, const Rgb& scattered, const Rgb& passing, const RayInfo& ray,
                  FlightNumbers numbers) const {
  if (!(far > near)) return {};
  if (const auto medium = homogeneous(stack))
    return fly_straight(*medium, near, far, scattered, numbers);
  Random& random = numbers.random;
  Flight flight;
  std::array<std::optional<Walk>, MediumStack::kMost> walks;
  std::array<float, MediumStack::kMost> next;
  size_t count = 0;
  const uint16_t* const regions = stack.begin();
  for (const uint16_t r : stack) {
    walks[count].emplace(scene_, regions_[r], origin, direction, near, far, ray.time);
    next[count] = walks[count]->next(numbers.last());
    ++count;
  }
  for (int i = 0; i < kMostCollisions; ++i) {
    const size_t k =
        static_cast<size_t>(std::min_element(next.begin(), next.begin() + count) - next.begin());
    const float t = next[k];
    if (!(t < far)) return flight;
    const Region& region = regions_[regions[k]];
    const Vec3 x = origin + direction * t;
    MediumPoint point = region.homogeneous ? region.point : run(region, x, -direction, ray);
    const float bound = walks[k]->bound();
    flight.emission += flight.weight * point.emission / bound;
    const Rgb null = Rgb{bound, bound, bound} - point.extinction();
    const float scatters = max_abs(scattered * flight.weight * point.scattering),
                passes = max_abs(passing * flight.weight * null), all = scatters + passes;
    if (!(all > 0)) {  // all of it is absorbed here
      flight.weight = {};
      return flight;
    }
    if (random.next() * all < scatters) {
      flight.scatters = true;
      flight.distance = t;
      flight.weight *= all / (bound * scatters);
      flight.point = point;
      return flight;
    }
    flight.weight *= null * (all / (bound * passes));
    next[k] = walks[k]->next(random.next());
  }
  flight.weight = {};
  return flight;
}

}  // namespace photon_splat
