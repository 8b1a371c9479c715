// The media of a scene: what their programs say at a point, how far light gets in them, and where a
// path scatters. Nothing here marches in steps: distances are drawn, exactly where a medium is the
// same everywhere, else by tracking against a bound of the extinction (null collisions: Kutz et
// al., Spectral and Decomposition Tracking for Rendering Heterogeneous Volumes, 2017). Where a
// bound is too low the estimate is still right, as weights then take either sign.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "math/even_number.h"
#include "media/medium.h"
#include "scene/crossings.h"
#include "scene/scene.h"

namespace photon_splat {

// What a path meets on its way through media, up to a surface.
struct Flight {
  bool scatters = false;
  float distance = 0;  // where it scatters
  // Transmittance up to there or to the end of the way, over the chance to get there. Without the
  // scattering coefficient.
  Rgb weight{1, 1, 1};
  Rgb emission{};     // of the way, attenuated
  MediumPoint point;  // where it scatters
};

// A way through a medium that is the same everywhere.
struct StraightWay {
  Rgb through;     // transmittance
  Rgb emission{};  // of the way, attenuated
  // Probability of each channel to draw where a path scatters, by what it may carry there, and to
  // scatter on the way then
  Rgb chance{}, scatters{};
};

// Random numbers of a flight, the first of which may be spread evenly over those of a pixel.
struct FlightNumbers {
  FlightNumbers(Random& all) : random(all) {}
  FlightNumbers(Random& all, EvenNumber& even, float u) : random(all), even_(&even), u_(u) {}

  Random& random;
  bool decide(float probability) {
    return even_ ? even_->decide(u_, probability, random) : random.next() < probability;
  }
  float rest() const { return even_ ? even_->rest(u_, random) : random.next(); }
  // rest(), of which nothing is left
  float last() {
    const float u = rest();
    if (even_) even_->use_up();
    return u;
  }

 private:
  EvenNumber* even_ = nullptr;
  float u_ = 0;
};

// What is left of light along a way through media, at each of its points: unbiased there.
class Fading {
 public:
  struct Step {
    float from;  // as far as the next one
    Rgb left;
  };

  Rgb at(float distance) const;
  // Extinction of media that are the same everywhere, on the whole way, 1/m.
  Rgb extinction{};
  // Steps through the other media; the first one is where the way begins.
  std::vector<Step> steps;
  float near = 0;
};

class Media {
 public:
  // Nothing if no material and no world of the scene has a volume. Throws Cancelled.
  static std::unique_ptr<Media> of(const Scene& scene, ThreadPool& pool, const CancelFlag& cancel);

  // Region of the volume behind a surface; -1: none.
  int region_of(uint32_t instance, uint32_t triangle) const;
  // A path goes through a surface, and through those of other media that lie in it. Where it goes
  // back through the same object's within the gap, at the rim of a thing, it is where it was.
  void cross(MediumStack& stack, const Surface& s, const Gap& gap, float time) const {
    const int region = region_of(s.instance, s.triangle);
    if (region >= 0 && goes_through(region, s, gap, time)) stack.cross(region, s.back);
    if (!touching_) return;
    for (const Touching& other : touching(s, gap, time)) stack.cross(other.region, other.back);
  }
  // Where a surface that is there for its medium alone lies in another one, a ray meets that one,
  // whichever Embree finds first, and stays in the media that it is in.
  void meet_touched(Surface& s, const Vec3& origin, const Vec3& direction, RayMask kinds,
                    float time) const {
    if (touching_ && !s.on_strand() && is_clear(s.instance, s.triangle))
      look_for_touched(s, origin, direction, kinds, time);
  }
  // Which media a point lies in, as a ray upwards tells.
  MediumStack around(const Vec3& x, float time = kShutterCentre) const;
  // The media of a stack that are shadow catchers' or the world's.
  MediumStack of_catchers(const MediumStack& stack) const;
  // Those that rays of these kinds see: a medium in an object that hides from rays is none to them.
  MediumStack seen(const MediumStack& stack, RayMask kinds) const {
    return hides_ ? visible_part(stack, kinds) : stack;
  }
  bool emits() const { return emits_; }
  bool scatters() const { return scatters_; }
  // Whether a medium fills the world that lets none of the light of suns and of the world through.
  bool stops_far_light() const {
    if (world_ < 0 || !regions_[world_].homogeneous) return false;
    const Rgb c = regions_[world_].point.extinction();
    return std::min({c.x, c.y, c.z}) > 0;
  }
  // Whether some object with a medium hides from some rays.
  bool hides() const { return hides_; }
  // Whether some scatter what is seen and let straight light pass as if they were not there.
  bool hides_from_shadows() const { return hides_from_shadows_; }
  // Light group of what media of the stack emit: that of the one entered first of those that do.
  int16_t light_group_of(const MediumStack& stack) const;
  // Whether some of them are the same everywhere.
  bool any_homogeneous() const {
    return std::any_of(regions_.begin(), regions_.end(),
                       [](const Region& region) { return region.homogeneous; });
  }

