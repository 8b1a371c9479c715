// A camera path while it is traced, for the files that trace it.
#pragma once

#include "integrators/camera_tracer.h"
#include "media/media.h"

namespace photon_splat {

// Paths of little throughput go on with a probability of this times their throughput.
inline constexpr float kRoulette = 8;
// The same factor at the first vertex: what a dark surface mirrors is most of what is seen there
inline constexpr float kFirstRoulette = 100;
inline constexpr int kSureBounces = 3;  // from here on with the root of their throughput
// Light samples hardly find the lamps that such rays meet, those of mirrors or of more than this
// density (1/sr): dark paths take so many times as many of these rays as go on from what they meet
inline constexpr float kNarrow = 4, kSights = 8;

// Dimensions of the camera's low-discrepancy sequence, in pairs.
enum Dimension : uint32_t {
  kFilterPair,
  kChoicePair,
  kLightPair,
  kBsdfPair,
  kLobePair,
  kSkyPair,
  kMediumPair,
  kMediumPlacePair,
  kBelowPair,
  kAmbientPair,
  kFlightPair,
  kExitPairs = 16,  // from here on those of the vertex where a path leaves from below
  kWalkPairs = 32,  // of a walk
  kWalkEnd = 48,
  kLensPair = 64,
  kTimePair = 65
};

// The camera rays of a pixel's samples. Its place in the whole frame seeds them, so that a border
// renders the same pixels.
class PixelRays {
 public:
  PixelRays(const Scene& scene, const Camera& camera, int x, int y, uint32_t seed)
      : camera_(camera), shutter_(scene.shutter), x_(x), y_(y) {
    const CameraSettings& c = camera.settings();
    const uint32_t column = static_cast<uint32_t>(x + c.x0), row = static_cast<uint32_t>(y + c.y0);
    seed_ = hash_combine(seed, row * c.width + column);
    down_ = 1 - static_cast<float>(row) / static_cast<float>(c.height);
  }
  uint32_t seed() const { return seed_; }
  float time(uint32_t sample) const {
    return shutter_.blurs() ? shutter_.time(sobol_2d(sample, kTimePair, seed_).x, down_)
                            : kShutterCentre;
  }
  // Through the middles of the pixel and of the lens: as still as what is seen moves.
  std::optional<CameraRay> central_ray(float time) const {
    return camera_.ray(x_, y_, {0.5f, 0.5f}, {0.5f, 0.5f}, time);
  }
  // None outside the lens' image
  std::optional<CameraRay> ray(uint32_t sample, float time) const {
    return camera_.ray(x_, y_, sobol_2d(sample, kFilterPair, seed_),
                       sobol_2d(sample, kLensPair, seed_), time);
  }

 private:
  const Camera& camera_;
  const Shutter& shutter_;
  int x_, y_;
  uint32_t seed_;
  float down_;  // share of the picture's height above the pixel
};

// What keeps light back that Lights::blocked_exactly() asks for.
inline RayMask exact_blockers(const RayInfo& ray) {
  return ray.catchers_only ? kCatcherRays : kAllRays;
}

inline void add_finite(Rgb& sum, const Rgb& value, uint64_t& bad) {
  if (can_be_added(value))
    sum += value;
  else
    ++bad;
}

// Of samples' light.
struct Moments {
  double sum = 0, squares = 0;
  void add(double x) { sum += x, squares += x * x; }
  double variance(uint32_t count) const {
    return count < 2 ? 0 : std::max(squares - sum * sum / count, 0.0) / (count - 1);
  }
};

// A camera path on its way. It scatters at vertices 0, 1, ...; transparent surfaces that it passes
// are none.
struct CameraTracer::Path {
  Path(const CameraRay& camera_ray, Pixel& p, Tile& t, uint32_t index, uint32_t sample_number,
       uint32_t pixel_seed, float time)
      : ray(camera_ray),
        pixel(p),
        tile(t),
        pixel_index(index),
        sample(sample_number),
        seed(pixel_seed),
        origin(ray.origin),
        direction(ray.direction),
        near(ray.near),
        far(ray.far),
        random(sample, seed) {
    info.from = near;
    info.time = from.time = time;
  }

  const CameraRay& ray;
  Pixel& pixel;
  Tile& tile;
  uint32_t pixel_index, sample, seed;
  uint32_t first_pair = 0;           // of the numbers of vertex 0
  size_t place = 0;                  // of the pixel in its tile
  EvenNumber even_way, even_flight;  // of the first of the numbers of way(), and of flight()
  int max_bounces = 0;
  Rgb* groups = nullptr;       // the pixel's light by group, if wanted
  bool learns = false;         // what it sees of the world is noted
  int gather_bounces = 0;      // times that it went on for light that photons were to bring
  int diffuse_bounces = 0;     // those of them by a diffuse lobe
  bool tries_density = false;  // see CameraTracer::Trial
  bool tries_beams = false;    // see try_media()
  bool after_medium = false;   // it has scattered where beams may bring all light
  bool deep = false;           // the ray on its way brings light that photons would bring
  bool badly_served = false;   // because they would bring it badly
  bool caught = false;         // it has met a shadow catcher and is one of two from there on
  // Photons bring the diffuse part of the light; else the path goes on for it
  bool leaves_gather_points = false;
  bool reads_light = false;    // from a viewport's cache, wherever that holds it
  bool only_mirrored = false;  // at the last vertex: diffuse light was read there
  bool only_turned = false;    // it seeks a mirror whose normal has turned towards it

