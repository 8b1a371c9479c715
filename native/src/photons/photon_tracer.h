// Photons: where light arrived on a diffuse surface after at least one bounce.
#pragma once

#include <optional>
#include <span>

#include "density/surface_filter.h"
#include "lights/emission/photon_emitter.h"
#include "media/media.h"
#include "photons/homing.h"
#include "photons/photon_join.h"
#include "photons/photon_paths.h"
#include "scene/camera.h"

namespace photon_splat {

class SeenPlaces;

struct PhotonCounts {
  uint64_t traced = 0, stored = 0, rays = 0;
  uint64_t shaded = 0;  // surfaces met whose programs ran

  PhotonCounts& operator+=(const PhotonCounts& other) {
    traced += other.traced, stored += other.stored, rays += other.rays, shaded += other.shaded;
    return *this;
  }
};

// Light that came through sharp lobes only, from the light to where it lands, makes caustics: it
// wants narrow kernels and photons aimed at what focuses it. A path's share in them is the product
// of its lobes' sharpness, which falls from 1 to 0 over a range of roughness: caustic photons carry
// this share of the path's power, indirect ones the rest.
enum class PhotonStream : uint8_t { kAll, kIndirect, kCaustic };

// A medium that fills the world is looked at so far, in radii of what is in it.
inline constexpr float kWorldReach = 32;

// See choose_variant().
BounceKernel choose_bounce_kernel(const std::string& name = {});

// Traces photon paths first .. first + count - 1 of the stream `seed` and returns what they left on
// surfaces of `visible`. Powers are those of a set of `total` paths. Their order follows the index,
// not the thread.
class PhotonTracer {
 public:
  PhotonTracer(Scene& scene, const Lights& lights, int max_bounces, PhotonStream stream)
      : scene_(scene),
        lights_(lights),
        emitter_(lights),
        max_bounces_(max_bounces),
        stream_(stream),
        bounce_(choose_bounce_kernel()) {}

  const Photons& trace(uint64_t first, uint64_t count, double total, uint32_t seed,
                       const SurfaceFilter& visible, const CancelFlag& cancel);
  // Who is to see what the photons leave: Bump looks as far apart as that one's samples are wide
  // (nullptr: nobody in particular).
  void set_viewer(const Camera* viewer) { viewer_ = viewer; }
  void set_max_bounces(int count) { max_bounces_ = count; }  // after which paths end
  // Makes light_groups() tell the light group of each photon traced last; else it is empty.
  void keep_light_groups() { keeps_groups_ = true; }
  const std::vector<int16_t>& light_groups() const { return join_.groups(); }
  // Makes photons leave beams in media instead of themselves on surfaces, for camera paths that
  // scatter in a medium: those of indirect light only in media that are the same everywhere.
  void leave_beams(BeamLight light) {
    beams_ = light;
    receiver_kind_ = RayInfo::kVolume;
  }
  // What the paths traced last have left, in their order.
  const std::vector<PhotonBeam>& beams() const { return join_.beams(); }
  const PhotonCounts& counts() const { return counts_; }
  const PhotonCounts& last_counts() const { return last_counts_; }  // of the last trace()

  // Traces pilots and learns from them where photons that end on visible surfaces start. Guided
  // emission is taken up only where few unguided paths are of use; where not, the pilot's photons
  // are as good as those of any other paths, and are returned (null otherwise; valid until the next
  // trace()). Caustic photons are aimed at what can focus light instead. `stored`: surfaces whose
  // photons are returned, all visible ones among them. `places`: where on visible surfaces photons
  // are of use (nullptr: everywhere).
  const Photons* learn_emission(uint64_t paths, uint32_t seed, const SurfaceFilter& visible,
                                const SurfaceFilter& stored, const SeenPlaces* places,
                                const CancelFlag& cancel);
  // The same once more where it is known by now that more is visible: one pilot that the guide has
  // drawn tells the rest, and its photons are returned.
  const Photons* learn_more_emission(uint64_t paths, uint32_t seed, const SurfaceFilter& visible,
                                     const SurfaceFilter& stored, const SeenPlaces* places,
                                     const CancelFlag& cancel);
  bool guided() const { return guide_.has_value() || targets_.has_value(); }

 private:
  static constexpr uint32_t kStartsAtOnce = SobolPair::kMost;

