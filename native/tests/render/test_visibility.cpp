// What some kinds of ray do not see: one mask for single rays, packets and shadows; photons and
// paths agree.
#include <doctest/doctest.h>

#include "render/renderer.h"
#include "support/approx.h"
#include "support/passes.h"
#include "support/programs.h"

using namespace photon_splat;

namespace {

constexpr int size = 16;

enum class Thing { kGrey, kMirror };

RayMask all_but(std::initializer_list<RayInfo::Kind> kinds) {
  RayMask mask = kAllRays;
  for (const RayInfo::Kind kind : kinds) mask &= ~ray_bit(kind);
  return mask;
}

// A room [-1, 1]^2 x [0, 2] of albedo 1/2 with a mirror on its floor, a lamp under the ceiling and
// a ball that not all rays see.
void fill_room(Renderer& renderer, Thing thing, RayMask seen_by, bool instanced = false,
               const LampSettings& settings = {}) {
  Material grey;
  grey.front.albedo = grey.back.albedo = {0.5f, 0.5f, 0.5f};
  renderer.scene.materials = {grey, grey};
  ProgramWriter w;
  const ProgramWriter::Values values{{"weight", w.constant({1})},
                                     {"color", w.constant({0.9f, 0.9f, 0.9f})}};
  w.emit(nodes::Op::Glossy, values);
  w.emit(nodes::Op::End, {});
  check_program(renderer.scene, w.program());
  w.program().features = kProgramSharp | kProgramRest;
  renderer.scene.programs = {w.program()};
  renderer.scene.materials[1].program = 0;
  renderer.scene.meshes.push_back(padded(make_cube()));
  renderer.scene.meshes.push_back(padded(make_sphere(16, 32)));
  renderer.scene.add_instance(0, {2, 0, 0, -1, 0, 2, 0, -1, 0, 0, 2, 0}, {0});
  const uint32_t ball = thing == Thing::kMirror;
  renderer.scene.add_instance(1, {0.4, 0, 0, 0, 0, 0.4, 0, 0, 0, 0, 0.4, 0.9}, {int32_t(ball)});
  renderer.scene.instances.back().seen_by = seen_by;
  if (instanced)
    renderer.scene.add_instance(1, {0.2, 0, 0, 0.6, 0, 0.2, 0, 0.6, 0, 0, 0.2, 0.3}, {0});
  renderer.scene.meshes.push_back(padded(make_sphere(16, 32)));
  renderer.scene.add_instance(2, {0.3, 0, 0, 0.5, 0, 0.3, 0, -0.5, 0, 0, 0.3, 0.4}, {1});
  LampSettings lamp = settings;
  lamp.kind = LampKind::kArea;
  lamp.to_world = Affine{{1, 0, 0, 0.1f, 0, 1, 0, 0, 0, 0, 1, 1.95f}};
  lamp.size_x = lamp.size_y = 0.7f;
  lamp.strength = {10, 9, 8};
  renderer.lamps = {lamp};
  CameraSettings& camera = renderer.camera_settings;
  camera.to_world = Affine{{1, 0, 0, -0.8f, 0, 1, 0, 0, 0, 0, 1, 1.9f}};
  camera.width = camera.height = camera.region_width = camera.region_height = size;
  renderer.options.photons_per_pass = 30000;
  renderer.build();
}

double mean_light(Renderer& renderer, uint32_t passes, bool reference) {
  render_passes(renderer, passes, reference);
  double sum = 0;
  for (const Pixel& p : renderer.film().unpacked().pixels)
    sum += luminance(p.combined() * p.share());
  return sum / static_cast<double>(renderer.film().unpacked().pixels.size());
}

}  // namespace