  Vec3 origin, direction;
  float near, far;
  RayInfo info{};
  RayInfo before{};   // of the ray that met the last vertex
  int vertex = 0;     // number of the next scattering
  MediumStack media;  // around the ray
  // Before it, straight through glass that bends nothing: vertex 0 is not what the pixel shows
  // first
  bool through_glass = false;
  bool passed_layer = false;  // what it meets next may lie where it passed the last surface
  // All that it was scattered by is glass that a transparent film takes for clear
  bool clear = true;
  float travelled = 0;               // up to the last vertex
  Rgb throughput{1, 1, 1};           // of light that leaves the next vertex, emission excepted
  Rgb emission_throughput{1, 1, 1};  // of its emission
  Rgb diffuse_emission{};            // the part of that which the diffuse lobes of vertex 0 sent on
  // The part of throughput that photons cover: light that meets nothing but sharp lobes from here
  // on
  Rgb covered{};
  Rgb withheld{};  // of emission_throughput: what photons bring of it
  // The parts of both that the diffuse lobes of vertex 0 sent on
  Rgb covered_diffuse{}, withheld_diffuse{};
  // What is more than throughput, and than emission_throughput, of the light of a world that comes
  // by paths alone
  Rgb world_throughput{}, world_emission{};
  // What sent the light that is still to come to the camera: diffuse lobes this part of it, others
  // the rest. One of the two is drawn for gather points.
  Rgb diffuse_part{};
  LobeCategory beside = LobeCategory::kGlossy, category = LobeCategory::kDiffuse;
  // What mirrors on the way leave of a denoiser's features, which are still to come, and the normal
  // of the first one
  Rgb features{1, 1, 1};
  bool shows_features = true, shows_normal = true;
  Vec3 mirror_normal{};
  // What media leave to what is behind them, of normals, and of the alpha that is still to come
  float behind = 1, shown = 1;
  // The last vertex
  Receiver from{{}, {}, true, ~uint64_t{0}, nullptr, 1, ray_bit(RayInfo::kCamera)};
  float pdf = INFINITY;  // of the direction, by its BSDF
  float survives = 1;    // chance to go on from the next surface, whose emission counts anyhow
  Random random;

  // Whether photons would bring the light from where it is now.
  bool is_beyond() const {
    return tries_beams ? after_medium : tries_density ? diffuse_bounces > 0 : gather_bounces > 1;
  }
  void scale(const Rgb& factor) {
    throughput *= factor;
    emission_throughput *= factor;
    diffuse_emission *= factor;
    covered *= factor;
    withheld *= factor;
    covered_diffuse *= factor;
    withheld_diffuse *= factor;
    world_throughput *= factor;
    world_emission *= factor;
    features *= factor;
  }
  // False, and counted, where what it carries is no number.
  bool is_sound() {
    if (is_finite(throughput) && is_finite(emission_throughput) && is_finite(world_throughput) &&
        is_finite(world_emission))
      return true;
    ++tile.bad_samples;
    return false;
  }
  // The chance to go on, for a path of that throughput. The root keeps the work of deep paths in
  // bounds, and what they bring too: a path of throughput t that goes on is worth sqrt(t) then, and
  // not 1, when it meets a lamp.
  float survival(float strength) const {
    return std::min(1.0f, vertex < kSureBounces ? strength * kRoulette : std::sqrt(strength));
  }
  // What diffuse lobes of vertex 0 sent on of the light that photons leave to the path.
  Rgb diffuse_part_of(const Rgb& all, const Rgb& brought, const Rgb& brought_diffuse) const {
    if (is_zero(brought)) return diffuse_part;
    return min(divided(max(all * diffuse_part - brought_diffuse, {}), all - brought), Rgb{1, 1, 1});
  }
  // Ends the path with a chance of 1 - `chance`: true then.
  bool ends(float chance) {
    if (random.next() >= chance) return true;
    scale(Rgb{1, 1, 1} / chance);
    return false;
  }
  // Numbers for the next vertex: the low-discrepancy sequence at the first one.
  Vec2 numbers(Dimension pair) {
    return vertex == 0 ? sobol_2d(sample, first_pair + pair, seed) : random.next2();
  }
  // The numbers that place the direction of the next ray. Before the first vertex they also decide
  // whether surfaces let the path through, so that paths that stay, and paths that pass, are spread
  // as evenly as all of them are.
  Vec2 way() {
    const Vec2 u = numbers(kBsdfPair);
    return vertex > 0 ? u : Vec2{even_way.rest(u.x, random), u.y};
  }
  bool passes(float probability) {
    if (vertex > 0) return random.next() < probability;
    return !even_way.decide(numbers(kBsdfPair).x, 1 - probability, random);
  }
  // At the place where the path leaves a body, which is its vertex: others than where it entered.
  void take_numbers_of_exit() {
    first_pair = kExitPairs;
    even_way = even_flight = {};
  }
  // What decides how far the path gets in media on its way to the next vertex.
  FlightNumbers flight() {
    return vertex == 0 ? FlightNumbers(random, even_flight, numbers(kFlightPair).x) : random;
  }
};

}  // namespace photon_splat