  // All that media of the stack do there.
  MediumPoint at(const MediumStack& stack, const Vec3& x, const Vec3& wo, const RayInfo& ray) const;
  // All of them together, if they are the same everywhere.
  std::optional<MediumPoint> homogeneous(const MediumStack& stack) const;
  // Unbiased. `far` may be infinite.
  Rgb transmittance(const MediumStack& stack, const Vec3& origin, const Vec3& direction, float near,
                    float far, const RayInfo& ray, Random& random) const;
  // The transmittance for all distances up to `far` at once.
  Fading fading(const MediumStack& stack, const Vec3& origin, const Vec3& direction, float near,
                float far, const RayInfo& ray, Random& random) const;
  // `scattered`, `passing`: throughput of what scatters on the way and of what comes to its end, by
  // which channels and collisions are chosen.
  static StraightWay straight_way(const MediumPoint& medium, float length, const Rgb& scattered);
  // Scatters on that way, which has a chance to.
  static Flight scatter_on(const StraightWay& way, const MediumPoint& medium, float near, float far,
                           FlightNumbers numbers);
  Flight fly(const MediumStack& stack, const Vec3& origin, const Vec3& direction, float near,
             float far, const Rgb& scattered, const Rgb& passing, const RayInfo& ray,
             FlightNumbers numbers) const;

 private:
  // Bounds of a heterogeneous medium's extinction in the cells of a grid, 1/m at a density of 1.
  struct Grid {
    // From the coordinates of the object to those of the grid, if they are not the world's
    std::optional<Affine> from_object;
    Bounds bounds;
    // Of the mesh that is around volume grids, which is closed: a ray that has found the way in and
    // not the way out, at its rim, has left it there all the same.
    std::optional<Bounds> closed;
    int size[3] = {1, 1, 1};
    std::vector<float> most;
    float outside = 0;  // beyond the bounds
    Vec3 cell() const;
    float spread(const std::vector<float>& seen);
  };
  struct Region {
    uint32_t instance = ShadingPoint::kNoInstance;  // that: the world
    int program = -1;
    float density = 1;  // coefficients over what the program says
    bool homogeneous = false;
    MediumPoint point;                 // where that is so
    std::shared_ptr<const Grid> grid;  // else
  };
  // What the instances of a mesh share that has volume grids and a program which depends on nothing
  // else.
  struct Shared {
    uint32_t mesh;
    int program;
    std::shared_ptr<const Grid> grid;
  };
  class Walk;

  // A region whose surface lies in another one.
  struct Touching {
    int region;
    bool back;
  };
  struct TouchingList {
    std::array<Touching, Crossings::kMost> met;
    size_t count = 0;
    const Touching* begin() const { return met.data(); }
    const Touching* end() const { return met.data() + count; }
  };

  explicit Media(const Scene& scene) : scene_(scene) {}
  size_t slot_of(uint32_t instance, uint32_t triangle) const;  // of Scene::slot_materials
  // Whether its surface is there for its medium alone.
  bool is_clear(uint32_t instance, uint32_t triangle) const {
    return clear_slot_[slot_of(instance, triangle)];
  }
  bool is_clear(const Program& program) const;
  TouchingList touching(const Surface& s, const Gap& gap, float time) const;
  void look_for_touched(Surface& s, const Vec3& origin, const Vec3& direction, RayMask kinds,
                        float time) const;
  void find_touching(ThreadPool& pool, const CancelFlag& cancel);
  bool touches(uint32_t instance, uint32_t samples) const;
  bool goes_through(int region, const Surface& s, const Gap& gap, float time) const;
  int add_region(uint32_t instance, int program, ThreadPool& pool, const CancelFlag& cancel);
  MediumPoint run(const Region& region, const Vec3& x, const Vec3& wo, const RayInfo& ray) const;
  void bound(Region& region, ThreadPool& pool, const CancelFlag& cancel);
  Grid look_around(const Region& region, ThreadPool& pool, const CancelFlag& cancel) const;
  Grid look_at_grids(const Region& region, bool alone, ThreadPool& pool,
                     const CancelFlag& cancel) const;
  Flight fly_straight(const MediumPoint& medium, float near, float far, const Rgb& scattered,
                      FlightNumbers numbers) const;

  const Scene& scene_;
  std::vector<Region> regions_;
  std::vector<Shared> shared_;
  std::vector<int16_t> of_slot_;     // of Scene::slot_materials, -1: none
  std::vector<uint8_t> clear_slot_;  // likewise
  int world_ = -1;
  MediumStack visible_part(const MediumStack& stack, RayMask kinds) const;

  bool in_meshes_ = false, emits_ = false, scatters_ = false;
  bool touching_ = false;  // some medium's surface lies in another surface
  bool hides_from_shadows_ = false;
  bool hides_ = false;  // some object with a medium does from some rays
};

}  // namespace photon_splat