TEST_CASE("single rays, packets and shadow rays meet what their kind sees, instanced or not") {
  for (const bool instanced : {false, true}) {
    CAPTURE(instanced);
    Renderer renderer(1);
    fill_room(renderer, Thing::kGrey, all_but({RayInfo::kGlossy, RayInfo::kShadow}), instanced);
    const Scene& scene = renderer.scene;
    CHECK(scene.limits_rays());
    CHECK(scene.kinds_differ());
    const Vec3 origin{-0.9f, 0, 0.9f}, way{1, 0, 0};
    for (const RayInfo::Kind kind : {RayInfo::kCamera, RayInfo::kShadow, RayInfo::kDiffuse,
                                     RayInfo::kGlossy, RayInfo::kTransmission}) {
      CAPTURE(int(kind));
      const bool sees = kind != RayInfo::kGlossy && kind != RayInfo::kShadow;
      Surface one, packet[1];
      REQUIRE(scene.intersect(origin, way, 0, INFINITY, false, one, ray_bit(kind)));
      REQUIRE(scene.intersect_packet(&origin, &way, 1, packet, ray_bit(kind)) == 1);
      CHECK(one.instance == (sees ? 1 : 0));
      CHECK(packet[0].instance == one.instance);
      CHECK(scene.occluded(origin, way, 0, 1.8f, ray_bit(kind)) == sees);
      CHECK((scene.occluded_packet(&origin, 1, way, 1.8f, ray_bit(kind)) != 0) == sees);
    }
    CHECK(average(scene.transmittance(origin, way, 1.8f, {})) == 1);
  }
  Renderer plain(1);
  fill_room(plain, Thing::kGrey, kAllRays);
  CHECK(!plain.scene.limits_rays());
}

TEST_CASE("photons and paths agree on light past and from a thing that not all rays see") {
  using Kind = RayInfo::Kind;
  const std::vector<RayMask> masks = {
      all_but({Kind::kDiffuse}), all_but({Kind::kGlossy}), all_but({Kind::kDiffuse, Kind::kShadow}),
      all_but({Kind::kDiffuse, Kind::kGlossy, Kind::kTransmission}), all_but({Kind::kCamera})};
  Renderer all(2);
  fill_room(all, Thing::kGrey, kAllRays);
  const double of_all = mean_light(all, 96, true);
  for (const Thing thing : {Thing::kGrey, Thing::kMirror})
    for (const RayMask mask : masks) {
      CAPTURE(int(thing));
      CAPTURE(mask);
      Renderer traced(2), splatted(2);
      fill_room(traced, thing, mask);
      fill_room(splatted, thing, mask);
      const double reference = mean_light(traced, 256, true);
      CHECK(mean_light(splatted, 16, false) == approx(reference).epsilon(0.015));
      if (thing == Thing::kGrey) CHECK(std::abs(reference / of_all - 1) > 0.002);
    }
}

TEST_CASE(
    "photons and paths agree on lamps that some rays do not see, that end after some bounces, and that cast no shadow") {
  LampSettings glossy_only, few, shadowless;
  glossy_only.seen_by = all_but({RayInfo::kDiffuse});
  few.max_bounces = 1;
  shadowless.casts_shadows = false;
  for (const LampSettings& lamp : {few, shadowless, glossy_only})
    for (const Thing thing : {Thing::kGrey, Thing::kMirror}) {
      CAPTURE(lamp.max_bounces);
      CAPTURE(lamp.casts_shadows);
      CAPTURE(int(thing));
      if (!~lamp.max_bounces || thing == Thing::kGrey) {
        Renderer traced(2), splatted(2);
        fill_room(traced, thing, kAllRays, false, lamp);
        fill_room(splatted, thing, kAllRays, false, lamp);
        // What only glossy rays see of the lamp, few paths find.
        const bool rare = lamp.seen_by != kAllRays;
        const double noise = rare ? 0.06 : 0.02;
        const double reference = mean_light(traced, rare ? 1024 : 256, true);
        CHECK(reference > 0);
        CHECK(mean_light(splatted, 16, false) == approx(reference).epsilon(noise));
      }
    }
}

TEST_CASE(
    "a lamp whose light passes everything lights the floor under a ball as if there were none") {
  LampSettings shadowless;
  shadowless.casts_shadows = false;
  Renderer renderer(1);
  fill_room(renderer, Thing::kGrey, kAllRays, false, shadowless);
  const Lights lights(renderer.scene, renderer.lamps);
  const Receiver floor{{0, 0, 0}, {0, 0, 1}};
  const auto light = lights.sample(floor, 0.5f, {0.5f, 0.5f});
  REQUIRE(light.has_value());
  CHECK(average(renderer.scene.transmittance({0, 0, 1e-4f}, light->direction,
                                             light->distance * 0.999f, {}, light->blockers)) == 1);
}