  // What seldom matters of a path between two of its rays.
  struct Rest {
    uint32_t place;       // among the chunk's paths as they started
    float travelled = 0;  // before the present ray, since the last bounce
    uint16_t passed = 0;  // transparent surfaces
    // Where a lamp that faces its receivers lights them, after PhotonStart::soft_nearest
    float soft_from = 0, soft_to = INFINITY;
    // Kind of the camera path's ray that looks back along this one, where `guessed`: see
    // scatter_by_program.
    RayInfo::Kind kind = RayInfo::kDiffuse;
    bool guessed = false;
    bool unshadowed = false;   // passed what would have blocked the light of another lamp
    MediumStack media;         // around its present ray
    uint16_t left_normal = 0;  // of the surface where that began, as PhotonBeam::begin
    float time = kShutterCentre;
    uint32_t left = 0;  // Surface::mark of where its present ray starts
  };
  // All of it.
  struct Path : Rest {
    Rgb power;
    float reference;  // power that survivors of Russian roulette keep
    Random random{0, 0};
    uint16_t bounces = 0;  // lobes
    float caustic = 1;     // share of caustic light
    // Share of light that panes let pass which lie in the surface that it meets: as if that were
    // painted with them, they take of what it sends on and not of what comes to it
    Rgb painted{1, 1, 1};
    // One more way than those that surfaces draw, to what is seen; where one may be
    Towards towards{};
    bool homes = false;  // it went there
  };
  // The paths of a chunk on their way; a worker's own, so that it stays in its cache from chunk to
  // chunk.
  struct Travellers {
    std::vector<PhotonStart> starts;  // of all
    PhotonPaths paths{};              // those that are left
    std::array<Rest, PhotonPaths::kSpace> rest;
    struct Waiting {
      Path path;
      Vec3 origin, direction;
    };
    std::vector<Waiting> more;  // ways of paths that have split: they go on with the others' next
    // By path as they started, where that is to be learnt: squared powers of what is of use
    std::vector<float> brought;
    std::vector<PathWorth::Stop> stops;

    Path take(uint32_t i) const;
    unsigned in_media(uint32_t begin, uint32_t count) const;
    void put(uint32_t i, const Path& path, const Vec3& origin, const Vec3& direction, bool alone);
  };
  // Where a path's next direction comes from.
  struct Draws {
    const SobolPair& first_bounce;
    uint32_t index;  // of the path

    Vec2 next(Path& path) const {
      return path.bounces == 0 ? first_bounce.at(index) : path.random.next2();
    }
  };
  // What each path has stored, of what `filter` and `places` let pass where there are any: the
  // number of photons, which diffuse surfaces leave all alike, times the path's squared power over
  // the mean one's; of a caustic path the sum of their squared powers over its own at the start.
  struct Usefulness {
    const SurfaceFilter* filter = nullptr;
    const SeenPlaces* places = nullptr;
    bool counts(const Photon& photon) const;
    std::vector<float> of_path;  // from the first one traced
  };
  const Photons& trace(uint64_t first, uint64_t count, double total, uint32_t seed,
                       const SurfaceFilter& visible, const CancelFlag& cancel, Usefulness* useful);
  // Paths `first` and on, of `total` in all; what of theirs is of use goes into `useful`, if that
  // is asked for.
  struct Chunk {
    uint64_t first;
    uint32_t count;
    double total;
    uint32_t seed;
    const SurfaceFilter& visible;
    const Usefulness* filter;
    float* useful;  // by path
    Travellers& travellers;
    PhotonRun& run;
    SobolPair first_bounce;
    uint32_t alive = 0, kept = 0;  // paths whose rays are traced, and those that go on so far
  };
  uint32_t start_all(const Chunk& c) const;
  void trace_chunk(Chunk& c) const;
  void advance(Chunk& c, uint32_t begin, const RayHits& hits, unsigned met,
               const BounceSettings& settings) const;
  void advance_alone(Chunk& c, uint32_t i, const RayHits& hits, uint32_t k, bool there) const;
  unsigned bounce_together(const PhotonPaths& paths, uint32_t begin, const RayHits& hits,
                           unsigned met, PlainSurfaces& surfaces) const;
  // The stream's share of a path with that share of caustic light.
  float share_of(float caustic) const {
    return stream_ == PhotonStream::kAll       ? 1
           : stream_ == PhotonStream::kCaustic ? caustic
                                               : 1 - caustic;
  }
  double useful_share(std::span<const float> use) const;
  // Aims at the spheres as a pilot teaches; the share of its paths that were of use.
  double aim(std::vector<EmissionTargets::Sphere> spheres, uint64_t paths, uint32_t seed,
             const SurfaceFilter& visible, const SeenPlaces* places, const CancelFlag& cancel);
  const Photons& teach_guided(uint64_t first, uint64_t paths, uint32_t seed,
                              const SurfaceFilter& stored, Usefulness& useful,
                              const CancelFlag& cancel);
  void teach(EmissionGuide& guide, const EmissionGuide* drawn_by, uint64_t first, uint32_t seed,
             std::span<const float> useful) const;
  float use_of(const Photon& photon, const PhotonStart& start, double total) const;
  float use_of(const PhotonBeam& beam, const PhotonStart& start, double total) const;
  float power_of_use(const PhotonBeam& beam) const;
  void learn_worth();
  bool goes_alone(const Path& path, const PhotonStart& start) const {
    return path.bounces == 0 || path.guessed || ~start.max_bounces || heavy(path);
  }
  bool heavy(const Path& path) const {
    return homing_.heavy(max_component(path.power) * static_cast<float>(total_));
  }
  Towards towards_seen(const Path& path, const Surface& hit) const {
    return homing_.towards(hit.position, hit.ng,
                           max_component(path.power) * static_cast<float>(total_));
  }
  void learn_usual(const Photons& photons, const Usefulness& useful);
  float scatter_diffuse(Path& path, const Vec3& n, const Vec2& u, Vec3& direction) const;
  uint32_t split(Path& path, const Surface& hit, size_t room) const;
  void leave_beam(Chunk& c, uint32_t i, const Surface* hit) const;
  void keep_stops(Chunk& c) const;
  PhotonStart start(uint64_t index, uint32_t seed) const;
  void start(uint64_t first, uint32_t count, uint32_t seed, PhotonStart* starts) const;
  // Whether such rays see the light that the path has just left.
  bool scatters_for(const PhotonStart& start, const Path& path, RayMask rays) const {
    return path.bounces > 0 || start.seen_by & rays;
  }
  // Whether light straight from its lamp arrives at a place, `distance` from where it started.
  bool arrives(const Path& path, const Vec3& place, float distance, const PhotonStart& start) const;
  bool lit(const Path& path, const Surface& hit, const PhotonStart& start) const;
  bool blocks(const Path& path, const Surface& hit, const PhotonStart& start) const;
  std::optional<Surface> layer(const Path& path, const Surface& hit, const Vec3& origin,
                               const Vec3& direction) const;
  std::optional<Surface> seen_twin(const Path& path, const Surface& hit,
                                   const Vec3& direction) const;
  bool shade(Path& path, const Surface& hit, const PhotonStart& start, const Draws& draws,
             const SurfaceFilter& visible, Vec3& origin, Vec3& direction, Photons& photons) const;
  // Whether a light sample looks along the path's present way: it has scattered nowhere.
  static bool straight(const Path& path, const PhotonStart& start) {
    return path.bounces == 0 && !start.by_rays;
  }
  // Of light that has scattered nowhere, the part that comes the way that it has taken, by rays or
  // by light samples. `ray_pdf`: as Lights::ray_share_of_world().
  float share_of_way(const Path& path, const PhotonStart& start, const Receiver& at,
                     float ray_pdf) const {
    if (path.bounces > 0) return 1;
    if (path.unshadowed && start.unshadowed >= 0 && !path.guessed)
      return lights_.unshadowed_share(static_cast<uint32_t>(start.unshadowed), at, -start.direction,
                                      ray_pdf);
    if (!start.shares_with_rays) return 1;
    const float by_rays = lights_.ray_share_of_world(-start.direction, ray_pdf);
    return start.by_rays ? by_rays : 1 - by_rays;
  }
  // Kind of ray that looks back along the path's present way: what it does not see the photon
  // lights and passes.
  static RayInfo::Kind kind_of_way(const Rest& rest, uint32_t bounces) {
    return rest.guessed ? rest.kind : bounces == 0 ? RayInfo::kShadow : RayInfo::kDiffuse;
  }
  RayInfo::Kind kind_that_sees(uint32_t instance) const;
  void choose_kind(Path& path, const Surface& hit) const;
  bool sends_on(Path& path, const Surface& hit) const;
  // The hits among `which` on instances that all rays see.
  unsigned seen_by_all(const RayHits& hits, unsigned which) const;
  RayInfo::Kind guess_kind(Random& random, RayInfo::Kind first, float* chance) const;
  void keep_bounced(Travellers& travellers, uint32_t from, uint32_t to, const Bounced& bounced,
                    uint32_t k) const;
  bool start_in_media(Path& path, const PhotonStart& start) const;
  bool scatters_in_media() const {
    return stream_ != PhotonStream::kCaustic && scene_.scatters_in_media();
  }
  Rgb transmittance_at_lamp(Path& path, float distance, const PhotonStart& start) const;
  enum class InMedium { kPasses, kScattered, kEnds };
  InMedium pass_media(Path& path, float far, const PhotonStart& start, const Draws& draws,
                      Vec3& origin, Vec3& direction) const;
  bool scatter_in_medium(Path& path, const MediumStack& around, const Flight& flight,
                         const PhotonStart& start, const Draws& draws, Vec3& origin,
                         Vec3& direction) const;
  bool pass_before_lamp(Path& path, const Surface& hit, const Vec3& direction,
                        const PhotonStart& start, Vec3& origin) const;
  bool go_straight_on(Path& path, const Surface& hit, const Rgb& weight, Vec3& origin) const;
  void store(const Path& path, const Surface& hit, const Vec3& direction,
             const SurfaceFilter& visible, Photons& photons) const;
  bool light_up(Path& path, const Vec3& place, float distance, const PhotonStart& start) const;
  bool light_up_by_ray(Path& path, const PhotonStart& start, const Rgb& diffuse, bool transmitted,
                       bool delta) const;
  bool go_below(Path& path, const Surface& hit, const Bsdf& bsdf, const RayInfo& ray,
                const Draws& draws, Vec3& origin, Vec3& direction) const;
  struct Vertex;
  struct Passing;
  void look_at(Path& path, Vertex& v) const;
  Passing passing(Path& path, const Vertex& v) const;
  float chance_below(const Bsdf& bsdf) const;
  bool scatter_below(Path& path, const Vertex& v, float below, const Draws& draws, Vec3& origin,
                     Vec3& direction) const;
  std::optional<BsdfSample> sample(Path& path, const Vertex& v, float choice, const Vec2& u) const;
  std::optional<BsdfSample> sample_lobes(Path& path, const Vertex& v, float choice,
                                         const Vec2& u) const;
  std::optional<BsdfSample> sample_sided(Path& path, const Vertex& v, float choice,
                                         const Vec2& u) const;
  bool agrees(const Path& path, const Vertex& v, const BsdfSample& s) const;
  bool take_own_share(Path& path, const Vertex& v, const BsdfSample& s) const;
  bool follow(Path& path, const Vertex& v, const BsdfSample& s, Vec3& origin,
              Vec3& direction) const;
  Bsdf seen_from(const Surface& side, const Vec3& wo, const RayInfo& ray) const;
  Bsdf seen_by_next(const Vertex& v, Surface side, const Vec3& way) const;
  bool scatter_by_program(Path& path, const Surface& hit, const PhotonStart& start,
                          const Draws& draws, const SurfaceFilter& visible, Vec3& origin,
                          Vec3& direction, Photons& photons) const;

  Scene& scene_;
  const Lights& lights_;
  PhotonEmitter emitter_;
  int max_bounces_;
  PhotonStream stream_;
  BounceKernel bounce_;
  const Camera* viewer_ = nullptr;
  std::optional<EmissionGuide> guide_;
  std::optional<EmissionTargets> targets_;
  std::optional<PathWorth> worth_;
  Homing homing_;
  double total_ = 1;                    // paths of the set that is being traced
  std::vector<Travellers> travellers_;  // by worker
  PhotonJoin join_;
  bool keeps_groups_ = false;
  BeamLight beams_ = BeamLight::kNone;
  // Kind of the camera path's ray that leaves where photons are stored
  RayInfo::Kind receiver_kind_ = RayInfo::kDiffuse;
  PhotonCounts counts_, last_counts_;
};

}  // namespace photon_splat
